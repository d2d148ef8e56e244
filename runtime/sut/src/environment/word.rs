//! Words of commands that name a Python interpreter.

/// `python`, `python3` or `python3.x`, with or without a path.
pub(crate) fn is_python(word: &str) -> bool {
    let name = word.rsplit('/').next().unwrap_or(word);
    name.strip_prefix("python")
        .is_some_and(|rest| rest.is_empty() || rest == "3" || rest.strip_prefix("3.").is_some_and(is_number))
}

fn is_number(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::is_python;

    #[test]
    fn which_words_are_python() {
        for word in ["python", "python3", "python3.8", "python3.14", "/usr/bin/python3", "venv/bin/python"] {
            assert!(is_python(word), "{word}");
        }
        for word in ["pythonista", "python2", "python3.", "python3.x", "ipython", "robot", ""] {
            assert!(!is_python(word), "{word}");
        }
    }
}
