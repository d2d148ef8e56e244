//! The declarations of a TChecker file.

use indexmap::IndexMap;

use super::{
    ast::{
        ByteOffset, SyncParticipant, TcheckerArray, TcheckerEdge, TcheckerInt, TcheckerLocation,
        TcheckerModel, TcheckerProcess, TcheckerSync,
    },
    term::TcheckerTermParser,
};

/// What cannot be read, and where.
#[derive(Debug)]
pub struct TcheckerFault {
    pub at: ByteOffset,
    pub message: String,
}

fn fault<T>(at: ByteOffset, message: impl Into<String>) -> Result<T, TcheckerFault> {
    Err(TcheckerFault { at, message: message.into() })
}

/// One declaration: its fields, and its attributes in order.
struct TcheckerDeclaration<'t> {
    fields: Vec<(&'t str, ByteOffset)>,
    attributes: Vec<TcheckerAttribute<'t>>,
}

impl TcheckerDeclaration<'_> {
    /// Those with a lower one are named by those with a higher.
    fn rank(&self) -> usize {
        const ORDER: [&str; 5] = ["event", "process", "location", "edge", "sync"];
        let word = self.fields.first().map_or("", |(word, _)| word);
        if matches!(word, "clock" | "int") { 0 } else { ORDER.iter().position(|w| *w == word).unwrap_or(0) }
    }
}

struct TcheckerAttribute<'t> {
    key: &'t str,
    value: &'t str,
    at: ByteOffset,
    value_at: ByteOffset,
}

/// Reads a whole file. Each declaration with a fault costs that one alone.
pub fn parse(text: &str) -> (TcheckerModel, Vec<TcheckerFault>) {
    let mut reader =
        TcheckerReader { model: TcheckerModel::default(), places: IndexMap::new(), seen_system: false };
    let mut faults = Vec::new();
    let mut at = 0;
    let blank = without_comments(text);
    let mut declarations = Vec::new();
    while let Some(start) = blank[at..].find(|c: char| !c.is_whitespace()).map(|i| at + i) {
        let (declaration, end) = match declaration(&blank, start) {
            Ok(found) => found,
            Err((f, end)) => {
                faults.push(f);
                at = end;
                continue;
            }
        };
        declarations.push(declaration);
        at = end;
    }
    // What is named may be declared further down.
    if let Some((_, rest)) = declarations.split_first_mut() {
        rest.sort_by_key(TcheckerDeclaration::rank);
    }
    let first = declarations.first().and_then(|d| d.fields.first());
    if first.is_some_and(|(word, _)| *word != "system") || first.is_none() && faults.is_empty() {
        // What it declares is known all the same: the others are right to name it.
        reader.seen_system = true;
        let message = "expected `system:NAME` as the first declaration".to_owned();
        faults.push(TcheckerFault { at: first.map_or(0, |(_, at)| *at), message });
    }
    faults.extend(declarations.iter().filter_map(|d| reader.declare(d).err()));
    if reader.model.processes.is_empty() && faults.is_empty() {
        let at = declarations.first().and_then(|d| d.fields.first()).map_or(0, |(_, at)| *at);
        let message = "this system has no process: write `process:NAME`, and its locations and edges";
        faults.push(TcheckerFault { at, message: message.to_owned() });
    }
    (reader.model, faults)
}

/// Comments become blanks, so that places stay.
fn without_comments(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut comment = false;
    for c in text.chars() {
        comment = (comment || c == '#') && c != '\n';
        if comment {
            out.extend(std::iter::repeat_n(' ', c.len_utf8()));
        } else {
            out.push(c);
        }
    }
    out
}

/// The declaration that starts at `start`, and where it ends; a broken one is skipped to the end of its line.
fn declaration(
    text: &str,
    start: ByteOffset,
) -> Result<(TcheckerDeclaration<'_>, ByteOffset), (TcheckerFault, ByteOffset)> {
    let rest = &text[start..];
    let line = rest.find('\n').map_or(text.len(), |i| start + i);
    let head_end = rest.find(['\n', '{']).map_or(text.len(), |i| start + i);
    let mut fields = Vec::new();
    let mut at = start;
    for field in text[start..head_end].split(':') {
        let lead = field.len() - field.trim_start().len();
        fields.push((field.trim(), at + lead));
        at += field.len() + 1;
    }
    if !text[head_end..].starts_with('{') {
        return Ok((TcheckerDeclaration { fields, attributes: Vec::new() }, head_end));
    }
    let Some(close) = text[head_end..].find('}').map(|i| head_end + i) else {
        return Err((
            TcheckerFault { at: head_end, message: "this `{` has no `}`".to_owned() },
            text.len().max(line),
        ));
    };
    match attributes(&text[head_end + 1..close], head_end + 1) {
        Ok(attributes) => Ok((TcheckerDeclaration { fields, attributes }, close + 1)),
        Err(f) => Err((f, close + 1)),
    }
}

/// `key: value : key: value`
fn attributes(text: &str, start: ByteOffset) -> Result<Vec<TcheckerAttribute<'_>>, TcheckerFault> {
    let mut parts = Vec::new();
    let mut at = start;
    for part in text.split(':') {
        let lead = part.len() - part.trim_start().len();
        parts.push((part.trim(), at + lead));
        at += part.len() + 1;
    }
    if let [(only, _)] = parts.as_slice()
        && only.is_empty()
    {
        return Ok(Vec::new());
    }
    let mut all = Vec::new();
    for pair in parts.chunks(2) {
        match pair {
            [(key, at), (value, value_at)] if is_name(key) => {
                all.push(TcheckerAttribute { key, value, at: *at, value_at: *value_at });
            }
            [(key, at), _] => return fault(*at, format!("`{key}` is no name of an attribute")),
            [(key, at)] => return fault(*at, format!("expected `:` after `{key}`, as in `initial:`")),
            _ => {}
        }
    }
    Ok(all)
}

/// Letters, digits, `_` and `.`; a letter or `_` first.
fn is_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_' || c == '$')
        && text.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '.' | '$'))
}

struct TcheckerReader {
    model: TcheckerModel,
    /// Each process's locations by name.
    places: IndexMap<String, IndexMap<String, usize>>,
    seen_system: bool,
}

impl TcheckerReader {
    fn declare(&mut self, d: &TcheckerDeclaration<'_>) -> Result<(), TcheckerFault> {
        let (word, at) = d.fields[0];
        match word {
            "system" => self.system(d),
            "process" => self.process(d),
            "event" => self.event(d),
            "clock" => self.clock(d),
            "int" => self.int(d),
            "location" => self.location(d),
            "edge" => self.edge(d),
            "sync" => self.sync(d),
            _ => fault(
                at,
                format!(
                    "expected `system`, `process`, `event`, `clock`, `int`, `location`, `edge` or `sync`, found `{word}`"
                ),
            ),
        }
    }

    fn ignore(&mut self, attribute: &TcheckerAttribute<'_>) {
        self.model.ignored.push((attribute.key.to_owned(), attribute.at));
    }

    fn ignore_all(&mut self, d: &TcheckerDeclaration<'_>) {
        d.attributes.iter().for_each(|a| self.ignore(a));
    }

    fn system(&mut self, d: &TcheckerDeclaration<'_>) -> Result<(), TcheckerFault> {
        let [name] = fields(d, ["NAME"])?;
        if std::mem::replace(&mut self.seen_system, true) {
            return fault(d.fields[0].1, "there is a second `system`");
        }
        self.model.name = named(name)?;
        self.ignore_all(d);
        Ok(())
    }

    fn process(&mut self, d: &TcheckerDeclaration<'_>) -> Result<(), TcheckerFault> {
        let [name] = fields(d, ["NAME"])?;
        let text = named(name)?;
        if self.places.insert(text.clone(), IndexMap::new()).is_some() {
            return fault(name.1, format!("there is already a process `{text}`"));
        }
        self.model.processes.push(TcheckerProcess {
            name: text,
            at: name.1,
            locations: Vec::new(),
            edges: Vec::new(),
        });
        self.ignore_all(d);
        Ok(())
    }

    fn event(&mut self, d: &TcheckerDeclaration<'_>) -> Result<(), TcheckerFault> {
        let [name] = fields(d, ["NAME"])?;
        let text = named(name)?;
        if self.model.events.contains(&text) {
            return fault(name.1, format!("there is already an event `{text}`"));
        }
        self.model.events.push(text);
        self.ignore_all(d);
        Ok(())
    }

    fn fresh(&self, (name, at): (&str, ByteOffset)) -> Result<String, TcheckerFault> {
        let text = named((name, at))?;
        let clocks = self.model.clocks.iter().map(|c| &c.name);
        let ints = self.model.ints.iter().map(|i| &i.of.name);
        if clocks.chain(ints).any(|known| *known == text) {
            return fault(at, format!("there is already a variable `{text}`"));
        }
        Ok(text)
    }

    fn clock(&mut self, d: &TcheckerDeclaration<'_>) -> Result<(), TcheckerFault> {
        let [size, name] = fields(d, ["SIZE", "NAME"])?;
        let array = TcheckerArray { name: self.fresh(name)?, size: sized(size)?, at: name.1 };
        self.model.clocks.push(array);
        self.ignore_all(d);
        Ok(())
    }

    fn int(&mut self, d: &TcheckerDeclaration<'_>) -> Result<(), TcheckerFault> {
        let [size, lo, hi, init, name] = fields(d, ["SIZE", "MIN", "MAX", "INIT", "NAME"])?;
        let of = TcheckerArray { name: self.fresh(name)?, size: sized(size)?, at: name.1 };
        let int = TcheckerInt { of, lo: number(lo)?, hi: number(hi)?, init: number(init)? };
        if int.lo > int.init || int.init > int.hi {
            return fault(init.1, format!("{} is not within {} and {}", int.init, int.lo, int.hi));
        }
        self.model.ints.push(int);
        self.ignore_all(d);
        Ok(())
    }

    fn process_of(&self, (name, at): (&str, ByteOffset)) -> Result<usize, TcheckerFault> {
        match self.places.get_index_of(name) {
            Some(i) => Ok(i),
            None => fault(at, format!("no process is called `{name}`")),
        }
    }

    fn location(&mut self, d: &TcheckerDeclaration<'_>) -> Result<(), TcheckerFault> {
        let [process, name] = fields(d, ["PROCESS", "NAME"])?;
        let p = self.process_of(process)?;
        let mut location = TcheckerLocation { name: named(name)?, at: name.1, ..TcheckerLocation::default() };
        let known = self.places[p].len();
        if self.places[p].insert(location.name.clone(), known).is_some() {
            return fault(name.1, format!("`{}` has already a location `{}`", process.0, location.name));
        }
        for a in &d.attributes {
            match a.key {
                "initial" => location.initial = true,
                "committed" => location.committed = true,
                "urgent" => location.urgent = true,
                "labels" => {
                    let labels = a.value.split(',').map(str::trim).filter(|l| !l.is_empty());
                    location.labels.extend(labels.map(str::to_owned));
                }
                "invariant" => location.invariant.extend(self.terms(a).condition()?),
                _ => self.ignore(a),
            }
        }
        self.model.processes[p].locations.push(location);
        Ok(())
    }

    fn edge(&mut self, d: &TcheckerDeclaration<'_>) -> Result<(), TcheckerFault> {
        let [process, from, to, event] = fields(d, ["PROCESS", "SOURCE", "TARGET", "EVENT"])?;
        let p = self.process_of(process)?;
        let find = |(name, at): (&str, ByteOffset)| match self.places[p].get(name) {
            Some(&i) => Ok(i),
            None => fault(at, format!("`{}` has no location `{name}`", process.0)),
        };
        let (from, to) = (find(from)?, find(to)?);
        let mut edge = TcheckerEdge {
            from,
            to,
            event: self.event_of(event)?,
            provided: Vec::new(),
            body: Vec::new(),
            at: d.fields[0].1,
        };
        for a in &d.attributes {
            match a.key {
                "provided" => edge.provided.extend(self.terms(a).condition()?),
                "do" => edge.body.extend(self.terms(a).statements()?),
                _ => self.ignore(a),
            }
        }
        self.model.processes[p].edges.push(edge);
        Ok(())
    }

    fn event_of(&self, (name, at): (&str, ByteOffset)) -> Result<String, TcheckerFault> {
        match self.model.events.iter().find(|e| *e == name) {
            Some(event) => Ok(event.clone()),
            None => fault(at, format!("no event is called `{name}`")),
        }
    }

    fn sync(&mut self, d: &TcheckerDeclaration<'_>) -> Result<(), TcheckerFault> {
        let mut participants: Vec<SyncParticipant> = Vec::new();
        for &(field, at) in &d.fields[1..] {
            let (strong, weak) = field.strip_suffix('?').map_or((field, false), |f| (f, true));
            let Some((process, event)) = strong.split_once('@') else {
                return fault(at, format!("expected `PROCESS@EVENT`, found `{field}`"));
            };
            let process = self.process_of((process.trim(), at))?;
            let event = self.event_of((event.trim(), at))?;
            if participants.iter().any(|p| p.process == process) {
                return fault(at, format!("`{field}` is a second part of one process"));
            }
            participants.push(SyncParticipant { process, event, weak });
        }
        if participants.len() < 2 {
            return fault(d.fields[0].1, "a `sync` has two parts at least, as in `sync:P@a:Q@a`");
        }
        self.model.syncs.push(TcheckerSync { participants });
        self.ignore_all(d);
        Ok(())
    }

    fn terms<'a>(&'a self, a: &TcheckerAttribute<'a>) -> TcheckerTermParser<'a> {
        TcheckerTermParser::new(&self.model, a.value, a.value_at)
    }
}

fn named((text, at): (&str, ByteOffset)) -> Result<String, TcheckerFault> {
    if is_name(text) { Ok(text.to_owned()) } else { fault(at, format!("expected a name, found `{text}`")) }
}

fn number((text, at): (&str, ByteOffset)) -> Result<i64, TcheckerFault> {
    text.parse().or_else(|_| fault(at, format!("expected a whole number, found `{text}`")))
}

/// The most elements of an array that are taken: more would be no model that can be searched.
const MAX_SIZE: i64 = 10_000;

fn sized(field: (&str, ByteOffset)) -> Result<u32, TcheckerFault> {
    match number(field)? {
        n @ 1..=MAX_SIZE => Ok(u32::try_from(n).unwrap_or(1)),
        n => fault(field.1, format!("a size is 1 to {MAX_SIZE}, not {n}")),
    }
}

/// The fields after the keyword.
fn fields<'t, const N: usize>(
    d: &TcheckerDeclaration<'t>,
    names: [&str; N],
) -> Result<[(&'t str, ByteOffset); N], TcheckerFault> {
    let (word, at) = d.fields[0];
    <[(&str, ByteOffset); N]>::try_from(&d.fields[1..])
        .or_else(|_| fault(at, format!("expected `{word}:{}`", names.join(":"))))
}
