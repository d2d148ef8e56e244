//! UPPAAL's symbolic traces (`.xtr`): which edges the processes take, from which locations.
//!
//! A trace is a state, then pairs of a state and the transition into it, then a dot. A state is the location of each process, the bounds of
//! its zone (`i j b .` each) and the values of its integers, each part ended by a dot. A transition is a list of `process edge selects`,
//! each ended by a semicolon (in files of older versions by the line's end, and then edges are numbered from 1), ended by a dot. The file
//! names nothing: processes, locations and edges are numbers in the order of the model. The layout is that which the public tools `tracer` and
//! libutap read.

/// A trace of UPPAAL, in numbers from 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UppaalTrace {
    /// The location of each process, at the start and after each transition.
    pub locations: Vec<Vec<usize>>,
    pub transitions: Vec<Vec<UppaalMove>>,
}

/// A process takes an edge.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UppaalMove {
    pub process: usize,
    pub edge: usize,
    pub selects: Vec<i64>,
}

/// Reads a trace.
///
/// # Errors
/// The line on which it is no trace, and why.
pub fn read_trace(text: &str) -> Result<UppaalTrace, String> {
    let mut reader = TraceReader { tokens: tokens(text), at: 0 };
    let mut trace = UppaalTrace::default();
    trace.locations.push(reader.state()?);
    while !reader.dot() {
        trace.locations.push(reader.state()?);
        trace.transitions.push(reader.transition()?);
    }
    reader.skip_lines();
    match reader.peek() {
        None => Ok(trace),
        Some(_) => Err(reader.wrong("the trace has ended, and more follows")),
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TraceToken<'t> {
    Word(&'t str),
    LineEnd,
}

/// The words and line ends of a text, with the numbers of their lines.
fn tokens(text: &str) -> Vec<(usize, TraceToken<'_>)> {
    let mut all = Vec::new();
    for (line, content) in text.lines().enumerate() {
        let words = content.split_whitespace().flat_map(|word| {
            // `3 0;` is written as well as `3 0 ;`.
            let (head, tail) = word.strip_suffix(';').map_or((word, None), |head| (head, Some(";")));
            Some(head).filter(|h| !h.is_empty()).into_iter().chain(tail)
        });
        all.extend(words.map(|word| (line + 1, TraceToken::Word(word))));
        all.push((line + 1, TraceToken::LineEnd));
    }
    all
}

struct TraceReader<'t> {
    tokens: Vec<(usize, TraceToken<'t>)>,
    at: usize,
}

impl<'t> TraceReader<'t> {
    fn peek(&self) -> Option<TraceToken<'t>> {
        self.tokens.get(self.at).map(|t| t.1)
    }

    fn skip_lines(&mut self) {
        while self.peek() == Some(TraceToken::LineEnd) {
            self.at += 1;
        }
    }

    fn wrong(&self, what: &str) -> String {
        let last = self.tokens.last().map_or(1, |t| t.0);
        let line = self.tokens.get(self.at).map_or(last, |t| t.0);
        match self.peek() {
            Some(TraceToken::Word(word)) => {
                let shown: String = word.chars().take(20).collect();
                format!("line {line}: {what}, at `{shown}`")
            }
            Some(TraceToken::LineEnd) => format!("line {line}: {what}, at the end of the line"),
            None => format!("line {line}: {what}, at the end of the file"),
        }
    }

    /// Takes a dot, if there is one.
    fn dot(&mut self) -> bool {
        self.skip_lines();
        let there = self.peek() == Some(TraceToken::Word("."));
        self.at += usize::from(there);
        there
    }

    fn number<N: std::str::FromStr>(&mut self) -> Option<N> {
        let Some(TraceToken::Word(word)) = self.peek() else { return None };
        let n = word.parse().ok()?;
        self.at += 1;
        Some(n)
    }

    /// Numbers up to a dot.
    fn numbers<N: std::str::FromStr>(&mut self, what: &str) -> Result<Vec<N>, String> {
        let mut all = Vec::new();
        while !self.dot() {
            all.push(self.number().ok_or_else(|| self.wrong(&format!("{what}, or `.`, was expected")))?);
        }
        Ok(all)
    }

    /// The locations of a state; its zone and its integers are passed over.
    fn state(&mut self) -> Result<Vec<usize>, String> {
        let locations = self.numbers("the number of a location")?;
        while !self.dot() {
            let bound: Vec<i64> = self.numbers("a bound of the zone (two clocks and a number)")?;
            if bound.len() != 3 {
                return Err(
                    self.wrong("a bound of the zone (two clocks and a number) was expected before this")
                );
            }
        }
        self.numbers::<i64>("the value of an integer")?;
        Ok(locations)
    }

    fn transition(&mut self) -> Result<Vec<UppaalMove>, String> {
        let mut moves = Vec::new();
        while !self.dot() {
            let process = self.number().ok_or_else(|| self.wrong("the number of a process was expected"))?;
            let edge: usize =
                self.number().ok_or_else(|| self.wrong("the number of an edge was expected"))?;
            let mut selects = Vec::new();
            while let Some(value) = self.number() {
                selects.push(value);
            }
            // An older version ends an edge by the line, and counts from 1.
            let old = match self.peek() {
                Some(TraceToken::Word(";")) => false,
                Some(TraceToken::LineEnd) => true,
                Some(TraceToken::Word(_)) | None => return Err(self.wrong("`;` was expected")),
            };
            self.at += 1;
            let edge = edge.checked_sub(usize::from(old));
            moves.push(UppaalMove {
                process,
                edge: edge.ok_or_else(|| self.wrong("edges are numbered from 1 where no `;` ends them"))?,
                selects,
            });
        }
        if moves.is_empty() {
            return Err(self.wrong("a transition of nobody ends before this"));
        }
        Ok(moves)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two processes; the first goes, with two selected values, and the second along with it.
    const NEW: &str =
        "0 1 \n.\n0 1 0\n.\n1 0 2\n.\n.\n7 \n.\n1 0 \n.\n0 1 -2\n.\n.\n8 \n.\n0 2 4 -5 ; 1 0 ; .\n.\n";

    fn moved(process: usize, edge: usize, selects: &[i64]) -> UppaalMove {
        UppaalMove { process, edge, selects: selects.to_vec() }
    }

    #[test]
    fn edges_and_locations_are_read() {
        let trace = read_trace(NEW).unwrap();
        assert_eq!(trace.locations, [[0, 1], [1, 0]]);
        assert_eq!(trace.transitions, [[moved(0, 2, &[4, -5]), moved(1, 0, &[])]]);
    }

    #[test]
    fn older_files_count_edges_from_one() {
        let old = NEW.replace("0 2 4 -5 ; 1 0 ; .", "0 3 4 -5\n1 1\n.");
        assert_eq!(read_trace(&old), read_trace(NEW));
    }

    #[test]
    fn a_trace_may_have_no_integers_and_no_bounds() {
        let trace = read_trace("0\n.\n.\n.\n1\n.\n.\n.\n0 0;\n.\n.").unwrap();
        assert_eq!((trace.locations.len(), &trace.transitions[0]), (2, &vec![moved(0, 0, &[])]));
    }

    #[test]
    fn a_part_of_a_trace_is_none() {
        for end in 0..NEW.trim_end().len() {
            let error = read_trace(&NEW[..end]).unwrap_err();
            assert!(error.starts_with("line "), "{end}: {error}");
        }
        for (at, _) in NEW.char_indices() {
            // Whatever is written there instead, it is read or refused.
            for other in ["x", ".", ";", "-", "\n", "99999999999999999999"] {
                let _ = read_trace(&format!("{}{other}{}", &NEW[..at], &NEW[at + 1..]));
            }
        }
    }

    #[test]
    fn what_is_no_trace_is_said_with_its_line() {
        for (text, said) in [
            ("", "line 1: the number of a location, or `.`, was expected, at the end of the file"),
            ("0 a\n.", "line 1: the number of a location, or `.`, was expected, at `a`"),
            ("0\n.\n0 1\n.\n", "line 4: a bound of the zone"),
            (&NEW.replace("0 2 4 -5 ; 1 0 ; .", "."), "line 17: a transition of nobody"),
            (&NEW.replace("1 0 ; .", "1 0 x"), "line 17: `;` was expected, at `x`"),
            (&format!("{NEW}5"), "line 19: the trace has ended, and more follows, at `5`"),
            (NEW.trim_end().trim_end_matches('.'), "was expected, at the end of the file"),
        ] {
            let error = read_trace(text).unwrap_err();
            assert!(error.contains(said), "{text:?}: {error}");
        }
    }
}
