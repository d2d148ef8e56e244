//! Intentions: stacks of partly executed plans.

use hrdsl_ir::{EventPattern, Nanos, Symbol};
use smallvec::SmallVec;

use crate::{event::ReplyAddress, unify::VariableSlot};

/// A plan that is being executed. Its trigger's arguments and its variables lie next to each other on the
/// intention's stack of slots.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlanFrame {
    pub plan: u16,
    /// The next line of the plan's code.
    pub next: u16,
    /// The line of the step begun last; [`NO_LINE`] before the first.
    pub at: u16,
    /// Where the arguments start.
    pub args: u32,
    /// Where the arguments end and the variables start.
    pub vars: u32,
    /// The plans that lay below when it came, the nearest first; [`NO_PLAN`] if there was none.
    pub under: [u16; 2],
    /// A branch of a `fork`: the goal is its parent's.
    pub branch: bool,
    /// Of an atomic plan.
    pub atomic: bool,
    /// Of a goal: the other agent that asked for it.
    pub told: Option<Symbol>,
}

pub(crate) const NO_PLAN: u16 = u16::MAX;
pub(crate) const NO_LINE: u16 = u16::MAX;

/// What an intention is doing.
#[derive(Clone, Copy, Debug)]
pub(crate) enum IntentionState<'p> {
    /// Not in use.
    Free,
    /// Its turn comes.
    Ready,
    /// Its turn would come, but it is suspended.
    Held,
    /// It waits for the plan of an event in the queue.
    Posted,
    /// It waits for the end of the action with this serial number.
    Acting(u32),
    /// `wait`
    Sleeping(IntentionTimer),
    /// `await`, with its timer if it is bounded.
    Awaiting { events: &'p [EventPattern], timer: Option<IntentionTimer> },
    /// It waits for the answer to the question of this number.
    Asking { question: u64, timer: Option<IntentionTimer> },
    /// It waits for its branches: for all, or for the first. So many are not finished.
    Forked { left: u32, all: bool },
}

/// When something is due; of two that are due together the one set first comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct IntentionTimer {
    pub due: Nanos,
    pub serial: u64,
    /// The intention's place.
    pub of: u32,
}

/// A goal that must be achieved in time: that of the frame at this height.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GoalDeadline {
    pub height: u32,
    pub timer: IntentionTimer,
}

/// A `while` or `for` that is being executed.
#[derive(Clone, Debug)]
pub(crate) struct LoopFrame {
    /// The number of frames up to its own.
    pub height: u32,
    /// The variables that are open again each time.
    pub open: SmallVec<[u16; 4]>,
    /// Of `for`: their values, answer by answer, and how many answers were used.
    pub answers: Vec<VariableSlot>,
    pub used: usize,
}

#[derive(Debug)]
pub(crate) struct Intention<'p> {
    /// Counted from 1 in the order in which they get their first plan; 0 before.
    pub number: u32,
    pub state: IntentionState<'p>,
    pub suspended: bool,
    /// How many of its plans are atomic.
    pub atomic: u32,
    pub frames: Vec<PlanFrame>,
    pub slots: Vec<VariableSlot>,
    pub loops: Vec<LoopFrame>,
    pub deadlines: Vec<GoalDeadline>,
    /// Of a branch: the intention that forked.
    pub parent: Option<u32>,
    pub children: SmallVec<[u32; 2]>,
    /// Who waits for the answer of the lowest plan, a test goal's.
    pub reply: Option<ReplyAddress>,
}

impl Intention<'_> {
    /// Puts a plan on top.
    #[inline]
    fn push(&mut self, plan: u16, next: u16, args: &[VariableSlot], vars: &[VariableSlot]) {
        let start = self.slots.len() as u32;
        let vars_at = start + args.len() as u32;
        let below = self.frames.last();
        let under = below.map_or([NO_PLAN; 2], |f| [f.plan, f.under[0]]);
        self.frames.push(PlanFrame {
            plan,
            next,
            at: NO_LINE,
            args: start,
            vars: vars_at,
            under,
            branch: false,
            atomic: false,
            told: None,
        });
        self.slots.extend_from_slice(args);
        self.slots.extend_from_slice(vars);
    }

    /// Takes the top plan off, with its slots and loops; also gives how many answers these held.
    #[inline]
    fn pop(&mut self) -> Option<(PlanFrame, usize)> {
        let frame = self.frames.pop()?;
        self.slots.truncate(frame.args as usize);
        let mut answers = 0;
        while let Some(over) = self.loops.pop_if(|l| l.height as usize > self.frames.len()) {
            answers += over.answers.len();
        }
        self.spare();
        Some((frame, answers))
    }

    /// Many intentions that were high once must not keep the memory of that.
    #[inline]
    fn spare(&mut self) {
        if self.frames.capacity() > SPARE && self.frames.len() < self.frames.capacity() / 4 {
            self.frames.shrink_to(self.frames.capacity() / 2);
        }
        if self.slots.capacity() > SPARE && self.slots.len() < self.slots.capacity() / 4 {
            self.slots.shrink_to(self.slots.capacity() / 2);
        }
    }

    /// The arguments of a frame's trigger.
    pub fn args(&self, frame: PlanFrame) -> &[VariableSlot] {
        &self.slots[frame.args as usize..frame.vars as usize]
    }

    /// The plan whose step it does, or waits for.
    pub fn top(&self) -> &PlanFrame {
        &self.frames[self.frames.len() - 1]
    }

    /// The top plan's variables.
    pub fn vars(&self) -> &[VariableSlot] {
        let start = self.frames.last().map_or(self.slots.len(), |f| f.vars as usize);
        &self.slots[start..]
    }

    pub fn vars_mut(&mut self) -> &mut [VariableSlot] {
        let start = self.frames.last().map_or(self.slots.len(), |f| f.vars as usize);
        &mut self.slots[start..]
    }

    /// How many values each frame holds, with its plan.
    pub fn values_by_plan(&self) -> impl Iterator<Item = (u16, usize)> {
        let ends = self.frames.iter().skip(1).map(|f| f.args as usize).chain([self.slots.len()]);
        let stacked = self.frames.iter().zip(ends).map(|(f, end)| (f.plan, end - f.args as usize));
        let plan = |l: &LoopFrame| self.frames.get(l.height as usize - 1).map_or(NO_PLAN, |f| f.plan);
        stacked.chain(self.loops.iter().map(move |l| (plan(l), l.answers.len())))
    }
}

/// All intentions; places are used again, with the memory they have.
#[derive(Debug, Default)]
pub(crate) struct IntentionPool<'p> {
    all: Vec<Intention<'p>>,
    free: Vec<u32>,
    adopted: u32,
    /// On all stacks.
    plans: usize,
    /// On all stacks, and in all loops.
    values: usize,
}

/// A stack that was larger than this gives memory back.
const SPARE: usize = 1024;

impl<'p> IntentionPool<'p> {
    /// A place for a new intention.
    pub fn adopt(&mut self) -> u32 {
        if let Some(place) = self.free.pop() {
            let intention = self.at(place);
            (intention.number, intention.state) = (0, IntentionState::Ready);
            return place;
        }
        self.all.push(Intention {
            number: 0,
            state: IntentionState::Ready,
            suspended: false,
            atomic: 0,
            frames: Vec::new(),
            slots: Vec::new(),
            loops: Vec::new(),
            deadlines: Vec::new(),
            parent: None,
            children: SmallVec::new(),
            reply: None,
        });
        self.all.len() as u32 - 1
    }

    /// Gives it the next number, unless it has one; `true` if it had none.
    pub fn count(&mut self, place: u32) -> bool {
        let next = self.adopted + 1;
        let intention = self.at(place);
        let fresh = intention.number == 0;
        if fresh {
            intention.number = next;
            self.adopted = next;
        }
        fresh
    }

    /// Puts a plan on top of an intention.
    #[inline]
    pub fn push(&mut self, place: u32, plan: u16, next: u16, args: &[VariableSlot], vars: &[VariableSlot]) {
        self.plans += 1;
        self.values += args.len() + vars.len();
        self.at(place).push(plan, next, args, vars);
    }

    /// Takes an intention's top plan off.
    #[inline]
    pub fn pop(&mut self, place: u32) -> Option<PlanFrame> {
        let intention = self.at(place);
        let before = intention.slots.len();
        let (frame, answers) = intention.pop()?;
        let gone = before - intention.slots.len() + answers;
        self.plans -= 1;
        self.values -= gone;
        Some(frame)
    }

    /// The intention's top plan begins a loop.
    pub fn enter(&mut self, place: u32, begun: LoopFrame) {
        self.values += begun.answers.len();
        self.at(place).loops.push(begun);
    }

    /// Its innermost loop is over.
    pub fn leave_loop(&mut self, place: u32) {
        let over = self.at(place).loops.pop();
        self.values -= over.map_or(0, |l| l.answers.len());
    }

    pub fn release(&mut self, place: u32) {
        let intention = &self.all[place as usize];
        self.plans -= intention.frames.len();
        self.values -= intention.slots.len() + intention.loops.iter().map(|l| l.answers.len()).sum::<usize>();
        let intention = self.at(place);
        (intention.state, intention.suspended, intention.atomic) = (IntentionState::Free, false, 0);
        intention.frames.clear();
        intention.slots.clear();
        intention.loops.clear();
        intention.deadlines.clear();
        intention.children.clear();
        intention.frames.shrink_to(SPARE);
        intention.slots.shrink_to(SPARE);
        (intention.parent, intention.reply) = (None, None);
        self.free.push(place);
    }

    /// The intention at a place that [`adopt`](Self::adopt) gave.
    pub fn at(&mut self, place: u32) -> &mut Intention<'p> {
        &mut self.all[place as usize]
    }

    /// The same, to be read.
    pub fn see(&self, place: u32) -> &Intention<'p> {
        &self.all[place as usize]
    }

    pub fn get(&self, place: u32) -> Option<&Intention<'p>> {
        self.all.get(place as usize)
    }

    /// Those in use, by place.
    pub fn iter(&self) -> impl Iterator<Item = (u32, &Intention<'p>)> {
        (0u32..).zip(&self.all).filter(|(_, i)| !matches!(i.state, IntentionState::Free))
    }

    /// The places in use, in the order of adoption.
    pub fn in_order(&self) -> Vec<u32> {
        let mut places: Vec<(u32, u32)> = self.iter().map(|(place, i)| (i.number, place)).collect();
        places.sort_unstable();
        places.into_iter().map(|(_, place)| place).collect()
    }

    pub fn is_empty(&self) -> bool {
        self.free.len() == self.all.len()
    }

    pub fn in_use(&self) -> usize {
        self.all.len() - self.free.len()
    }

    pub fn plans(&self) -> usize {
        self.plans
    }

    pub fn values(&self) -> usize {
        self.values
    }

    /// The height of the highest stack.
    pub fn height(&self) -> usize {
        self.all.iter().map(|i| i.frames.len()).max().unwrap_or(0)
    }
}
