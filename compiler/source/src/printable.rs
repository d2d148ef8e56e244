//! Text that comes from outside (files, their names, programs), made safe to print.

use std::borrow::Cow;

/// Whether a character steers a terminal, or reorders or hides the text around it; some of these are no characters of XML
/// either. Line breaks and tabs are among them.
#[must_use]
pub fn is_steering(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200b}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{2069}')
        || matches!(c, '\u{feff}' | '\u{fdd0}'..='\u{fdef}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}')
        || u32::from(c) & 0xfffe == 0xfffe
}

/// What stands for a character on a terminal: itself, or one that is seen and does nothing.
#[must_use]
pub fn printable_char(c: char) -> char {
    match c {
        '\0'..='\u{1f}' => char::from_u32(0x2400 + u32::from(c)).unwrap_or('\u{fffd}'),
        '\u{7f}' => '\u{2421}',
        _ if is_steering(c) => '\u{fffd}',
        _ => c,
    }
}

/// The text with a sign for each character that steers. Line breaks and tabs stay.
#[must_use]
pub fn printable(text: &str) -> Cow<'_, str> {
    let stays = |c: char| matches!(c, '\n' | '\t') || !is_steering(c);
    if text.chars().all(stays) {
        return Cow::Borrowed(text);
    }
    let text = text.replace("\r\n", "\n");
    Cow::Owned(text.chars().map(|c| if stays(c) { c } else { printable_char(c) }).collect())
}

/// The same for what has to stay on one line, such as the name of a file: line breaks and tabs are signs, too.
#[must_use]
pub fn printable_line(text: &str) -> Cow<'_, str> {
    if text.chars().any(is_steering) {
        Cow::Owned(text.chars().map(printable_char).collect())
    } else {
        Cow::Borrowed(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steers_is_seen_and_does_nothing() {
        assert_eq!(
            printable("a\u{1b}[2Jb\u{7}\u{9b}31m\u{202e}c\r\nd\te\rf\u{7f}"),
            "a␛[2Jb␇�31m�c\nd\te␍f␡"
        );
        assert_eq!(printable_line("a\nb\tc\r\n"), "a␊b␉c␍␊");
        assert!(matches!(printable("grüße 你好\n\t≤"), Cow::Borrowed(_)));
    }

    #[test]
    fn one_character_stands_for_one() {
        for c in (0..=0x10_ffff).filter_map(char::from_u32) {
            assert!(!is_steering(printable_char(c)), "{:x}", u32::from(c));
        }
    }
}
