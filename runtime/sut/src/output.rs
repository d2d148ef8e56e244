//! Captured output in bounded memory: the beginning, the end, and how much there was.

use std::{collections::VecDeque, ffi::OsString, fmt};

/// What a program wrote to one of its streams.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CapturedStream {
    /// The first bytes, as text; bytes that are not UTF-8 are replaced.
    pub head: String,
    /// The last bytes after `head`, as text.
    pub tail: String,
    /// How many bytes were written in all.
    pub bytes: u64,
    /// How many bytes between `head` and `tail` were let go.
    pub dropped: u64,
}

impl CapturedStream {
    /// The text, with a note where some is missing.
    #[must_use]
    pub fn text(&self) -> String {
        if self.dropped == 0 {
            format!("{}{}", self.head, self.tail)
        } else {
            format!("{}\n[… {} bytes left out …]\n{}", self.head, self.dropped, self.tail)
        }
    }

    /// The last `n` lines.
    #[must_use]
    pub fn last_lines(&self, n: usize) -> String {
        let text = self.text();
        let lines: Vec<&str> = text.lines().collect();
        lines[lines.len().saturating_sub(n)..].join("\n")
    }
}

/// What a program wrote to both of its streams.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CapturedOutput {
    pub stdout: CapturedStream,
    pub stderr: CapturedStream,
}

impl fmt::Display for CapturedOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (name, stream) in [("stderr", &self.stderr), ("stdout", &self.stdout)] {
            if stream.bytes > 0 {
                write!(f, "\nits last lines on {name}:\n{}", indent(&stream.last_lines(12)))?;
            }
        }
        Ok(())
    }
}

fn indent(text: &str) -> String {
    text.lines().map(|line| format!("  {line}")).collect::<Vec<_>>().join("\n")
}

/// Collects a stream of any length within `limit` bytes: the first half of the limit is the head, the rest a ring.
#[derive(Debug)]
pub(crate) struct StreamCapture {
    limit: usize,
    head: Vec<u8>,
    tail: VecDeque<u8>,
    bytes: u64,
}

impl StreamCapture {
    pub(crate) fn new(limit: usize) -> Self {
        Self { limit, head: Vec::new(), tail: VecDeque::new(), bytes: 0 }
    }

    pub(crate) fn push(&mut self, chunk: &[u8]) {
        self.bytes += chunk.len() as u64;
        let (first, rest) =
            chunk.split_at(chunk.len().min(self.limit / 2 - self.head.len().min(self.limit / 2)));
        self.head.extend_from_slice(first);
        let room = self.limit - self.limit / 2;
        let rest = &rest[rest.len().saturating_sub(room)..];
        let over = (self.tail.len() + rest.len()).saturating_sub(room);
        self.tail.drain(..over);
        self.tail.extend(rest);
    }

    /// How many bytes have come in all.
    pub(crate) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// What was collected, with the beginnings of paths put back to what they stand for.
    pub(crate) fn captured(&self, moved: &[(OsString, OsString)]) -> CapturedStream {
        let kept = self.head.len() + self.tail.len();
        let tail: Vec<u8> = self.tail.iter().copied().collect();
        if kept as u64 == self.bytes {
            // Nothing is missing: a character that lies across the halves stays whole.
            let all = [self.head.as_slice(), &tail].concat();
            let head = put_back(lossy(&all), moved);
            return CapturedStream { head, tail: String::new(), bytes: self.bytes, dropped: 0 };
        }
        CapturedStream {
            head: put_back(lossy(&self.head), moved),
            tail: put_back(lossy(&tail), moved),
            bytes: self.bytes,
            dropped: self.bytes - kept as u64,
        }
    }
}

fn put_back(text: String, moved: &[(OsString, OsString)]) -> String {
    moved.iter().fold(text, |text, (from, to)| text.replace(&*from.to_string_lossy(), &to.to_string_lossy()))
}

fn lossy(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn capture(limit: usize, chunks: &[&[u8]]) -> CapturedStream {
        let mut c = StreamCapture::new(limit);
        for chunk in chunks {
            c.push(chunk);
        }
        c.captured(&[])
    }

    #[test]
    fn little_output_is_kept_whole() {
        let c = capture(8, &[b"abc", b"defgh"]);
        assert_eq!((c.text().as_str(), c.bytes, c.dropped), ("abcdefgh", 8, 0));
        assert_eq!(capture(4, &["é".as_bytes()]).text(), "é");
        assert_eq!(capture(3, &["aé".as_bytes()]).text(), "aé", "a character across the halves");
    }

    #[test]
    fn much_output_keeps_head_and_tail() {
        let c = capture(6, &[b"abcd", b"efgh", b"ij"]);
        assert_eq!((c.head.as_str(), c.tail.as_str(), c.bytes, c.dropped), ("abc", "hij", 10, 4));
        let c = capture(0, &[b"abc"]);
        assert_eq!((c.bytes, c.dropped, c.head.as_str()), (3, 3, ""));
    }

    #[test]
    fn memory_is_bounded_whatever_the_chunks() {
        let mut c = StreamCapture::new(100);
        for n in 0..1000_usize {
            c.push(&vec![b'x'; n * 7 % 301]);
            assert!(c.head.len() <= 50 && c.tail.len() <= 50);
        }
        assert!(c.tail.capacity() <= 1024);
    }

    #[test]
    fn last_lines_are_the_last() {
        assert_eq!(capture(100, &[b"a\nb\nc\n"]).last_lines(2), "b\nc");
    }
}
