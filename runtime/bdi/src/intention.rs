//! Intentions: stacks of partly executed plans.

use hrdsl_ir::{EventPattern, Nanos};

use crate::unify::Slot;

/// A plan that is being executed. Its trigger's arguments and its variables lie next to each other on the
/// intention's stack of slots.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub plan: u16,
    /// The next step of the plan's body.
    pub next: u16,
    /// Where the arguments start.
    pub args: u32,
    /// Where the arguments end and the variables start.
    pub vars: u32,
}

/// What an intention is doing.
#[derive(Clone, Copy, Debug)]
pub(crate) enum State<'p> {
    /// Not in use.
    Free,
    /// Its turn comes.
    Ready,
    /// It waits for the plan of an event in the queue.
    Posted,
    /// It waits for the end of the action with this serial number.
    Acting(u32),
    /// `wait`
    Sleeping,
    /// `await`, with its timer if it is bounded.
    Awaiting { events: &'p [EventPattern], timer: Option<Timer> },
}

/// When something is due; of two that are due together the one set first comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Timer {
    pub due: Nanos,
    pub serial: u64,
    /// The intention's place.
    pub of: u32,
}

#[derive(Debug)]
pub(crate) struct Intention<'p> {
    /// Counted from 1 in the order of adoption.
    pub number: u32,
    pub state: State<'p>,
    pub frames: Vec<Frame>,
    pub slots: Vec<Slot>,
}

impl Intention<'_> {
    /// Puts a plan on top.
    pub fn push(&mut self, plan: u16, args: &[Slot], vars: &[Slot]) {
        let start = self.slots.len() as u32;
        self.frames.push(Frame { plan, next: 0, args: start, vars: start + args.len() as u32 });
        self.slots.extend_from_slice(args);
        self.slots.extend_from_slice(vars);
    }

    /// Takes the top plan off, with its slots.
    pub fn pop(&mut self) {
        if let Some(frame) = self.frames.pop() {
            self.slots.truncate(frame.args as usize);
        }
    }

    /// The arguments of the top plan's trigger.
    pub fn args(&self, frame: Frame) -> &[Slot] {
        &self.slots[frame.args as usize..frame.vars as usize]
    }

    /// The top plan's variables.
    pub fn vars(&mut self) -> &mut [Slot] {
        let start = self.frames.last().map_or(self.slots.len(), |f| f.vars as usize);
        &mut self.slots[start..]
    }
}

/// All intentions; places are used again, with the memory they have.
#[derive(Debug, Default)]
pub(crate) struct Pool<'p> {
    all: Vec<Intention<'p>>,
    free: Vec<u32>,
    adopted: u32,
}

impl<'p> Pool<'p> {
    /// A place for a new intention.
    pub fn adopt(&mut self) -> u32 {
        self.adopted += 1;
        let number = self.adopted;
        if let Some(place) = self.free.pop() {
            let intention = self.at(place);
            (intention.number, intention.state) = (number, State::Ready);
            return place;
        }
        self.all.push(Intention { number, state: State::Ready, frames: Vec::new(), slots: Vec::new() });
        self.all.len() as u32 - 1
    }

    pub fn release(&mut self, place: u32) {
        let intention = self.at(place);
        intention.state = State::Free;
        intention.frames.clear();
        intention.slots.clear();
        self.free.push(place);
    }

    /// The intention at a place that [`adopt`](Self::adopt) gave.
    pub fn at(&mut self, place: u32) -> &mut Intention<'p> {
        &mut self.all[place as usize]
    }

    pub fn get(&self, place: u32) -> Option<&Intention<'p>> {
        self.all.get(place as usize)
    }

    pub fn is_empty(&self) -> bool {
        self.free.len() == self.all.len()
    }

    /// The height of the highest stack.
    pub fn height(&self) -> usize {
        self.all.iter().map(|i| i.frames.len()).max().unwrap_or(0)
    }
}
