//! Rates of exponential distributions (`exponentialrate`): only statistical model checking asks how fast a location is left, so a
//! scenario keeps them as comments, from which an export takes them back.

use hrdsl_source::{SourceFiles, Span};

/// What a comment before a location begins with.
pub const RATE_COMMENT: &str = "// exponentialrate ";

/// The rate in the comments before a location that is declared here.
///
/// A rate that names something is not given: in the model that is written it would be called something else.
pub fn rate_before(files: &SourceFiles, location: Span) -> Option<String> {
    let text = files.get(location.file)?.text.get(..location.range().start)?;
    let before = text.trim_end_matches([' ', '\t']).strip_suffix('\n')?;
    let comments = before.rsplit('\n').map(str::trim).take_while(|line| line.starts_with("//"));
    let rate = comments.filter_map(|line| line.strip_prefix(RATE_COMMENT)).next()?.trim();
    let plain = |c: char| c.is_ascii_digit() || " .:+-*/()".contains(c);
    (!rate.is_empty() && rate.chars().all(plain)).then(|| rate.to_owned())
}

/// A text in which names are replaced by what `value` says they are.
pub fn with_values(text: &str, value: impl Fn(&str) -> Option<i64>) -> String {
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let (mut out, mut rest) = (String::new(), text);
    while let Some(first) = rest.chars().next() {
        let end = rest.find(|c| is_name(c) != is_name(first)).unwrap_or(rest.len());
        let (word, after) = rest.split_at(end);
        let known = if first.is_ascii_digit() { None } else { value(word).filter(|_| is_name(first)) };
        match known {
            Some(n) if n < 0 => out += &format!("({n})"),
            Some(n) => out += &n.to_string(),
            None => out += word,
        }
        rest = after;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_what_they_are() {
        let value = |name: &str| [("id", 2), ("less", -1)].iter().find(|(n, _)| *n == name).map(|(_, v)| *v);
        assert_eq!(with_values("1+id : less * idle2", value), "1+2 : (-1) * idle2");
        assert_eq!(with_values("", value), "");
        assert_eq!(with_values("é id", value), "é 2");
    }

    #[test]
    fn a_rate_stands_in_the_comments_before() {
        let mut files = SourceFiles::default();
        let text = "a\n  // exponentialrate 1 : 5\n  // seen\n  location l\n  // exponentialrate 1+id\n  location k\n  location m";
        let file = files.add("a.hri", text);
        let at = |word: &str| {
            let start = text.find(word).unwrap();
            rate_before(&files, Span::new(file, start, start + word.len()))
        };
        assert_eq!(at("location l"), Some("1 : 5".to_owned()));
        assert_eq!((at("location k"), at("location m"), at("a")), (None, None, None));
    }
}
