//! The text of the scenario.

use indexmap::{IndexMap, IndexSet};

use super::{
    ast::{
        TcheckerEdge, TcheckerExpr, TcheckerExprKind, TcheckerModel, TcheckerProcess, TcheckerStatement,
        TcheckerStatementKind,
    },
    effect::{self, TranslatedEffect},
    expr::{ScenarioExprWriter, constant},
    names::TcheckerScenarioNames,
    parse::TcheckerFault,
};
use crate::exchange::note::NoteSeverity;

/// The most edges that one edge becomes because it names a clock by an index that varies.
const MAX_COPIES: usize = 1_000;

pub struct TcheckerTranslation {
    pub text: String,
    pub notes: Vec<(usize, NoteSeverity, String)>,
}

/// The scenario, before it is formatted.
///
/// # Errors
/// What a scenario cannot say.
pub fn write(model: &TcheckerModel) -> Result<TcheckerTranslation, Vec<TcheckerFault>> {
    let mut writer = TcheckerTranslator {
        model,
        names: TcheckerScenarioNames::new(model),
        owners: owners(model),
        out: String::new(),
        notes: Vec::new(),
        faults: Vec::new(),
    };
    writer.header();
    for p in 0..model.processes.len() {
        writer.process(p);
    }
    writer.footer();
    if writer.faults.is_empty() {
        Ok(TcheckerTranslation { text: writer.out, notes: writer.notes })
    } else {
        Err(writer.faults)
    }
}

struct TcheckerTranslator<'a> {
    model: &'a TcheckerModel,
    names: TcheckerScenarioNames,
    /// Of each clock, the processes that name it.
    owners: Vec<IndexSet<usize>>,
    out: String,
    notes: Vec<(usize, NoteSeverity, String)>,
    faults: Vec<TcheckerFault>,
}

impl TcheckerTranslator<'_> {
    fn line(&mut self, text: &str) {
        self.out.push_str(text);
        self.out.push('\n');
    }

    /// The clock belongs to this process alone.
    fn is_own(&self, clock: usize, process: usize) -> bool {
        self.owners[clock].len() == 1 && self.owners[clock].contains(&process)
    }

    fn header(&mut self) {
        let scenario = self.names.scenario.clone();
        self.line(&format!("scenario {scenario}\n"));
        for (int, name) in self.model.ints.iter().zip(self.names.ints.clone()) {
            let (lo, hi, init) = (int.lo, int.hi, int.init);
            let text = match int.of.size {
                1 => format!("var {name}: {lo}..{hi} = {init}"),
                n => {
                    let values = vec![init.to_string(); n as usize].join(", ");
                    format!("var {name}: ({lo}..{hi})[{n}] = ({values})")
                }
            };
            self.line(&text);
        }
        for clock in 0..self.model.clocks.len() {
            if self.owners[clock].len() != 1 {
                for name in self.names.clocks[clock].clone() {
                    self.line(&format!("var {name}: clock"));
                }
            }
        }
        for (sync, name) in self.model.syncs.iter().zip(self.names.channels.clone()) {
            let participant = |p: &super::ast::SyncParticipant| {
                format!("{}{}", self.names.processes[p.process], if p.weak { "?" } else { "" })
            };
            let participants: Vec<String> = sync.participants.iter().map(participant).collect();
            self.line(&format!("channel {name} : joint {}", participants.join(" | ")));
        }
        for (what, old, new, at) in self.names.changed.clone() {
            self.notes.push((at, NoteSeverity::Info, format!("the {what} `{old}` is called `{new}`")));
        }
    }

    fn process(&mut self, p: usize) {
        let process = &self.model.processes[p];
        let own: Vec<String> = (0..self.model.clocks.len())
            .filter(|c| self.is_own(*c, p))
            .flat_map(|c| self.names.clocks[c].clone())
            .collect();
        let mut body = Vec::new();
        if !own.is_empty() {
            body.push(format!("clock {}", own.join(", ")));
        }
        self.locations(p, process, &mut body);
        let mut edges = Vec::new();
        for edge in &process.edges {
            match self.edge(p, edge) {
                Ok(found) => edges.extend(found),
                Err(fault) => self.faults.push(fault),
            }
        }
        let (functions, edges): (Vec<_>, Vec<_>) = edges.into_iter().unzip();
        body.extend(functions.into_iter().flatten());
        body.extend(edges);
        let name = self.names.processes[p].clone();
        self.line(&format!("\nautomaton {name} {{\n{}\n}}", body.join("\n")));
    }

    fn locations(&mut self, p: usize, process: &TcheckerProcess, body: &mut Vec<String>) {
        let initial: Vec<usize> =
            (0..process.locations.len()).filter(|l| process.locations[*l].initial).collect();
        if initial.is_empty() {
            let message = format!("`{}` has no initial location: write `{{initial:}}`", process.name);
            self.faults.push(TcheckerFault { at: process.at, message });
        }
        for (l, location) in process.locations.iter().enumerate() {
            let init = if initial == [l] { "init " } else { "" };
            let kind = match (location.committed, location.urgent) {
                (true, _) => "committed ",
                (false, true) => "urgent ",
                (false, false) => "",
            };
            let parts = self.conjunction(&location.invariant);
            let invariant = match parts.as_slice() {
                [] => String::new(),
                parts => format!(" {{ invariant {} }}", parts.join(" && ")),
            };
            let name = &self.names.locations[p][l];
            body.push(format!("{init}{kind}location {name}{invariant}"));
        }
        if initial.len() > 1 {
            let start = self.names.fresh("start");
            body.push(format!("init committed location {start}"));
            for l in initial {
                body.push(format!("{start} -> {}", self.names.locations[p][l]));
            }
            let message =
                format!("`{}` starts in any of several locations: by way of `{start}`", process.name);
            self.notes.push((process.at, NoteSeverity::Info, message));
        }
    }

    fn conjunction(&mut self, parts: &[TcheckerExpr]) -> Vec<String> {
        let exprs = ScenarioExprWriter { model: self.model, names: &self.names };
        let (good, bad): (Vec<_>, Vec<_>) = parts.iter().map(|e| exprs.part(e)).partition(Result::is_ok);
        self.faults.extend(bad.into_iter().filter_map(Result::err));
        good.into_iter().filter_map(Result::ok).collect()
    }

    /// The edges that an edge becomes: one for each synchronisation of its event, and for each value of a clock's index.
    fn edge(&mut self, p: usize, edge: &TcheckerEdge) -> Result<Vec<(Vec<String>, String)>, TcheckerFault> {
        let syncs: Vec<String> = self
            .model
            .syncs
            .iter()
            .zip(&self.names.channels)
            .filter(|(s, _)| s.participants.iter().any(|q| q.process == p && q.event == edge.event))
            .map(|(_, name)| name.clone())
            .collect();
        let mut copies = Vec::new();
        instances(self.model, edge.provided.clone(), edge.body.clone(), &mut copies)?;
        let mut written = Vec::new();
        for (provided, body) in copies {
            let mut names = Vec::new();
            let wanted = format!("update_{}_{}", self.names.processes[p], edge.event);
            let fresh = &mut self.names;
            // Names are given first: the writer of expressions reads them.
            let complex =
                body.iter().filter(|s| !matches!(s.kind, TcheckerStatementKind::Assign { .. })).count();
            for _ in 0..complex + 1 {
                if complex > 0 {
                    names.push(fresh.fresh(&wanted));
                }
            }
            let exprs = ScenarioExprWriter { model: self.model, names: &self.names };
            let mut left = names.into_iter();
            let effect = effect::effect(&exprs, (&provided, &body), &mut || left.next().unwrap_or_default())?;
            let mut guard: Vec<String> = provided.iter().map(|e| exprs.part(e)).collect::<Result<_, _>>()?;
            guard.extend(effect.guards.iter().cloned());
            self.note_ranges(edge, &effect, !syncs.is_empty());
            written.extend(self.text(p, edge, &syncs, &guard, effect));
        }
        Ok(written)
    }

    fn note_ranges(&mut self, edge: &TcheckerEdge, effect: &TranslatedEffect, shared: bool) {
        if let Some(at) = effect.unguarded {
            let message =
                "an assignment out of range is a fault of the model here; TChecker makes the edge impossible";
            self.notes.push((at, NoteSeverity::Warning, message.to_owned()));
        }
        if shared && !effect.guards.is_empty() {
            let message = "the guard that keeps this edge's integers in range is evaluated before the statements of the others";
            self.notes.push((edge.at, NoteSeverity::Info, message.to_owned()));
        }
    }

    fn text(
        &self,
        p: usize,
        edge: &TcheckerEdge,
        syncs: &[String],
        guard: &[String],
        effect: TranslatedEffect,
    ) -> Vec<(Vec<String>, String)> {
        let name = |l: usize| self.names.locations[p][l].as_str();
        let mut head = format!("{} -> {}", name(edge.from), name(edge.to));
        if !guard.is_empty() {
            head += &format!(" when {}", guard.join(" && "));
        }
        let actions = match effect.actions.as_slice() {
            [] => String::new(),
            actions => format!(" do {}", actions.join("; ")),
        };
        let mut functions: Vec<String> =
            effect.functions.into_iter().map(|(name, body)| format!("fn {name}() {{\n{body}}}")).collect();
        let ways: Vec<String> = match syncs {
            [] => vec![format!("{head}{actions} // {}", edge.event)],
            syncs => syncs.iter().map(|s| format!("{head} on {s}{actions}")).collect(),
        };
        ways.into_iter().map(|way| (std::mem::take(&mut functions), way)).collect()
    }

    fn footer(&mut self) {
        let processes = self.names.processes.join(" | ");
        let network = self.names.network.clone();
        self.line(&format!("\nnetwork {network} = {processes}"));
        let mut labels: IndexMap<String, Vec<String>> = IndexMap::new();
        for (p, process) in self.model.processes.iter().enumerate() {
            for (l, location) in process.locations.iter().enumerate() {
                for label in &location.labels {
                    let place = format!("{}.{}", self.names.processes[p], self.names.locations[p][l]);
                    labels.entry(label.clone()).or_default().push(place);
                }
            }
        }
        if !labels.is_empty() {
            self.line("\n// ── Labels ── each is reached if its query holds.");
        }
        for (label, places) in labels {
            let name = self.names.fresh(&format!("label_{label}"));
            self.line(&format!("query {name} \"{label}\" of {network} = E<> {}", places.join(" || ")));
        }
    }
}

// ── Clocks ──

/// Of each clock, the processes that name it.
fn owners(model: &TcheckerModel) -> Vec<IndexSet<usize>> {
    let mut owners = vec![IndexSet::new(); model.clocks.len()];
    for (p, process) in model.processes.iter().enumerate() {
        let mut see = |name: &str| {
            if let Some(c) = model.clocks.iter().position(|c| c.name == name) {
                owners[c].insert(p);
            }
        };
        for e in process.locations.iter().flat_map(|l| &l.invariant) {
            each_name(e, &mut see);
        }
        for edge in &process.edges {
            edge.provided.iter().for_each(|e| each_name(e, &mut see));
            edge.body.iter().for_each(|s| each_in(s, &mut see));
        }
    }
    owners
}

fn each_name(e: &TcheckerExpr, f: &mut dyn FnMut(&str)) {
    match &e.kind {
        TcheckerExprKind::Int(_) => {}
        TcheckerExprKind::Name(name, index) => {
            f(name);
            index.iter().for_each(|i| each_name(i, f));
        }
        TcheckerExprKind::Neg(a) | TcheckerExprKind::Not(a) => each_name(a, f),
        TcheckerExprKind::Binary(_, a, b) => {
            each_name(a, f);
            each_name(b, f);
        }
        TcheckerExprKind::If(c, a, b) => [c, a, b].into_iter().for_each(|e| each_name(e, f)),
    }
}

fn each_in(s: &TcheckerStatement, f: &mut dyn FnMut(&str)) {
    match &s.kind {
        TcheckerStatementKind::Assign { name, index, value } => {
            f(name);
            index.iter().for_each(|i| each_name(i, f));
            each_name(value, f);
        }
        TcheckerStatementKind::If { condition, then, otherwise } => {
            each_name(condition, f);
            then.iter().chain(otherwise).for_each(|s| each_in(s, f));
        }
        TcheckerStatementKind::While { condition, body } => {
            each_name(condition, f);
            body.iter().for_each(|s| each_in(s, f));
        }
        TcheckerStatementKind::Local { size, init, .. } => {
            size.iter().chain(init).for_each(|e| each_name(e, f))
        }
    }
}

/// One copy for each value of each index of a clock that varies, with the guard that the index has it.
fn instances(
    model: &TcheckerModel,
    provided: Vec<TcheckerExpr>,
    body: Vec<TcheckerStatement>,
    out: &mut Vec<(Vec<TcheckerExpr>, Vec<TcheckerStatement>)>,
) -> Result<(), TcheckerFault> {
    let mut found: Option<(TcheckerExpr, u32)> = None;
    for e in &provided {
        find_varying(model, e, &mut found);
    }
    let mut assigned: Vec<String> = Vec::new();
    for s in &body {
        if let TcheckerStatementKind::Assign { name, index, value } = &s.kind {
            let target = TcheckerExpr {
                kind: TcheckerExprKind::Name(name.clone(), index.clone().map(Box::new)),
                at: s.at,
            };
            let before = found.clone();
            find_varying(model, &target, &mut found);
            find_varying(model, value, &mut found);
            if let (None, Some((e, _))) = (&before, &found) {
                let mut changed = false;
                each_name(e, &mut |n| changed |= assigned.iter().any(|a| a == n));
                if changed {
                    let message = "the index of this clock changes on the edge itself";
                    return Err(TcheckerFault { at: e.at, message: message.to_owned() });
                }
            }
            assigned.push(name.clone());
        }
    }
    let Some((index, size)) = found else {
        out.push((provided, body));
        return Ok(());
    };
    for n in 0..size {
        if out.len() >= MAX_COPIES {
            return Err(TcheckerFault {
                at: index.at,
                message: "this index makes too many edges".to_owned(),
            });
        }
        let value = TcheckerExpr { kind: TcheckerExprKind::Int(i64::from(n)), at: index.at };
        let mut guards: Vec<TcheckerExpr> =
            provided.iter().map(|e| replaced(model, e, &index, &value)).collect();
        let same = TcheckerExprKind::Binary(
            super::ast::TcheckerOperator::Eq,
            Box::new(index.clone()),
            Box::new(value.clone()),
        );
        guards.push(TcheckerExpr { kind: same, at: index.at });
        let body = body.iter().map(|s| replaced_in(model, s, &index, &value)).collect();
        instances(model, guards, body, out)?;
    }
    Ok(())
}

fn find_varying(model: &TcheckerModel, e: &TcheckerExpr, found: &mut Option<(TcheckerExpr, u32)>) {
    match &e.kind {
        TcheckerExprKind::Int(_) => {}
        TcheckerExprKind::Name(name, Some(index)) => {
            let clock = model.clocks.iter().find(|c| c.name == *name);
            if let (Some(clock), None, None) = (clock, constant(index), &found) {
                *found = Some(((**index).clone(), clock.size));
            }
        }
        TcheckerExprKind::Name(_, None) => {}
        TcheckerExprKind::Neg(a) | TcheckerExprKind::Not(a) => find_varying(model, a, found),
        TcheckerExprKind::Binary(_, a, b) => {
            find_varying(model, a, found);
            find_varying(model, b, found);
        }
        TcheckerExprKind::If(c, a, b) => [c, a, b].into_iter().for_each(|e| find_varying(model, e, found)),
    }
}

/// The same text, wherever it is written.
fn same(a: &TcheckerExpr, b: &TcheckerExpr) -> bool {
    match (&a.kind, &b.kind) {
        (TcheckerExprKind::Int(m), TcheckerExprKind::Int(n)) => m == n,
        (TcheckerExprKind::Name(m, i), TcheckerExprKind::Name(n, j)) => {
            m == n
                && match (i, j) {
                    (Some(i), Some(j)) => same(i, j),
                    (None, None) => true,
                    (Some(_), None) | (None, Some(_)) => false,
                }
        }
        (TcheckerExprKind::Neg(a), TcheckerExprKind::Neg(b))
        | (TcheckerExprKind::Not(a), TcheckerExprKind::Not(b)) => same(a, b),
        (TcheckerExprKind::Binary(p, a, b), TcheckerExprKind::Binary(q, c, d)) => {
            p == q && same(a, c) && same(b, d)
        }
        (TcheckerExprKind::If(a, b, c), TcheckerExprKind::If(d, e, f)) => {
            same(a, d) && same(b, e) && same(c, f)
        }
        (
            TcheckerExprKind::Int(_)
            | TcheckerExprKind::Name(..)
            | TcheckerExprKind::Neg(_)
            | TcheckerExprKind::Not(_)
            | TcheckerExprKind::Binary(..)
            | TcheckerExprKind::If(..),
            _,
        ) => false,
    }
}

/// The expression with this index of a clock replaced by a number.
fn replaced(
    model: &TcheckerModel,
    e: &TcheckerExpr,
    index: &TcheckerExpr,
    value: &TcheckerExpr,
) -> TcheckerExpr {
    let sub = |e: &TcheckerExpr| Box::new(replaced(model, e, index, value));
    let kind = match &e.kind {
        TcheckerExprKind::Int(n) => TcheckerExprKind::Int(*n),
        TcheckerExprKind::Name(name, Some(i))
            if same(i, index) && model.clocks.iter().any(|c| c.name == *name) =>
        {
            TcheckerExprKind::Name(name.clone(), Some(Box::new(value.clone())))
        }
        TcheckerExprKind::Name(name, i) => TcheckerExprKind::Name(name.clone(), i.as_ref().map(|i| sub(i))),
        TcheckerExprKind::Neg(a) => TcheckerExprKind::Neg(sub(a)),
        TcheckerExprKind::Not(a) => TcheckerExprKind::Not(sub(a)),
        TcheckerExprKind::Binary(op, a, b) => TcheckerExprKind::Binary(*op, sub(a), sub(b)),
        TcheckerExprKind::If(c, a, b) => TcheckerExprKind::If(sub(c), sub(a), sub(b)),
    };
    TcheckerExpr { kind, at: e.at }
}

fn replaced_in(
    model: &TcheckerModel,
    s: &TcheckerStatement,
    index: &TcheckerExpr,
    value: &TcheckerExpr,
) -> TcheckerStatement {
    let TcheckerStatementKind::Assign { name, index: at, value: of } = &s.kind else { return s.clone() };
    let target =
        TcheckerExpr { kind: TcheckerExprKind::Name(name.clone(), at.clone().map(Box::new)), at: s.at };
    let TcheckerExprKind::Name(name, at) = replaced(model, &target, index, value).kind else {
        return s.clone();
    };
    let of = replaced(model, of, index, value);
    TcheckerStatement {
        kind: TcheckerStatementKind::Assign { name, index: at.map(|i| *i), value: of },
        at: s.at,
    }
}
