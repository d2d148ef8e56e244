//! The options on lines of requirements files, as pip's parser takes them.

/// An option, by its full name; one that is not known here is a word as it was written.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct OptionKind {
    pub option: String,
    pub value: Option<String>,
}

/// Those with a value: pip takes any beginning that is no other's.
const WITH_VALUE: &[(&str, &str)] = &[
    ("-c", "--constraint"),
    ("-C", "--config-settings"),
    ("-e", "--editable"),
    ("", "--extra-index-url"),
    ("-f", "--find-links"),
    ("", "--global-option"),
    ("", "--hash"),
    ("-i", "--index-url"),
    ("", "--install-option"),
    ("", "--no-binary"),
    ("", "--only-binary"),
    ("", "--pypi-url"),
    ("-r", "--requirement"),
    ("", "--trusted-host"),
    ("", "--use-feature"),
];
const WITHOUT: &[&str] = &["--no-index", "--pre", "--prefer-binary", "--require-hashes"];

/// A line's requirement and its options: these begin at the first word with a `-`.
pub(super) fn split(line: &str) -> (&str, &str) {
    let is_option = |&(at, _): &(usize, &str)| at == 0 || line[..at].ends_with(' ');
    match line.match_indices('-').find(is_option) {
        Some((at, _)) => (line[..at].trim(), line[at..].trim()),
        None => (line.trim(), ""),
    }
}

/// # Errors
/// A quote that does not end.
pub(super) fn parse(text: &str) -> Result<Vec<OptionKind>, String> {
    let words = shlex::split(text).ok_or_else(|| format!("a quote in `{text}` does not end"))?;
    let mut choices = Vec::new();
    let mut words = words.into_iter();
    while let Some(word) = words.next() {
        let (option, attached) = recognised(&word);
        let value = match option {
            Some(_) => attached.or_else(|| words.next()),
            None => None,
        };
        choices.push(OptionKind { option: option.map_or(word, str::to_owned), value });
    }
    Ok(choices)
}

/// The option with a value that a word means, and the value if it is in the same word.
fn recognised(word: &str) -> (Option<&'static str>, Option<String>) {
    if word.starts_with("--") {
        let (name, value) = word.split_once('=').map_or((word, None), |(n, v)| (n, Some(v.to_owned())));
        let long = || WITH_VALUE.iter().map(|&(_, long)| long);
        let begun: Vec<&str> =
            long().chain(WITHOUT.iter().copied()).filter(|long| long.starts_with(name)).collect();
        let meant = long().find(|&long| long == name || (begun == [long] && name.len() > 2));
        return (meant, value);
    }
    let short = |&&(short, _): &&(&str, &str)| !short.is_empty() && word.starts_with(short);
    match WITH_VALUE.iter().find(short) {
        Some(&(short, long)) => {
            let rest = &word[short.len()..];
            (Some(long), (!rest.is_empty()).then(|| rest.to_owned()))
        }
        None => (None, None),
    }
}

/// The text of the options but one. Words that belong to no option are left out, as pip does.
pub(super) fn join_without(choices: &[OptionKind], option: &str) -> String {
    let mut text = String::new();
    for choice in choices.iter().filter(|c| c.option != option && c.option.starts_with('-')) {
        text.push_str(&choice.option);
        if let Some(value) = &choice.value {
            text.push(' ');
            text.push_str(&quoted(value));
        }
        text.push(' ');
    }
    text.trim_end().to_owned()
}

/// A value as a word of an option.
pub(super) fn quoted(value: &str) -> String {
    shlex::try_quote(value).map_or_else(|_| value.to_owned(), std::borrow::Cow::into_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Vec<(String, Option<String>)> {
        parse(text).unwrap().into_iter().map(|c| (c.option, c.value)).collect()
    }

    #[test]
    fn options_are_recognised_in_all_their_forms() {
        for text in
            ["-r a.txt", "-ra.txt", "--requirement a.txt", "--requirement=a.txt", "--requireme 'a.txt'"]
        {
            assert_eq!(parsed(text), [("--requirement".to_owned(), Some("a.txt".to_owned()))], "{text}");
        }
        assert_eq!(parsed("--require-hashes"), [("--require-hashes".to_owned(), None)]);
        assert_eq!(parsed("--require x"), [("--require".to_owned(), None), ("x".to_owned(), None)]);
        assert!(parse("-r 'a").is_err());
        let both = parse("--no-index -f 'my links' stray").unwrap();
        assert_eq!(join_without(&both, "--find-links"), "--no-index");
        assert_eq!(join_without(&both, "--no-index"), "--find-links 'my links'");
    }

    #[test]
    fn a_requirement_ends_where_options_begin() {
        assert_eq!(split("a-b==1 --hash=sha256:x"), ("a-b==1", "--hash=sha256:x"));
        assert_eq!(split("-e ./x"), ("", "-e ./x"));
        assert_eq!(split("./my lib ; extra"), ("./my lib ; extra", ""));
    }
}
