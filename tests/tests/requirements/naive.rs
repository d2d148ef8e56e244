//! What the pages say of a whole trace, looked at from outside: parts of the run, and in each of them who comes before whom.

use hrdsl_ir::Nanos;
use hrdsl_monitor::MonitorOutcome;
use hrdsl_trace::{Trace, TraceStepKind};

use crate::sentence::{Atom, Cond, Pattern, Scope, Sentence};

#[derive(Clone, Copy, Debug, PartialEq)]
enum What {
    Event(u16),
    /// A condition has got a truth, perhaps the first.
    Becomes(Cond, bool, bool),
    /// Everything new has been looked at.
    Sample,
}

/// What happens, one thing after the other.
#[derive(Clone, Copy, Debug)]
struct Item {
    time: Nanos,
    what: What,
    /// The signals then.
    values: [Option<bool>; 2],
}

/// What is found: in the order of time; at one instant what happens comes before what has not happened by then.
type Place = (Nanos, bool, usize);

#[derive(Clone, Copy, Debug, PartialEq)]
enum Mark {
    Trigger,
    Fail,
}

#[derive(Debug, Default)]
pub(crate) struct Expected {
    pub triggered: usize,
    pub failures: usize,
    pub first: Option<Nanos>,
    open: bool,
}

impl Expected {
    pub fn outcome(&self) -> MonitorOutcome {
        match self {
            e if e.failures > 0 => MonitorOutcome::Fail,
            e if e.open => MonitorOutcome::Inconclusive,
            e if e.triggered == 0 => MonitorOutcome::Vacuous,
            _ => MonitorOutcome::Pass,
        }
    }
}

fn truth(c: Cond, values: [Option<bool>; 2]) -> Option<bool> {
    values[c.signal].map(|v| v == c.holds)
}

fn items(sentence: &Sentence, trace: &Trace) -> Vec<Item> {
    let watched = sentence.watched();
    let mut items: Vec<Item> = Vec::new();
    let (mut values, mut before) = ([None; 2], [None; 2]);
    let mut unseen: Option<Nanos> = None;
    let mut look = |items: &mut Vec<Item>, unseen: &mut Option<Nanos>, values: [Option<bool>; 2]| {
        let Some(time) = unseen.take() else { return };
        for c in &watched {
            let (old, new) = (truth(*c, before), truth(*c, values));
            if let Some(is) = new
                && old != new
            {
                items.push(Item { time, what: What::Becomes(*c, is, old.is_none()), values });
            }
        }
        items.push(Item { time, what: What::Sample, values });
        before = values;
    };
    for step in &trace.steps {
        if unseen.is_some_and(|time| step.time > time) {
            look(&mut items, &mut unseen, values);
        }
        match &step.what {
            TraceStepKind::Event { event, .. } if sentence.names(event.0) => {
                look(&mut items, &mut unseen, values);
                items.push(Item { time: step.time, what: What::Event(event.0), values });
            }
            TraceStepKind::Sample { signal, value } if sentence.reads(usize::from(signal.0)) => {
                values[usize::from(signal.0)] = value.as_bool();
                unseen = Some(step.time);
            }
            TraceStepKind::Event { .. } | TraceStepKind::Sample { .. } | TraceStepKind::Machine(_) => {}
        }
    }
    look(&mut items, &mut unseen, values);
    items
}

fn is(item: &Item, atoms: &[Atom]) -> bool {
    atoms.iter().any(|atom| match (atom, item.what) {
        (Atom::Event(e), What::Event(f)) => *e == f,
        (Atom::Edge { rising, of }, What::Becomes(c, truth, first)) => *of == c && truth == *rising && !first,
        (Atom::Event(_) | Atom::Edge { .. }, _) => false,
    })
}

/// A part of a run: the items between two.
struct Part<'t> {
    items: &'t [Item],
    /// The item that opens it; `None`: it begins with the run.
    from: Option<usize>,
    /// The item that closes it; `None`: it goes on.
    to: Option<usize>,
    end: Nanos,
    /// Whether it counts only if it is closed.
    tentative: bool,
    whole: bool,
}

impl Part<'_> {
    fn first(&self) -> usize {
        self.from.map_or(0, |i| i + 1)
    }

    fn range(&self) -> std::ops::Range<usize> {
        self.first()..self.to.unwrap_or(self.items.len())
    }

    fn begun(&self) -> Nanos {
        self.from.map_or(0, |i| self.items[i].time)
    }

    fn entered(&self) -> Place {
        (self.begun(), false, self.from.unwrap_or(0))
    }

    fn at(&self, i: usize) -> Place {
        (self.items[i].time, false, i)
    }

    /// Whether a time is over while it lasts: what happens at that very time comes before.
    fn is_over(&self, time: Nanos) -> bool {
        self.to.map_or(time <= self.end, |to| time < self.items[to].time)
    }

    fn all(&self, atoms: &[Atom]) -> Vec<usize> {
        self.range().filter(|i| is(&self.items[*i], atoms)).collect()
    }

    /// The truth of a condition where it begins.
    fn at_first(&self, c: Cond) -> Option<bool> {
        self.from.and_then(|i| truth(c, self.items[i].values))
    }

    fn changes(&self, c: Cond, to: bool) -> Vec<(usize, bool)> {
        let change = |i: usize| match self.items[i].what {
            What::Becomes(of, truth, first) if of == c && truth == to => Some((i, first)),
            What::Becomes(..) | What::Event(_) | What::Sample => None,
        };
        self.range().filter_map(change).collect()
    }
}

/// Where a condition becomes true. What holds where the part begins does not become so before it has ceased to hold.
fn rises(part: &Part<'_>, c: Cond) -> Vec<(usize, bool)> {
    let falls = part.changes(c, false);
    let new = |i: usize| part.at_first(c) != Some(true) || falls.iter().any(|(fall, _)| *fall < i);
    part.changes(c, true).into_iter().filter(|(i, _)| new(*i)).collect()
}

fn parts<'t>(scope: &Scope, items: &'t [Item], end: Nanos) -> Vec<Part<'t>> {
    let part = |from, to, tentative| Part { items, from, to, end, tentative, whole: false };
    let after = |from: usize, opens: &dyn Fn(&Item) -> bool| (from..items.len()).find(|i| opens(&items[*i]));
    let pairs = |opens: &dyn Fn(&Item) -> bool, closes: &dyn Fn(&Item) -> bool, tentative| {
        let (mut all, mut next) = (Vec::new(), 0);
        while let Some(from) = after(next, opens) {
            let to = after(from + 1, closes);
            all.push(part(Some(from), to, tentative));
            next = to.map_or(items.len(), |to| to + 1);
        }
        all
    };
    match scope {
        Scope::Whole => vec![Part { whole: true, ..part(None, None, false) }],
        Scope::Before(b) => vec![part(None, after(0, &|i| is(i, b)), true)],
        Scope::After(a) => {
            after(0, &|i| is(i, a)).map(|from| part(Some(from), None, false)).into_iter().collect()
        }
        Scope::Between(a, b) => pairs(&|i| is(i, a), &|i| is(i, b), true),
        Scope::AfterUntil(a, b) => pairs(&|i| is(i, a), &|i| is(i, b), false),
        Scope::While(c) => {
            let becomes = |to: bool| move |i: &Item| matches!(i.what, What::Becomes(of, truth, _) if of == *c && truth == to);
            pairs(&becomes(true), &becomes(false), false)
        }
    }
}

/// What a pattern finds in a part of a run.
#[derive(Default)]
pub(crate) struct Found {
    marks: Vec<(Place, Mark)>,
    /// Something is due when the part has not ended.
    open: bool,
}

impl Found {
    fn trigger(&mut self, at: Place) {
        self.marks.push((at, Mark::Trigger));
    }

    fn fail(&mut self, at: Place) {
        self.marks.push((at, Mark::Fail));
    }

    /// What is due has not come by the end of the part.
    fn missing(&mut self, part: &Part<'_>) {
        match part.to {
            Some(to) => self.fail(part.at(to)),
            None => self.open = true,
        }
    }
}

pub(crate) fn judge(sentence: &Sentence, trace: &Trace) -> Expected {
    let items = items(sentence, trace);
    let mut expected = Expected::default();
    for part in parts(&sentence.scope, &items, trace.end) {
        let mut found = found(&sentence.pattern, &part);
        found.marks.sort_by_key(|(place, _)| *place);
        let first = found.marks.iter().position(|(_, mark)| *mark == Mark::Fail);
        if part.tentative
            && let Some(first) = first
        {
            // What comes after is not looked at; it counts if the part ends.
            found.marks.truncate(first + 1);
            if part.to.is_none() {
                found.marks.pop();
                found.open = true;
            }
        }
        let count = |what| found.marks.iter().filter(|(_, mark)| *mark == what).count();
        expected.triggered += count(Mark::Trigger);
        expected.failures += count(Mark::Fail);
        let failed = found.marks.iter().find(|(_, mark)| *mark == Mark::Fail);
        expected.first = expected.first.or(failed.map(|(place, _)| place.0));
        expected.open = found.open;
    }
    expected
}

fn found(pattern: &Pattern, part: &Part<'_>) -> Found {
    let mut found = Found::default();
    match pattern {
        Pattern::Causes(t, r, early, late) => causes(&mut found, part, [t, r], *early, *late),
        Pattern::Forbids(t, f, u) => forbids(&mut found, part, [t, f, u]),
        Pattern::Precedes(f, t, early, late) => precedes(&mut found, part, [f, t], *early, *late),
        Pattern::Never(e, None) => at_most(&mut found, part, 0, e),
        Pattern::Never(e, Some(c)) => {
            for i in part.all(e) {
                found.trigger(part.at(i));
                if truth(*c, part.items[i].values) == Some(true) {
                    found.fail(part.at(i));
                }
            }
        }
        Pattern::Always(c) => always(&mut found, part, *c),
        Pattern::Eventually(e, late) => eventually(&mut found, part, part.all(e).first().copied(), *late),
        Pattern::EventuallyHolds(c, late) => {
            if part.at_first(*c) == Some(true) {
                found.trigger(part.entered());
            } else {
                let holds = |i: &usize| {
                    part.items[*i].what == What::Sample && truth(*c, part.items[*i].values) == Some(true)
                };
                eventually(&mut found, part, part.range().find(holds), *late);
            }
        }
        Pattern::AtMost(n, e) => at_most(&mut found, part, *n, e),
        Pattern::AtLeast(n, e) | Pattern::Exactly(n, e) => {
            found.trigger(part.entered());
            let all = part.all(e);
            if all.len() < *n {
                found.missing(part);
            }
            if matches!(pattern, Pattern::Exactly(..)) {
                all.iter().skip(*n).for_each(|i| found.fail(part.at(*i)));
            }
        }
        Pattern::LastsAtLeast(c, least) => {
            for (from, _) in rises(part, *c).into_iter().filter(|(_, first)| !first) {
                found.trigger(part.at(from));
                let until = part.changes(*c, false).into_iter().find(|(i, _)| *i > from);
                let begun = part.items[from].time;
                match until {
                    Some((until, _)) if part.items[until].time - begun < *least => found.fail(part.at(until)),
                    Some(_) => {}
                    None => found.open |= part.to.is_none() && begun + least > part.end,
                }
            }
        }
        Pattern::LastsAtMost(c, most) => lasts_at_most(&mut found, part, *c, *most),
    }
    found
}

/// Cuts the part into episodes: each starts with a trigger and lasts until its answer, or until it is too late.
fn causes(
    found: &mut Found,
    part: &Part<'_>,
    [t, r]: [&[Atom]; 2],
    early: Option<Nanos>,
    late: Option<Nanos>,
) {
    let mut next = part.first();
    while let Some(start) = part.all(t).into_iter().find(|i| *i >= next) {
        let begun = part.items[start].time;
        let last = late.map(|late| begun + late);
        let in_time = |i: &usize| *i > start && last.is_none_or(|last| part.items[*i].time <= last);
        let answer = part.all(r).into_iter().find(|i| in_time(i));
        let until = answer
            .unwrap_or_else(|| part.range().find(|i| *i > start && !in_time(i)).unwrap_or(part.range().end));
        found.trigger(part.at(start));
        part.all(t)
            .into_iter()
            .filter(|i| (start + 1..until).contains(i))
            .for_each(|i| found.trigger(part.at(i)));
        match (answer, last) {
            (Some(answer), _) => {
                if early.is_some_and(|early| part.items[answer].time - begun < early) {
                    found.fail(part.at(answer));
                }
                next = answer + 1;
            }
            (None, Some(last)) if part.is_over(last) => {
                found.fail((last, true, 0));
                next = until;
            }
            (None, _) => return found.missing(part),
        }
    }
}

fn forbids(found: &mut Found, part: &Part<'_>, [t, f, u]: [&[Atom]; 3]) {
    let mut armed = false;
    for i in part.range() {
        let [starts, breaks, lifts] = [t, f, u].map(|atoms| is(&part.items[i], atoms));
        if armed && breaks {
            found.fail(part.at(i));
        } else if armed && lifts {
            armed = false;
        } else if starts {
            found.trigger(part.at(i));
            armed = true;
        }
    }
}

fn precedes(
    found: &mut Found,
    part: &Part<'_>,
    [f, t]: [&[Atom]; 2],
    early: Option<Nanos>,
    late: Option<Nanos>,
) {
    let before = part.all(f);
    let first = before.first().copied().unwrap_or(usize::MAX);
    for i in part.all(t) {
        let counts_as_first = i == first || (late.is_some() && i > first && before.contains(&i));
        if counts_as_first {
            continue;
        }
        found.trigger(part.at(i));
        let since = |j: usize| part.items[i].time - part.items[j].time;
        let wrong = i < first
            || early.is_some_and(|early| since(first) < early)
            || late.is_some_and(|late| before.iter().rfind(|j| **j < i).is_some_and(|j| since(*j) > late));
        if wrong {
            found.fail(part.at(i));
        }
    }
}

/// In the whole run each event triggers; elsewhere the part does, where it begins or, if its end decides, there.
fn at_most(found: &mut Found, part: &Part<'_>, n: usize, e: &[Atom]) {
    let all = part.all(e);
    if part.whole {
        all.iter().for_each(|i| found.trigger(part.at(*i)));
    } else if !part.tentative {
        found.trigger(part.entered());
    }
    all.iter().skip(n).for_each(|i| found.fail(part.at(*i)));
    if part.tentative
        && all.len() <= n
        && let Some(to) = part.to
    {
        found.trigger(part.at(to));
    }
}

/// Each change to what is wrong, and what is wrong from the first.
fn always(found: &mut Found, part: &Part<'_>, c: Cond) {
    let sampled = part.range().filter(|i| part.items[*i].what == What::Sample);
    let first = part.at_first(c).map(|v| (part.entered(), v));
    let known =
        first.into_iter().chain(sampled.filter_map(|i| Some((part.at(i), truth(c, part.items[i].values)?))));
    let known: Vec<(Place, bool)> = known.collect();
    if let Some((place, _)) = known.first() {
        found.trigger(*place);
    }
    for (k, (place, holds)) in known.iter().enumerate() {
        if !holds && (k == 0 || known[k - 1].1) {
            found.fail(*place);
        }
    }
}

fn eventually(found: &mut Found, part: &Part<'_>, met: Option<usize>, late: Option<Nanos>) {
    found.trigger(part.entered());
    let last = late.map(|late| part.begun() + late);
    let in_time = |i: usize| last.is_none_or(|last| part.items[i].time <= last);
    match last {
        _ if met.is_some_and(in_time) => {}
        Some(last) if part.is_over(last) => found.fail((last, true, 0)),
        Some(_) | None => found.missing(part),
    }
}

fn lasts_at_most(found: &mut Found, part: &Part<'_>, c: Cond, most: Nanos) {
    let entered = part.at_first(c) == Some(true);
    let begun = rises(part, c).into_iter().map(|(i, _)| (i + 1, part.at(i)));
    for (next, place) in entered.then(|| (part.first(), part.entered())).into_iter().chain(begun) {
        found.trigger(place);
        let last = place.0 + most;
        let until =
            part.changes(c, false).into_iter().find(|(i, _)| *i >= next).map(|(i, _)| part.items[i].time);
        if until.is_some_and(|until| until <= last) {
            continue;
        }
        if until.is_some() || part.is_over(last) {
            found.fail((last, true, 0));
        } else {
            found.open |= part.to.is_none();
        }
    }
}
