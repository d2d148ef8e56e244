//! Comments of declarations: they stand before the first thing that the declaration became.

use super::translation::UppaalTranslation;

/// How much had been written before a declaration.
#[derive(Clone, Copy)]
pub struct WrittenBefore {
    lines: usize,
    channels: usize,
    clocks: usize,
    functions: usize,
    arrays: usize,
}

impl UppaalTranslation<'_> {
    /// How much has been written so far, for all or in the process.
    pub fn written(&self, own: bool) -> WrittenBefore {
        let (lines, functions, arrays) = if own {
            (&self.own_lines, &self.own_functions, &self.own_arrays)
        } else {
            (&self.lines, &self.functions, &self.arrays)
        };
        WrittenBefore {
            lines: lines.len(),
            channels: self.channels.len(),
            clocks: self.own_clocks.len(),
            functions: functions.len(),
            arrays: arrays.len(),
        }
    }

    /// Puts a comment before the first thing that has been written since.
    pub fn comment(&mut self, said: &[String], before: WrittenBefore, own: bool) {
        let text = comment_lines(said);
        let (lines, functions, arrays) = if own {
            (&mut self.own_lines, &mut self.own_functions, &mut self.own_arrays)
        } else {
            (&mut self.lines, &mut self.functions, &mut self.arrays)
        };
        if let Some(clock) = self.own_clocks.get(before.clocks).filter(|_| own) {
            self.own_clock_comments.push((clock.clone(), said.join(" ")));
        } else if let Some(channel) = self.channels.get(before.channels).filter(|_| !own) {
            self.channel_comments.insert(channel.name.clone(), text);
        } else if let Some(line) = lines.get_mut(before.lines) {
            *line = text + line;
        } else if functions.len() > before.functions
            && let Some(function) = functions.last_mut()
        {
            // Those that it calls stand before it.
            *function = text + function;
        } else if let Some((_, (line, _))) = arrays.get_index_mut(before.arrays) {
            *line = text + line;
        } else {
            lines.push(text.trim_end().to_owned());
        }
    }
}

/// Each line as a comment.
pub fn comment_lines(said: &[String]) -> String {
    said.iter().map(|line| format!("// {line}\n")).collect()
}
