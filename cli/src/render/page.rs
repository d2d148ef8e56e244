//! A page of Markdown for the terminal: headings bold, paragraphs wrapped, code indented.

use crate::color::{TextStyle, paint};

const WIDTH: usize = 80;
const INDENT: &str = "    ";

/// A page as a terminal shows it. Of Markdown it knows what the pages of the codes use: headings, paragraphs, lists, fenced
/// code, `code`, links.
#[must_use]
pub fn terminal(markdown: &str, colour: bool) -> String {
    let mut out = String::new();
    let mut paragraph = String::new();
    let mut code = false;
    for line in markdown.lines() {
        if line.starts_with("```") {
            flush(&mut out, &mut paragraph, colour);
            code = !code;
        } else if code {
            let indent = if line.is_empty() { "" } else { INDENT };
            out += &format!("{indent}{}\n", paint(colour, TextStyle::Code, line));
        } else if let Some(heading) = heading(line) {
            flush(&mut out, &mut paragraph, colour);
            out += &format!("{}\n", paint(colour, TextStyle::Bold, heading));
        } else if line.trim().is_empty() {
            flush(&mut out, &mut paragraph, colour);
            out.push('\n');
        } else {
            if ["- ", "| "].iter().any(|start| line.starts_with(start)) {
                flush(&mut out, &mut paragraph, colour);
            }
            paragraph += if paragraph.is_empty() { "" } else { " " };
            paragraph += line.trim();
        }
    }
    flush(&mut out, &mut paragraph, colour);
    out
}

fn heading(line: &str) -> Option<&str> {
    let rest = line.trim_start_matches('#');
    rest.strip_prefix(' ').filter(|_| rest.len() < line.len())
}

/// Ends a paragraph: its words are set in lines.
fn flush(out: &mut String, paragraph: &mut String, colour: bool) {
    let text = without_links(&std::mem::take(paragraph));
    let mut code = false;
    let mut column = 0;
    for word in text.split_whitespace() {
        let width = word.chars().count();
        if column > 0 && column + 1 + width > WIDTH {
            out.push('\n');
            column = 0;
        }
        if column > 0 {
            out.push(' ');
            column += 1;
        }
        *out += &inline(word, &mut code, colour);
        column += width;
    }
    if column > 0 {
        out.push('\n');
    }
}

/// A word whose `code` is painted; without colours the backquotes say the same. Code may go on in the next word.
fn inline(word: &str, code: &mut bool, colour: bool) -> String {
    if !colour {
        return word.to_owned();
    }
    let mut out = String::new();
    for (i, part) in word.split('`').enumerate() {
        if i > 0 {
            *code = !*code;
        }
        out += &if *code { paint(true, TextStyle::Code, part) } else { part.to_owned() };
    }
    out
}

/// `[text](target)` becomes `text`.
fn without_links(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('[') {
        let link = after.split_once("](").and_then(|(text, tail)| Some((text, tail.split_once(')')?.1)));
        match link.filter(|_| before.matches('`').count() % 2 == 0) {
            Some((label, tail)) => {
                out += before;
                out += label;
                rest = tail;
            }
            None => {
                out += before;
                out.push('[');
                rest = after;
            }
        }
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = "# A title\n\nSome `code here` and\na [link](x.md#y).\n\n```hri,fails=HR0001\nevent a\n\nevent b\n```\n\n- one\n- two\n";

    #[test]
    fn plain_text_has_no_escapes_and_keeps_its_parts() {
        assert_eq!(
            terminal(PAGE, false),
            "A title\n\nSome `code here` and a link.\n\n    event a\n\n    event b\n\n- one\n- two\n"
        );
    }

    #[test]
    fn colours_mark_headings_and_code() {
        let text = terminal(PAGE, true);
        assert!(text.starts_with("\u{1b}[1mA title\u{1b}[0m\n"));
        assert!(text.contains("    \u{1b}[36mevent a\u{1b}[0m\n"));
        assert!(text.contains("Some \u{1b}[36mcode\u{1b}[0m \u{1b}[36mhere\u{1b}[0m and"));
    }

    #[test]
    fn long_paragraphs_are_wrapped() {
        let text = terminal(&"word ".repeat(50), false);
        assert!(text.lines().all(|l| l.len() <= WIDTH) && text.lines().count() == 4, "{text}");
    }
}
