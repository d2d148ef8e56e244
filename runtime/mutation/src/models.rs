//! Mutants of the models that play the system: which of them the runs of the code contradict.

use std::collections::BTreeSet;

use hrdsl_campaign::ListedMutant;
use hrdsl_conformance::{ModelPart, system_models};
use hrdsl_ir::{
    Nanos, Program, Span, Value,
    expr::{Expr, UnaryOp},
    ta::{Automaton, AutomatonId, ClockConstraint, ClockOp},
    value::seconds,
};

/// The kinds of changes of a model, in order.
pub const MODEL_OPERATORS: [&str; 5] = ["bound", "check", "condition", "dropped", "time"];

/// One small change of an automaton that plays the system.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModelMutant {
    pub mutant: ListedMutant,
    edit: ModelEdit,
}

/// Where an automaton changes, and how.
#[derive(Clone, Debug, PartialEq, Eq)]
enum ModelEdit {
    /// A constraint of a location's invariant, by the places of the location and in it.
    Invariant(AutomatonId, usize, usize, ConstraintChange),
    /// A constraint of an edge's guard.
    Guard(AutomatonId, usize, usize, ConstraintChange),
    /// The condition of an edge on variables is negated.
    Condition(AutomatonId, usize),
    /// An edge is never taken.
    Dropped(AutomatonId, usize),
    /// No edge of any model is ever taken.
    Nothing,
}

/// What becomes of a constraint on a clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ConstraintChange {
    Halved,
    Doubled,
    /// An upper bound becomes a lower one, and the other way round.
    Opposite,
    LeftOut,
}

impl ConstraintChange {
    const OF_GUARDS: [Self; 4] = [Self::Halved, Self::Doubled, Self::Opposite, Self::LeftOut];
    /// Invariants have upper bounds only.
    const OF_INVARIANTS: [Self; 3] = [Self::Halved, Self::Doubled, Self::LeftOut];

    fn operator(self) -> &'static str {
        match self {
            ConstraintChange::Halved | ConstraintChange::Doubled => "time",
            ConstraintChange::Opposite => "bound",
            ConstraintChange::LeftOut => "check",
        }
    }

    fn what(self, bound: Nanos) -> String {
        let bound = seconds(bound);
        match self {
            ConstraintChange::Halved => format!("the bound of {bound} s is halved"),
            ConstraintChange::Doubled => format!("the bound of {bound} s is doubled"),
            ConstraintChange::Opposite => format!("the bound of {bound} s is turned round"),
            ConstraintChange::LeftOut => format!("the bound of {bound} s is left out"),
        }
    }

    fn apply(self, constraints: &mut Vec<ClockConstraint>, at: usize) {
        let Some(constraint) = constraints.get_mut(at) else { return };
        match self {
            ConstraintChange::Halved => constraint.bound.nanos /= 2,
            ConstraintChange::Doubled => constraint.bound.nanos *= 2,
            ConstraintChange::Opposite => {
                constraint.op = match constraint.op {
                    ClockOp::Lt => ClockOp::Gt,
                    ClockOp::Le | ClockOp::Eq => ClockOp::Ge,
                    ClockOp::Ge => ClockOp::Le,
                    ClockOp::Gt => ClockOp::Lt,
                }
            }
            ConstraintChange::LeftOut => drop(constraints.remove(at)),
        }
    }
}

impl ModelMutant {
    /// All mutants of the automata that play the system, in the order of the automata, and in each of its locations and edges. `place` is the
    /// file and the line of a place in the scenario.
    #[must_use]
    pub fn all(program: &Program, place: &dyn Fn(Span) -> (String, u32)) -> Vec<Self> {
        let mut found = Vec::new();
        for id in players(program) {
            edits_of(program, id, &mut |edit, operator, what, origin| {
                let (file, line) = place(origin);
                let number = u32::try_from(found.len()).unwrap_or(u32::MAX).saturating_add(1);
                let operator = operator.to_owned();
                let listed = ListedMutant::sentinel(&file);
                let mutant = ListedMutant { number, line, lines: vec![line], operator, what, ..listed };
                found.push(Self { mutant, edit });
            });
        }
        for mutant in &mut found {
            if mutant.applied(program).automata == program.automata {
                mutant.mutant.needless = "equivalent".to_owned();
            }
        }
        found
    }

    /// A model that can do nothing: runs of the code that do not contradict it measure nothing.
    #[must_use]
    pub fn sentinel(file: &str) -> Self {
        let what = "no edge of the model is ever taken".to_owned();
        Self { mutant: ListedMutant { what, ..ListedMutant::sentinel(file) }, edit: ModelEdit::Nothing }
    }

    /// What it changes of an automaton; `None` of one that changes all.
    pub(crate) fn part(&self) -> Option<ModelPart> {
        match &self.edit {
            ModelEdit::Invariant(id, location, _, _) => Some(ModelPart::Location(*id, *location)),
            ModelEdit::Guard(id, edge, _, _)
            | ModelEdit::Condition(id, edge)
            | ModelEdit::Dropped(id, edge) => Some(ModelPart::Edge(*id, *edge)),
            ModelEdit::Nothing => None,
        }
    }

    /// The program with the mutant.
    #[must_use]
    pub(crate) fn applied(&self, program: &Program) -> Program {
        let mut changed = program.clone();
        match &self.edit {
            ModelEdit::Invariant(id, location, at, how) => {
                let automaton = changed.automata.get_mut(usize::from(id.0));
                if let Some(location) = automaton.and_then(|a| a.locations.get_mut(*location)) {
                    how.apply(&mut location.invariant, *at);
                }
            }
            ModelEdit::Guard(id, edge, at, how) => {
                let automaton = changed.automata.get_mut(usize::from(id.0));
                if let Some(edge) = automaton.and_then(|a| a.edges.get_mut(*edge)) {
                    how.apply(&mut edge.clock_guard, *at);
                }
            }
            ModelEdit::Condition(id, edge) => {
                let automaton = changed.automata.get_mut(usize::from(id.0));
                if let Some(edge) = automaton.and_then(|a| a.edges.get_mut(*edge)) {
                    let negated = |guard| Expr::Unary(UnaryOp::Not, Box::new(guard));
                    edge.guard = edge.guard.take().map(negated);
                }
            }
            ModelEdit::Dropped(id, edge) => drop_edges(&mut changed, *id, Some(*edge)),
            ModelEdit::Nothing => {
                for id in players(program) {
                    drop_edges(&mut changed, id, None);
                }
            }
        }
        changed
    }
}

/// The automata that play the system, and those that help them.
fn players(program: &Program) -> BTreeSet<AutomatonId> {
    system_models(program).into_iter().flat_map(|model| model.network.automata).collect()
}

/// Lets one edge never be taken, or all.
fn drop_edges(program: &mut Program, id: AutomatonId, only: Option<usize>) {
    let Some(automaton) = program.automata.get_mut(usize::from(id.0)) else { return };
    for (at, edge) in automaton.edges.iter_mut().enumerate() {
        if only.is_none_or(|only| only == at) {
            edge.guard = Some(Expr::Const(Value::Bool(false)));
        }
    }
}

fn edits_of(
    program: &Program,
    id: AutomatonId,
    found: &mut dyn FnMut(ModelEdit, &'static str, String, Span),
) {
    let automaton = program.automaton(id);
    for (at, location) in automaton.locations.iter().enumerate() {
        for (place, constraint) in location.invariant.iter().enumerate() {
            for how in ConstraintChange::OF_INVARIANTS {
                let what = how.what(constraint.bound.nanos);
                let what = format!("{}.{}: {what}", automaton.name, location.name);
                found(ModelEdit::Invariant(id, at, place, how), how.operator(), what, location.origin);
            }
        }
    }
    for (at, edge) in automaton.edges.iter().enumerate() {
        let name = edge_name(automaton, at);
        for (place, constraint) in edge.clock_guard.iter().enumerate() {
            for how in ConstraintChange::OF_GUARDS {
                let what = format!("{name}: {}", how.what(constraint.bound.nanos));
                found(ModelEdit::Guard(id, at, place, how), how.operator(), what, edge.origin);
            }
        }
        if edge.guard.is_some() {
            let what = format!("{name}: the condition is negated");
            found(ModelEdit::Condition(id, at), "condition", what, edge.origin);
        }
        let what = format!("{name}: the edge is never taken");
        found(ModelEdit::Dropped(id, at), "dropped", what, edge.origin);
    }
}

fn edge_name(automaton: &Automaton, at: usize) -> String {
    let Some(edge) = automaton.edges.get(at) else { return automaton.name.clone() };
    let (from, to) = (automaton.location(edge.from), automaton.location(edge.to));
    format!("{}: {} -> {}", automaton.name, from.name, to.name)
}
