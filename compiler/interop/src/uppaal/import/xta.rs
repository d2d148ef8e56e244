//! The textual format (`.xta`, `.ta`): processes with their states and transitions, read to the same as the XML.

use std::collections::BTreeMap;

use hrdsl_source::{FileId, Span};

use super::{
    branches::{BranchingTransitions, TransitionEnd},
    fault::UppaalFault,
    lex::{UppaalFragment, UppaalToken, UppaalTokenKind, lex},
    xml::{UppaalLocation, UppaalLocationKind, UppaalModel, UppaalTemplate, UppaalTransition},
};
use crate::exchange::note::NoteSeverity;

/// Reads a model, and what is wrong with it.
///
/// # Errors
/// It is no model at all.
pub fn read(file: FileId, text: &str) -> Result<(UppaalModel, Vec<UppaalFault>), Vec<UppaalFault>> {
    let text = UppaalFragment::of_file(file, text);
    let tokens = lex(&text).map_err(|fault| vec![fault])?;
    let mut reader = XtaReader { text, tokens, at: 0, uncontrollable: Vec::new(), faults: Vec::new() };
    let mut model = UppaalModel::default();
    let mut system = UppaalFragment { file, chars: Vec::new(), end: 0 };
    let mut from = 0;
    while !reader.at_end() {
        if reader.is_word("process") {
            system.chars.extend(reader.between(from, reader.at, false).chars);
            match reader.process() {
                Ok(template) => model.templates.push(template),
                Err(fault) => {
                    reader.faults.push(fault);
                    return Err(reader.faults);
                }
            }
            from = reader.at;
        } else {
            reader.at += 1;
        }
    }
    system.chars.extend(reader.between(from, reader.at, true).chars);
    system.end = reader.text.end;
    model.system.push(system);
    if let Some(first) = reader.uncontrollable.first() {
        let count = reader.uncontrollable.len();
        model.skipped.push((*first, NoteSeverity::Info, super::xml::uncontrollable(count)));
    }
    Ok((model, reader.faults))
}

struct XtaReader {
    text: UppaalFragment,
    tokens: Vec<UppaalToken>,
    at: usize,
    uncontrollable: Vec<Span>,
    faults: Vec<UppaalFault>,
}

type XtaResult<T> = Result<T, UppaalFault>;

impl XtaReader {
    fn token(&self, at: usize) -> &UppaalTokenKind {
        self.tokens.get(at).map_or(&UppaalTokenKind::End, |t| &t.tok)
    }

    fn at_end(&self) -> bool {
        *self.token(self.at) == UppaalTokenKind::End
    }

    fn span(&self) -> Span {
        self.tokens.get(self.at).or(self.tokens.last()).map_or_else(Span::default, |t| t.span)
    }

    fn is_word(&self, word: &str) -> bool {
        matches!(self.token(self.at), UppaalTokenKind::Word(w) if w == word)
    }

    fn is(&self, mark: &str) -> bool {
        matches!(self.token(self.at), UppaalTokenKind::Mark(m) if *m == mark)
    }

    fn take(&mut self, mark: &str) -> bool {
        let found = self.is(mark);
        self.at += usize::from(found);
        found
    }

    fn take_word(&mut self, word: &str) -> bool {
        let found = self.is_word(word);
        self.at += usize::from(found);
        found
    }

    fn fault<T>(&self, expected: &str) -> XtaResult<T> {
        let message = format!("expected {expected}, found {}", self.token(self.at).shown());
        Err(UppaalFault { span: self.span(), message })
    }

    fn expect(&mut self, mark: &str) -> XtaResult<()> {
        if self.take(mark) { Ok(()) } else { self.fault(&format!("`{mark}`")) }
    }

    fn name(&mut self, what: &str) -> XtaResult<(String, Span)> {
        match self.token(self.at).clone() {
            UppaalTokenKind::Word(name) => {
                let span = self.span();
                self.at += 1;
                Ok((name, span))
            }
            UppaalTokenKind::Int(_) | UppaalTokenKind::Mark(_) | UppaalTokenKind::End => self.fault(what),
        }
    }

    fn names(&mut self, what: &str) -> XtaResult<Vec<(String, Span)>> {
        let mut all = vec![self.name(what)?];
        while self.take(",") {
            all.push(self.name(what)?);
        }
        self.expect(";")?;
        Ok(all)
    }

    /// The text of these tokens. The comments before the first belong to it; those after the last, too, if they stand in its line or
    /// if nothing follows (`all`).
    fn between(&self, from: usize, to: usize, all: bool) -> UppaalFragment {
        let index = |byte: u32| self.text.chars.partition_point(|(at, _)| *at < byte);
        let end_of = |token: Option<&UppaalToken>| token.map_or(0, |t| index(t.span.end));
        let start = from.checked_sub(1).map_or(0, |before| end_of(self.tokens.get(before)));
        let mut end = if all {
            self.text.chars.len()
        } else {
            end_of(to.checked_sub(1).and_then(|last| self.tokens.get(last)))
        };
        let limit = self.tokens.get(to).map_or(end, |t| index(t.span.start));
        while end < limit && self.text.chars.get(end).is_some_and(|(_, c)| *c != '\n') {
            end += 1;
        }
        self.text.part(start, end.max(start))
    }

    /// The text up to a mark that is in no brackets.
    fn until(&mut self, marks: &[&str]) -> XtaResult<UppaalFragment> {
        let (start, mut open) = (self.at, 0);
        loop {
            match *self.token(self.at) {
                UppaalTokenKind::End => return self.fault(&format!("`{}`", marks.first().unwrap_or(&";"))),
                UppaalTokenKind::Mark(m) if open == 0 && marks.contains(&m) => break,
                UppaalTokenKind::Mark("(" | "[" | "{") => open += 1,
                UppaalTokenKind::Mark(")" | "]" | "}") => open -= 1,
                UppaalTokenKind::Mark(_) | UppaalTokenKind::Word(_) | UppaalTokenKind::Int(_) => {}
            }
            self.at += 1;
        }
        let (first, last) = (self.tokens.get(start), self.at.checked_sub(1).and_then(|i| self.tokens.get(i)));
        let index = |byte: u32| self.text.chars.partition_point(|(at, _)| *at < byte);
        Ok(match (first, last) {
            (Some(first), Some(last)) if start < self.at => {
                self.text.part(index(first.span.start), index(last.span.end))
            }
            _ => UppaalFragment { file: self.text.file, chars: Vec::new(), end: self.span().start },
        })
    }

    fn process(&mut self) -> XtaResult<UppaalTemplate> {
        self.at += 1;
        let (name, _) = self.name("the name of a process")?;
        let mut parameters = UppaalFragment::default();
        if self.take("(") {
            parameters = self.until(&[")"])?;
            self.expect(")")?;
        }
        self.expect("{")?;
        let start = self.at;
        let close = self.closing(start);
        let mut open = 0;
        while open > 0 || !self.is_word("state") {
            match self.token(self.at) {
                UppaalTokenKind::End => return self.fault("the states of the process (`state`)"),
                UppaalTokenKind::Mark("{") => open += 1,
                UppaalTokenKind::Mark("}") => open -= 1,
                UppaalTokenKind::Mark(_) | UppaalTokenKind::Word(_) | UppaalTokenKind::Int(_) => {}
            }
            if open < 0 {
                return self.fault("the states of the process (`state`)");
            }
            self.at += 1;
        }
        let declaration = self.between(start, self.at, false);
        let mut template = UppaalTemplate {
            name,
            parameters,
            declaration,
            locations: Vec::new(),
            initial: 0,
            transitions: Vec::new(),
        };
        if let Err(fault) = self.body(&mut template).and_then(|()| self.expect("}")) {
            // What is wrong behind it is told, too.
            self.faults.push(fault);
            self.at = close;
        }
        Ok(template)
    }

    /// Behind the bracket that closes what was opened before a token.
    fn closing(&self, from: usize) -> usize {
        let mut open = 1;
        for (at, token) in self.tokens.iter().enumerate().skip(from) {
            match token.tok {
                UppaalTokenKind::Mark("{") => open += 1,
                UppaalTokenKind::Mark("}") => open -= 1,
                UppaalTokenKind::End => return at,
                UppaalTokenKind::Mark(_) | UppaalTokenKind::Word(_) | UppaalTokenKind::Int(_) => {}
            }
            if open == 0 {
                return at + 1;
            }
        }
        self.tokens.len()
    }

    /// A state that is named; a fault if there is none.
    fn known_state(&mut self, ids: &BTreeMap<String, usize>, (name, span): &(String, Span)) -> Option<usize> {
        let known = ids.get(name).copied();
        if known.is_none() {
            self.faults.push(UppaalFault { span: *span, message: format!("there is no state `{name}`") });
        }
        known
    }

    fn body(&mut self, template: &mut UppaalTemplate) -> XtaResult<()> {
        self.at += 1;
        let mut ids = BTreeMap::new();
        loop {
            let location = self.state()?;
            ids.insert(location.name.clone().unwrap_or_default(), template.locations.len());
            template.locations.push(location);
            if !self.take(",") {
                break;
            }
        }
        self.expect(";")?;
        let before = self.faults.len();
        let mut branching = BranchingTransitions::default();
        let mut initial = None;
        loop {
            let kind = [("commit", UppaalLocationKind::Committed), ("urgent", UppaalLocationKind::Urgent)];
            if let Some((_, kind)) = kind.into_iter().find(|(word, _)| self.is_word(word)) {
                self.at += 1;
                for named in self.names("a state")? {
                    let Some(at) = self.known_state(&ids, &named) else { continue };
                    if template.locations[at].kind != UppaalLocationKind::Committed {
                        template.locations[at].kind = kind;
                    }
                }
            } else if self.take_word("branchpoint") {
                branching.points.extend(self.names("a branchpoint")?.into_iter().map(|(name, _)| name));
            } else if self.take_word("init") {
                let named = self.name("the initial state")?;
                self.expect(";")?;
                // One that is not there was told.
                initial = Some(self.known_state(&ids, &named).unwrap_or(0));
            } else if self.take_word("trans") {
                self.transitions(&ids, &mut branching, template)?;
            } else {
                break;
            }
        }
        match initial {
            Some(initial) => template.initial = initial,
            None => return self.fault("the initial state (`init`)"),
        }
        match branching.joined() {
            Ok(joined) => template.transitions.extend(joined),
            // A branch that is missing may be one of the transitions that could not be read.
            Err(_) if self.faults.len() > before => {}
            Err(faults) => self.faults.extend(faults),
        }
        Ok(())
    }

    fn state(&mut self) -> XtaResult<UppaalLocation> {
        let (name, span) = self.name("a state")?;
        let (mut invariant, mut rate) = (UppaalFragment::default(), UppaalFragment::default());
        if self.take("{") {
            invariant = self.until(&["}", ";"])?;
            if self.take(";") {
                rate = self.until(&["}", ";"])?;
                let _also_at_its_end = self.take(";");
            }
            self.expect("}")?;
        }
        Ok(UppaalLocation {
            name: Some(name),
            span,
            kind: UppaalLocationKind::Normal,
            invariant,
            rate: rate.text(),
            comment: String::new(),
        })
    }

    fn transitions(
        &mut self,
        ids: &BTreeMap<String, usize>,
        branching: &mut BranchingTransitions,
        template: &mut UppaalTemplate,
    ) -> XtaResult<()> {
        let mut from: Option<(String, Span)> = None;
        loop {
            // After a comma the source may be that of the transition before.
            if !self.is("->") && !self.is("-") {
                from = Some(self.name("the state where a transition begins")?);
            }
            let span = self.span();
            let controllable = !self.take("-");
            if !controllable && !self.take_word("u") {
                return self.fault("`-u->`");
            }
            self.expect("->")?;
            let to = self.name("the state where a transition ends")?;
            let mut transition = self.labels()?;
            transition.uncontrollable = !controllable;
            if !controllable {
                self.uncontrollable.push(span);
            }
            let Some(from) = &from else { return self.fault("the state where a transition begins") };
            let mut end = |named: &(String, Span)| {
                if branching.points.contains(&named.0) {
                    return Some(TransitionEnd::Branchpoint(named.0.clone()));
                }
                self.known_state(ids, named).map(TransitionEnd::Location)
            };
            if let (Some(from), Some(to)) = (end(from), end(&to)) {
                match branching.keep((from, to), span, transition) {
                    Ok(transition) => template.transitions.extend(transition),
                    Err(fault) => self.faults.push(fault),
                }
            }
            if !self.take(",") {
                break;
            }
        }
        self.expect(";")
    }

    fn labels(&mut self) -> XtaResult<UppaalTransition> {
        let mut transition = UppaalTransition::default();
        self.expect("{")?;
        while !self.take("}") {
            let (word, span) = self.name("`select`, `guard`, `sync`, `assign` or `}`")?;
            let text = self.until(&[";"])?;
            self.expect(";")?;
            match word.as_str() {
                "select" => transition.select = text,
                "guard" => transition.guard = text,
                "sync" => transition.sync = text,
                "assign" => transition.assign = text,
                "probability" => transition.probability = text.text(),
                _ => {
                    let message = format!("a label `{word}` of a transition is not known");
                    self.faults.push(UppaalFault { span, message });
                }
            }
        }
        Ok(transition)
    }
}
