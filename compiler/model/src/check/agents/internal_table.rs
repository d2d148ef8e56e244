//! The internal actions: one table of what they are called, take and do.

use hrdsl_ir::real::RealFunction;

use crate::{ControlAct, ListFunction};

/// What an argument of an internal action is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArgumentSlot {
    /// A value: its variables have one before.
    In,
    /// A term that is matched with the result, and gives a value to the variables that have none.
    Out,
    /// A formula; what it binds is open again afterwards.
    Formula,
    /// A value for each answer.
    Template,
    /// A goal, without `!`.
    Goal,
    /// A belief that is matched, and binds nothing.
    Belief,
    /// A belief or goal of the agent that a message is for.
    Content,
    /// An agent.
    Agent,
    /// What a message wants.
    Performative,
    /// A time.
    Time,
}

/// An internal action.
#[derive(Clone, Copy, Debug)]
pub struct InternalAction {
    /// Without its dot.
    pub name: &'static str,
    /// How it is written.
    pub usage: &'static str,
    /// What it does, in a sentence.
    pub help: &'static str,
    /// What its arguments are, if all are there. The first of some may come several times.
    pub slots: &'static [ArgumentSlot],
    /// The fewest and the most arguments.
    pub arity: (usize, usize),
    pub(in crate::check) op: InternalOp,
}

impl InternalAction {
    /// It asks, and may be part of a formula; others are steps only.
    #[must_use]
    pub fn asks(&self) -> bool {
        match self.op {
            InternalOp::FindAll
            | InternalOp::SetOf
            | InternalOp::Count
            | InternalOp::Member
            | InternalOp::Apply(_)
            | InternalOp::Holds(_)
            | InternalOp::Intend
            | InternalOp::Desire
            | InternalOp::Suspended
            | InternalOp::Random
            | InternalOp::Shuffle
            | InternalOp::Time
            | InternalOp::MyName
            | InternalOp::AllNames => true,
            InternalOp::Send
            | InternalOp::Broadcast
            | InternalOp::Ask
            | InternalOp::AskAll
            | InternalOp::Print
            | InternalOp::Control(_)
            | InternalOp::Abolish
            | InternalOp::Fail => false,
        }
    }
}

/// What it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::check) enum InternalOp {
    FindAll,
    SetOf,
    Count,
    Member,
    Apply(ListFunction),
    Holds(ListFunction),
    Intend,
    Desire,
    Suspended,
    Random,
    Shuffle,
    Time,
    MyName,
    AllNames,
    Send,
    Broadcast,
    Ask,
    AskAll,
    Print,
    Control(ControlAct),
    Abolish,
    Fail,
}

/// The most arguments of those that take any number.
const MANY: usize = 256;

const fn row(
    (name, usage, help): (&'static str, &'static str, &'static str),
    slots: &'static [ArgumentSlot],
    arity: (usize, usize),
    op: InternalOp,
) -> InternalAction {
    InternalAction { name, usage, help, slots, arity, op }
}

/// A function of numbers.
const fn real(of: RealFunction, usage: &'static str, help: &'static str) -> InternalAction {
    let (slots, arity): (&'static [ArgumentSlot], _) =
        if matches!(of, RealFunction::Power) { (&[In, In, Out], (3, 3)) } else { (&[In, Out], (2, 2)) };
    row((of.name(), usage, help), slots, arity, Apply(F::Real(of)))
}

use ArgumentSlot::{Agent, Belief, Content, Formula, Goal, In, Out, Performative, Template, Time};
use InternalOp::{Apply, Holds};
use ListFunction as F;
use RealFunction as R;

/// All internal actions, those that ask first.
pub const INTERNAL_ACTIONS: &[InternalAction] = &[
    row(
        ("findall", ".findall(T, F, L)", "the list of T's values for all answers of F"),
        &[Template, Formula, Out],
        (3, 3),
        InternalOp::FindAll,
    ),
    row(
        ("setof", ".setof(T, F, L)", "the sorted list of T's different values for all answers of F"),
        &[Template, Formula, Out],
        (3, 3),
        InternalOp::SetOf,
    ),
    row(("count", ".count(F, N)", "the number of answers of F"), &[Formula, Out], (2, 2), InternalOp::Count),
    row(
        ("member", ".member(X, L)", "an answer for each element of the list that X matches"),
        &[Out, In],
        (2, 2),
        InternalOp::Member,
    ),
    row(("length", ".length(L, N)", "how long a list or string is"), &[In, Out], (2, 2), Apply(F::Length)),
    row(
        (
            "concat",
            ".concat(A, B, C)",
            "lists joined, or values joined to a string if one of them is a string",
        ),
        &[In, In, Out],
        (3, MANY),
        Apply(F::Concat),
    ),
    row(
        ("nth", ".nth(I, L, X)", "the element with the number I, from 0; fails beyond the end"),
        &[In, In, Out],
        (3, 3),
        Apply(F::Nth),
    ),
    row(
        ("reverse", ".reverse(L, M)", "a list or string from its end"),
        &[In, Out],
        (2, 2),
        Apply(F::Reverse),
    ),
    row(("sort", ".sort(L, M)", "the list in order"), &[In, Out], (2, 2), Apply(F::Sort)),
    row(("min", ".min(L, X)", "the least element; fails for `[]`"), &[In, Out], (2, 2), Apply(F::Min)),
    row(("max", ".max(L, X)", "the greatest element; fails for `[]`"), &[In, Out], (2, 2), Apply(F::Max)),
    row(
        ("delete", ".delete(X, L, M)", "the list without all elements equal to X"),
        &[In, In, Out],
        (3, 3),
        Apply(F::Delete),
    ),
    row(
        ("union", ".union(A, B, C)", "the elements of both lists, each once"),
        &[In, In, Out],
        (3, 3),
        Apply(F::Union),
    ),
    row(
        ("intersection", ".intersection(A, B, C)", "the elements of A that are in B"),
        &[In, In, Out],
        (3, 3),
        Apply(F::Intersection),
    ),
    row(
        ("difference", ".difference(A, B, C)", "the elements of A that are not in B"),
        &[In, In, Out],
        (3, 3),
        Apply(F::Difference),
    ),
    row(("string", ".string(X, S)", "the value as a string"), &[In, Out], (2, 2), Apply(F::ToText)),
    row(("empty", ".empty(L)", "whether a list or string is empty"), &[In], (1, 1), Holds(F::Empty)),
    row(("prefix", ".prefix(A, B)", "whether B begins with A"), &[In, In], (2, 2), Holds(F::Prefix)),
    row(("suffix", ".suffix(A, B)", "whether B ends with A"), &[In, In], (2, 2), Holds(F::Suffix)),
    row(
        ("sublist", ".sublist(A, B)", "whether A is in B in one piece"),
        &[In, In],
        (2, 2),
        Holds(F::Sublist),
    ),
    row(
        ("occurrences", ".occurrences(A, B, L)", "the list of the places, from 0, at which B contains A"),
        &[In, In, Out],
        (3, 3),
        Apply(F::Occurrences),
    ),
    row(
        ("slice", ".slice(L, I, J, M)", "the part of a list or string from place I to before J, from 0"),
        &[In, In, In, Out],
        (4, 4),
        Apply(F::Slice),
    ),
    real(R::Power, ".power(X, Y, Z)", "X to the power of Y"),
    real(R::Sqrt, ".sqrt(X, Y)", "the square root"),
    real(R::Floor, ".floor(X, N)", "the greatest whole number that is not above X"),
    real(R::Ceil, ".ceil(X, N)", "the least whole number that is not below X"),
    real(R::Round, ".round(X, N)", "the nearest whole number, of two the greater"),
    real(R::Log, ".log(X, Y)", "the natural logarithm"),
    real(R::Sin, ".sin(X, Y)", "the sine of an angle in radians"),
    real(R::Cos, ".cos(X, Y)", "the cosine of an angle in radians"),
    real(R::Tan, ".tan(X, Y)", "the tangent of an angle in radians"),
    real(R::Asin, ".asin(X, Y)", "the angle of this sine, in radians"),
    real(R::Acos, ".acos(X, Y)", "the angle of this cosine, in radians"),
    real(R::Atan, ".atan(X, Y)", "the angle of this tangent, in radians"),
    real(R::Sum, ".sum(L, X)", "the sum of a list of numbers"),
    real(R::Mean, ".mean(L, X)", "their mean; fails for `[]`"),
    real(
        R::Median,
        ".median(L, X)",
        "the middle one in order, or the mean of the middle two; fails for `[]`",
    ),
    real(R::StdDev, ".std_dev(L, X)", "their standard deviation, as of a sample; fails for less than two"),
    row(
        ("intend", ".intend(g(…))", "whether an intention has the goal"),
        &[Goal],
        (1, 1),
        InternalOp::Intend,
    ),
    row(
        ("desire", ".desire(g(…))", "whether an intention, or an event not yet handled, has the goal"),
        &[Goal],
        (1, 1),
        InternalOp::Desire,
    ),
    row(
        ("suspended", ".suspended(g(…))", "whether the goal is suspended"),
        &[Goal],
        (1, 1),
        InternalOp::Suspended,
    ),
    row(
        (
            "random",
            ".random(X)` or `.random(L, X)",
            "a number from 0 up to 1, or an element of the list, from the run's seed",
        ),
        &[In, Out],
        (1, 2),
        InternalOp::Random,
    ),
    row(
        ("shuffle", ".shuffle(L, M)", "the list in an order drawn from the run's seed"),
        &[In, Out],
        (2, 2),
        InternalOp::Shuffle,
    ),
    row(("time", ".time(T)", "the time since the start of the run"), &[Out], (1, 1), InternalOp::Time),
    row(("my_name", ".my_name(A)", "the agent itself"), &[Out], (1, 1), InternalOp::MyName),
    row(("all_names", ".all_names(L)", "the agents of this run"), &[Out], (1, 1), InternalOp::AllNames),
    row(
        ("send", ".send(A, tell, b(…))", "sends a message to an agent"),
        &[Agent, Performative, Content],
        (3, 3),
        InternalOp::Send,
    ),
    row(
        ("broadcast", ".broadcast(tell, b(…))", "sends a message to all other agents"),
        &[Performative, Content],
        (2, 2),
        InternalOp::Broadcast,
    ),
    row(
        (
            "ask",
            ".ask(A, b(X), 5 s)",
            "waits for an agent's first answer, which binds; the time may be left out",
        ),
        &[Agent, Content, Time],
        (2, 3),
        InternalOp::Ask,
    ),
    row(
        (
            "ask_all",
            ".ask_all(A, T, b(X), L, 5 s)",
            "waits for the list of T's values for all answers of an agent; the time may be left out",
        ),
        &[Agent, Template, Content, Out, Time],
        (4, 5),
        InternalOp::AskAll,
    ),
    row(("print", ".print(…)", "writes values into the log"), &[In], (0, MANY), InternalOp::Print),
    row(
        ("drop_intention", ".drop_intention(g(…))", "ends the intentions that have the goal"),
        &[Goal],
        (1, 1),
        InternalOp::Control(ControlAct::DropIntention),
    ),
    row(
        ("drop_desire", ".drop_desire(g(…))", "ends the intentions and the events that have the goal"),
        &[Goal],
        (1, 1),
        InternalOp::Control(ControlAct::DropDesire),
    ),
    row(
        ("drop_event", ".drop_event(g(…))", "ends the events that have the goal"),
        &[Goal],
        (1, 1),
        InternalOp::Control(ControlAct::DropEvent),
    ),
    row(
        ("drop_all_intentions", ".drop_all_intentions", "ends all intentions"),
        &[],
        (0, 0),
        InternalOp::Control(ControlAct::DropIntention),
    ),
    row(
        ("drop_all_desires", ".drop_all_desires", "ends all intentions and events"),
        &[],
        (0, 0),
        InternalOp::Control(ControlAct::DropDesire),
    ),
    row(
        ("drop_all_events", ".drop_all_events", "ends all events"),
        &[],
        (0, 0),
        InternalOp::Control(ControlAct::DropEvent),
    ),
    row(
        ("succeed_goal", ".succeed_goal(g(…))", "ends the goal as if it were achieved"),
        &[Goal],
        (1, 1),
        InternalOp::Control(ControlAct::SucceedGoal),
    ),
    row(
        ("fail_goal", ".fail_goal(g(…))", "ends the goal as if its plan had failed"),
        &[Goal],
        (1, 1),
        InternalOp::Control(ControlAct::FailGoal),
    ),
    row(
        (
            "suspend",
            ".suspend(g(…))` or `.suspend",
            "stops the intentions with the goal, or this one, until `.resume`",
        ),
        &[Goal],
        (0, 1),
        InternalOp::Control(ControlAct::Suspend),
    ),
    row(
        ("resume", ".resume(g(…))", "lets the suspended intentions with the goal go on"),
        &[Goal],
        (1, 1),
        InternalOp::Control(ControlAct::Resume),
    ),
    row(
        ("abolish", ".abolish(b(…))", "removes every belief that matches, whatever its sources"),
        &[Belief],
        (1, 1),
        InternalOp::Abolish,
    ),
    row(("fail", ".fail", "fails"), &[], (0, 0), InternalOp::Fail),
];
