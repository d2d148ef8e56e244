//! Untrusted text made harmless, and numbers for people.

use hrdsl_source::is_steering;

/// The text without terminal escapes, control characters and marks that change the direction of writing.
///
/// Line breaks stay; a lone carriage return becomes one, since progress bars use it so. Tabs become spaces.
pub fn clean(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        rest = &rest[c.len_utf8()..];
        match c {
            '\u{1b}' => rest = after_escape(rest),
            '\u{9b}' => rest = after_control_sequence(rest),
            '\n' => out.push('\n'),
            '\r' => {
                rest = rest.strip_prefix('\n').unwrap_or(rest);
                out.push('\n');
            }
            '\t' => out.push_str("    "),
            _ if c.is_control() => {}
            _ if is_steering(c) => out.push('\u{fffd}'),
            _ => out.push(c),
        }
    }
    out
}

/// What follows an escape character: a control sequence, an operating system command, or one more character.
fn after_escape(rest: &str) -> &str {
    if let Some(rest) = rest.strip_prefix('[') {
        return after_control_sequence(rest);
    }
    if let Some(command) = rest.strip_prefix([']', 'P', '_', '^', 'X']) {
        // A command without an end on its line is no command: its text stays, so that nothing can be hidden behind it.
        let line = &command[..command.find('\n').unwrap_or(command.len())];
        let bell = line.find('\u{7}').map(|at| at + 1);
        let terminator = line.find("\u{1b}\\").map(|at| at + 2);
        let end = bell.into_iter().chain(terminator).min().unwrap_or(0);
        return &command[end..];
    }
    let mut chars = rest.chars();
    match chars.next() {
        Some(c) if c.is_ascii_graphic() => chars.as_str(),
        Some(_) | None => rest,
    }
}

fn after_control_sequence(rest: &str) -> &str {
    let parameters = rest.trim_start_matches(|c| ('\u{20}'..='\u{3f}').contains(&c));
    parameters.strip_prefix(|c| ('\u{40}'..='\u{7e}').contains(&c)).unwrap_or(parameters)
}

/// [`clean`]ed and on one line.
pub fn line(text: &str) -> String {
    clean(text).split_whitespace().collect::<Vec<_>>().join(" ")
}

/// At most `width` characters, the last one `…` if some were left out.
pub fn cut(text: &str, width: usize) -> String {
    if text.chars().count() <= width {
        return text.to_owned();
    }
    let mut kept: String = text.chars().take(width.saturating_sub(1)).collect();
    if width > 0 {
        kept.truncate(kept.trim_end().len());
        kept.push('…');
    }
    kept
}

/// The text without its middle, if it is long: a program's output says most at its start and at its end.
pub fn ends(text: &str) -> String {
    const START: usize = 1500;
    const END: usize = 4500;
    let length = text.chars().count();
    if length <= START + END + 100 {
        return text.to_owned();
    }
    let start: String = text.chars().take(START).collect();
    let end: String = text.chars().skip(length - END).collect();
    format!("{start}\n[… {} characters left out …]\n{end}", length - START - END)
}

/// A moment: `23.45 s`.
pub fn moment(time: f64) -> String {
    format!("{time:.2} s")
}

/// A stretch of time: `12.5 s`, `4 min 12 s`, `38.2 h`.
pub fn stretch(time: f64) -> String {
    let time = time + 0.0; // an empty sum is −0
    if time < 119.95 {
        format!("{time:.1} s")
    } else if time < 5999.5 {
        format!("{} min {:02} s", time.round() as u64 / 60, time.round() as u64 % 60)
    } else {
        format!("{:.1} h", time / 3600.0)
    }
}

/// Three significant digits, with a real minus sign.
pub fn number(value: f64) -> String {
    if !value.is_finite() {
        return if value.is_nan() { "–".to_owned() } else { format!("{value}").replace('-', "−") };
    }
    let magnitude = if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 };
    let places = usize::try_from((2 - magnitude).clamp(0, 6)).unwrap_or(0);
    let text = format!("{value:.places$}");
    if text.trim_start_matches('-').chars().all(|c| matches!(c, '0' | '.')) {
        return "0".to_owned();
    }
    text.replace('-', "−")
}

/// A margin with its sign: what is left up to the limit, or (negative) by how much it was passed.
pub fn margin(value: f64, unit: &str) -> String {
    let sign = if value > 0.0 { "+" } else { "" };
    format!("{sign}{} {unit}", number(value)).trim_end().to_owned()
}

/// `1 test`, `2 tests`.
pub fn count(number: usize, noun: &str) -> String {
    if number == 1 { format!("1 {noun}") } else { format!("{number} {noun}s") }
}

/// `a, b and c`.
pub fn enumeration(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// Numbers as ranges: `1–3, 7`.
pub fn ranges(numbers: impl IntoIterator<Item = u32>) -> String {
    let mut runs: Vec<(u32, u32)> = Vec::new();
    for n in numbers {
        match runs.last_mut() {
            Some((_, end)) if end.checked_add(1) == Some(n) => *end = n,
            Some(_) | None => runs.push((n, n)),
        }
    }
    let text = |(a, b): &(u32, u32)| if a == b { a.to_string() } else { format!("{a}–{b}") };
    runs.iter().map(text).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escapes_and_controls_vanish() {
        assert_eq!(clean("\u{1b}[31mred\u{1b}[0m \u{9b}1mbold"), "red bold");
        assert_eq!(clean("a\u{1b}]0;title\u{7}b\u{1b}]8;;x\u{1b}\\c\u{1b}(d"), "abcd");
        assert_eq!(clean("a\u{0}\u{8}b\r\nc\rd\te"), "ab\nc\nd    e");
        assert_eq!(clean("\u{202e}txt\u{ffff}\u{1fffe}"), "\u{fffd}txt\u{fffd}\u{fffd}");
        assert_eq!(clean("10 °C ≤ ü 脚 👍"), "10 °C ≤ ü 脚 👍");
    }

    #[test]
    fn an_unfinished_escape_hides_nothing() {
        assert_eq!(clean("\u{1b}]0;Traceback\nError"), "0;Traceback\nError");
        assert_eq!(clean("\u{1b}"), "");
        assert_eq!(clean("\u{1b}[12"), "");
        assert_eq!(clean("\u{1b}[é"), "é");
        assert_eq!(clean("\u{1b}é"), "é");
    }

    #[test]
    fn numbers_are_rounded_sensibly() {
        assert_eq!(number(0.046_321), "0.0463");
        assert_eq!(number(-12.345), "−12.3");
        assert_eq!(number(1234.5), "1234");
        assert_eq!(number(-0.0), "0");
        assert_eq!(number(1e-12), "0");
        assert_eq!(number(f64::NAN), "–");
        assert_eq!(margin(0.01, "rad/s"), "+0.0100 rad/s");
        assert_eq!(stretch(62.04), "62.0 s");
        assert_eq!(stretch(-0.0), "0.0 s");
        assert_eq!(stretch(312.4), "5 min 12 s");
        assert_eq!(stretch(137_520.0), "38.2 h");
        assert_eq!(ranges([1, 2, 3, 7, 9, 10]), "1–3, 7, 9–10");
    }

    #[test]
    fn cutting_counts_characters() {
        assert_eq!(cut("müde", 4), "müde");
        assert_eq!(cut("müde Person", 6), "müde…");
        assert_eq!(cut("abc", 0), "");
        assert_eq!(ends("abc"), "abc");
        let long = ends(&format!("a{}b", "ü".repeat(100_000)));
        assert!(
            long.starts_with('a')
                && long.ends_with('b')
                && long.contains("94002 characters")
                && long.len() < 13_000
        );
        assert_eq!(line(" a\n\tb "), "a b");
    }
}
