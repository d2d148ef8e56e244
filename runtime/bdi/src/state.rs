//! The whole state of an agent as words, to compare one with another.

use hrdsl_ir::{Value, bdi::BeliefAnnotation};

use crate::{
    belief::FactAnnotations,
    cycle::AgentMachine,
    event::{IncomingItem, QueuedEvent, SpeechAct},
    intention::{Intention, IntentionState, IntentionTimer},
    repeat::FingerprintedState,
    unify::VariableSlot,
};

fn mix(a: u64, b: u64) -> u64 {
    (a.rotate_left(5) ^ b).wrapping_mul(0x517c_c1b7_2722_0a95)
}

fn number(slot: VariableSlot) -> u64 {
    slot.map_or(7, |v| mix(u64::from(v.key().0), v.key().1))
}

fn hash(slots: &[VariableSlot]) -> u64 {
    slots.iter().fold(slots.len() as u64, |h, s| mix(h, number(*s)))
}

impl FingerprintedState for AgentMachine<'_> {
    fn fingerprint(&self) -> u64 {
        let of = |place: u32| {
            let i = self.mind.pool.see(place);
            let next = i.frames.last().map_or(0, |f| u64::from(f.next) << 16 | u64::from(f.plan));
            mix(mix(hash(i.vars()), i.frames.len() as u64), next)
        };
        let front = self.mind.events.front();
        let events = front.map_or(0, |e| mix(hash(&e.args), e.of.map_or(0, of)));
        let top = self.ready.front().map_or(0, |p| of(*p));
        let counts = [self.mind.events.len(), self.ready.len(), self.mind.pool.in_use(), self.inbox.len()];
        counts.iter().fold(mix(events, top), |h, n| mix(h, *n as u64))
    }

    fn state(&self) -> Vec<u64> {
        let mut out = Vec::new();
        let order = self.mind.pool.in_order();
        // Intentions are known by their rank: numbers and places differ from time to time.
        let mut ranks = vec![0; order.iter().max().map_or(0, |last| *last as usize + 1)];
        (1..).zip(&order).for_each(|(rank, place)| ranks[*place as usize] = rank);
        let rank = |place: u32| ranks.get(place as usize).copied().unwrap_or(0);
        for rows in self.mind.beliefs.all() {
            out.push(rows.len() as u64);
            for row in rows.iter() {
                rows.row(row).iter().for_each(|v| value(&mut out, *v));
                annotations(&mut out, rows.annotations(row));
            }
        }
        out.push(self.mind.events.len() as u64);
        self.mind.events.iter().for_each(|e| event(&mut out, e, &rank));
        out.push(self.inbox.len() as u64);
        self.inbox.iter().for_each(|i| incoming(&mut out, i));
        for places in [self.ready.iter().copied().collect::<Vec<_>>(), self.awaiting.clone()] {
            out.push(places.len() as u64);
            out.extend(places.into_iter().map(rank));
        }
        for place in &order {
            self.intention(&mut out, self.mind.pool.see(*place), &rank);
        }
        out.push(self.timers.len() as u64);
        self.timers.iter().for_each(|t| self.timer(&mut out, t, &rank));
        out.push(self.dice.draws);
        // What was given out is never taken back, so that its number says all.
        out.extend([self.outbox.len() as u64, self.actions.len() as u64]);
        out
    }
}

impl AgentMachine<'_> {
    fn timer(&self, out: &mut Vec<u64>, timer: &IntentionTimer, rank: &dyn Fn(u32) -> u64) {
        out.extend([(timer.due - self.mind.now) as u64, rank(timer.of)]);
    }

    fn intention(&self, out: &mut Vec<u64>, i: &Intention, rank: &dyn Fn(u32) -> u64) {
        let state = match i.state {
            IntentionState::Free => [0, 0],
            IntentionState::Ready => [1, 0],
            IntentionState::Held => [2, 0],
            IntentionState::Posted => [3, 0],
            IntentionState::Acting(serial) => [4, u64::from(serial)],
            IntentionState::Sleeping(_) => [5, 0],
            IntentionState::Awaiting { events, .. } => [6, events.as_ptr().addr() as u64],
            IntentionState::Asking { question, .. } => [7, question],
            IntentionState::Forked { left, all } => [8 + u64::from(all), u64::from(left)],
        };
        out.extend(state);
        out.extend([u64::from(i.suspended), i.frames.len() as u64]);
        for f in &i.frames {
            out.push(u64::from(f.plan) << 32 | u64::from(f.next) << 16 | u64::from(f.at));
            out.push(u64::from(f.args) << 33 | u64::from(f.vars) << 1 | u64::from(f.branch));
        }
        i.slots.iter().for_each(|s| slot(out, *s));
        for l in &i.loops {
            out.extend([u64::from(l.height), l.used as u64, l.answers.len() as u64]);
            out.extend(l.open.iter().map(|v| u64::from(*v)));
            l.answers.iter().for_each(|s| slot(out, *s));
        }
        for d in &i.deadlines {
            out.push(u64::from(d.height));
            self.timer(out, &d.timer, rank);
        }
        out.push(i.parent.map_or(0, rank));
        out.extend(i.children.iter().map(|c| rank(*c)));
        let reply = i.reply.map(|r| [u64::from(r.to), u64::from(r.content.0), r.question.unwrap_or(0)]);
        out.extend(reply.unwrap_or_default());
    }
}

fn value(out: &mut Vec<u64>, v: Value) {
    let (kind, content) = v.key();
    out.extend([u64::from(kind), content]);
}

fn slot(out: &mut Vec<u64>, slot: VariableSlot) {
    match slot {
        Some(v) => value(out, v),
        None => out.extend([99, 0]),
    }
}

fn slots(out: &mut Vec<u64>, all: &[VariableSlot]) {
    out.push(all.len() as u64);
    all.iter().for_each(|s| slot(out, *s));
}

fn annotations(out: &mut Vec<u64>, all: &FactAnnotations) {
    out.push(all.len() as u64);
    for (what, v) in all {
        out.push(match what {
            BeliefAnnotation::Source => 0,
            BeliefAnnotation::Declared(at) => u64::from(*at) + 1,
        });
        value(out, *v);
    }
}

fn event(out: &mut Vec<u64>, e: &QueuedEvent, rank: &dyn Fn(u32) -> u64) {
    use hrdsl_ir::bdi::TriggerOn as On;
    out.extend(
        match e.on {
            On::BeliefAdded(b) => [0, b.0],
            On::BeliefRemoved(b) => [1, b.0],
            On::GoalAdded(g) => [2, g.0],
            On::GoalFailed(g) => [3, g.0],
            On::TestAdded(b) => [4, b.0],
            On::TestFailed(b) => [5, b.0],
            On::Perceived(e) => [6, e.0],
        }
        .map(u64::from),
    );
    slots(out, &e.args);
    e.annotations().iter().for_each(|a| annotations(out, a));
    out.push(e.of.map_or(0, rank));
    out.push(e.told.map_or(0, |who| who.number()));
}

fn incoming(out: &mut Vec<u64>, i: &IncomingItem) {
    match i {
        IncomingItem::Perceived { event, args } => {
            out.extend([0, u64::from(event.0)]);
            args.iter().for_each(|v| value(out, *v));
        }
        IncomingItem::Heard { from, speech } => {
            out.extend([1, u64::from(*from)]);
            match speech {
                SpeechAct::Say { performative, content, args, annotations: told } => {
                    out.extend([*performative as u64, u64::from(content.0)]);
                    slots(out, args);
                    annotations(out, told);
                }
                SpeechAct::Ask { question, content, args, all } => {
                    out.extend([10, *question, u64::from(content.0), u64::from(*all)]);
                    slots(out, args);
                }
                SpeechAct::Answer { question, answers, .. } => {
                    out.extend([11, *question]);
                    answers.iter().flatten().for_each(|a| slots(out, a));
                }
            }
        }
    }
}

/// A number for what waits first.
pub(crate) fn letter(i: &IncomingItem) -> u64 {
    let mut out = Vec::new();
    incoming(&mut out, i);
    out.into_iter().fold(0, mix)
}
