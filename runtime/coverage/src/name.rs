//! The names of bins, as they are printed, stored and read back: `legs.four`, `human_robot."4 legs, ready"`.

/// The name of a bin of a point or cross. A bin whose name is no identifier is quoted.
///
/// Inside quotes `"` and `\` are preceded by `\`, and a line break is `\n`; so a name is always one line.
#[must_use]
pub fn bin(owner: &str, bin: &str) -> String {
    if is_identifier(bin) {
        return format!("{owner}.{bin}");
    }
    let mut name = format!("{owner}.\"");
    for c in bin.chars() {
        match c {
            '"' | '\\' => name.extend(['\\', c]),
            '\n' => name.push_str("\\n"),
            c => name.push(c),
        }
    }
    name.push('"');
    name
}

/// The owner and the bin of a name that [`bin`] made; `None` if it has not that form.
#[must_use]
pub fn split(name: &str) -> Option<(&str, String)> {
    let Some((owner, quoted)) = name.split_once(".\"") else {
        let (owner, bin) = name.rsplit_once('.')?;
        return is_identifier(bin).then(|| (owner, bin.to_owned()));
    };
    let mut bin = String::new();
    let mut rest = quoted.strip_suffix('"')?.chars();
    while let Some(c) = rest.next() {
        match c {
            '\\' => match rest.next()? {
                'n' => bin.push('\n'),
                c @ ('"' | '\\') => bin.push(c),
                _ => return None,
            },
            '"' => return None,
            c => bin.push(c),
        }
    }
    Some((owner, bin))
}

fn is_identifier(text: &str) -> bool {
    let starts = text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    starts && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}
