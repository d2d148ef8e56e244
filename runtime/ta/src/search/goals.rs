//! Goals, compiled so that a search looks at few of them: edges by number, locations by place, the rest where it is new.

use hrdsl_ir::ta::QueryFormula;

use crate::{
    network::{
        code::{CodeEvalContext, CodeEvalError, CompiledExpr, VariableScope},
        error::ModelError,
        model::CompiledNetwork,
        number::{NumberComparison, NumberType},
        parts::{ParametricConstraint, TimeExpr},
        query::{GoalKind, ReachabilityGoal, StateFormula},
    },
    search::state_test::{StateTest, place_bit},
    zone::{
        constraint::{DifferenceConstraint, constraints},
        dbm::{Dbm, DbmNumber},
        extrapolation::ActiveClocks,
    },
};

/// A formula that looks at clocks.
pub(crate) enum SymbolicFormula {
    Data(CompiledExpr),
    Clock(ParametricConstraint),
    Not(Box<SymbolicFormula>),
    And(Vec<SymbolicFormula>),
    Or(Vec<SymbolicFormula>),
}

/// All goals of a search.
#[derive(Default)]
pub(crate) struct CompiledGoals {
    /// By edge number: goals that it meets.
    pub edges: Vec<Vec<usize>>,
    /// By the second edge's number: the first, goal.
    pub pairs: Vec<Vec<(i64, usize)>>,
    /// By the user's number: the place of the definition, its edge, goal.
    pub uses: Vec<Vec<(usize, i64, usize)>>,
    /// By member and location: goal, settled.
    pub locations: Vec<Vec<Vec<(usize, bool)>>>,
    pub tests: Vec<StateTest>,
    /// By member and location: the tests that hold there at most; last, those that may hold anywhere.
    tests_at: Vec<Vec<Vec<u32>>>,
    tests_anywhere: Vec<u32>,
    pub symbolic: Vec<(usize, bool, SymbolicFormula)>,
    any_locations: bool,
    /// The members that have tests at some location.
    tested: Vec<usize>,
    /// No goal is about edges.
    no_edges: bool,
}

impl CompiledGoals {
    pub(crate) fn new(model: &CompiledNetwork, goals: &[ReachabilityGoal]) -> Result<Self, ModelError> {
        let edges = model.members.iter().map(|m| m.edges.len()).sum::<usize>() + 1;
        let mut all = Self {
            edges: vec![Vec::new(); edges],
            pairs: vec![Vec::new(); edges],
            uses: vec![Vec::new(); edges],
            locations: model.members.iter().map(|m| vec![Vec::new(); m.locations.len()]).collect(),
            ..Self::default()
        };
        for (i, goal) in goals.iter().enumerate() {
            model.check_goal(goal)?;
            all.add(model, i, goal)?;
        }
        all.tests_at = model.members.iter().map(|m| vec![Vec::new(); m.locations.len()]).collect();
        for (number, test) in (0u32..).zip(&all.tests) {
            match test.location(model.members.len()) {
                // A location that is not there: the test never holds.
                Some((member, at)) => {
                    all.tests_at[member].get_mut(at).into_iter().for_each(|t| t.push(number))
                }
                None => all.tests_anywhere.push(number),
            }
        }
        all.tested =
            (0..all.tests_at.len()).filter(|&m| all.tests_at[m].iter().any(|t| !t.is_empty())).collect();
        all.no_edges = all.edges.iter().all(Vec::is_empty)
            && all.pairs.iter().all(Vec::is_empty)
            && all.uses.iter().all(Vec::is_empty);
        Ok(all)
    }

    fn add(&mut self, model: &CompiledNetwork, i: usize, goal: &ReachabilityGoal) -> Result<(), ModelError> {
        let number = |m: usize, e: usize| model.members[m].edges[e].number;
        match &goal.what {
            GoalKind::Edge { automaton, edge } => self.edges[number(*automaton, *edge) as usize].push(i),
            GoalKind::Pair { automaton, first, second } => {
                let first = i64::from(number(*automaton, *first));
                self.pairs[number(*automaton, *second) as usize].push((first, i));
            }
            GoalKind::Use { slot, definition, user } => {
                let definition = definition.map_or(0, |(m, e)| i64::from(number(m, e)));
                let at = model.last_definition_at(*slot);
                self.uses[number(user.0, user.1) as usize].push((at, definition, i));
            }
            GoalKind::Location { automaton, location } => {
                self.any_locations = true;
                self.locations[*automaton][usize::from(location.0)].push((i, goal.settled));
            }
            GoalKind::Condition(f) => {
                let code = state_formula(model, &model.slot_scope(), f);
                self.tests.push(StateTest::new(model, i, goal.settled, code));
            }
            GoalKind::Formula(f) => {
                let formula = symbolic(model, &model.slot_scope(), f)?;
                if let SymbolicFormula::Data(code) = formula {
                    self.tests.push(StateTest::new(model, i, goal.settled, code));
                } else {
                    self.symbolic.push((i, goal.settled, formula));
                }
            }
        }
        Ok(())
    }

    /// The goals that taking these edges meets.
    pub(crate) fn taken(&self, number: u32, before: &[i64], last: Option<usize>, met: &mut dyn FnMut(usize)) {
        if self.no_edges {
            return;
        }
        let n = number as usize;
        self.edges[n].iter().for_each(|g| met(*g));
        if let Some(last) = last {
            self.pairs[n].iter().filter(|p| p.0 == before[last]).for_each(|p| met(p.1));
        }
        self.uses[n].iter().filter(|u| before[u.0] == u.1).for_each(|u| met(u.2));
    }

    /// The goals that a discrete state meets, of those still open. `before` is a state in which all that this one is asked was asked:
    /// only goals over what has changed since can be met now.
    #[allow(
        clippy::too_many_arguments,
        reason = "what a worker has at hand, taken apart for the borrow checker"
    )]
    pub(crate) fn states(
        &self,
        state: &mut [i64],
        before: Option<&[i64]>,
        stack: &mut Vec<i64>,
        model: &CompiledNetwork,
        settled: bool,
        open: &[bool],
        met: &mut Vec<usize>,
    ) -> Result<(), ModelError> {
        if self.any_locations {
            for (rows, &at) in self.locations.iter().zip(&*state) {
                let here = rows[at as usize].iter().filter(|g| open[g.0] && (settled || !g.1));
                met.extend(here.map(|g| g.0));
            }
        }
        if self.tests.is_empty() {
            return Ok(());
        }
        let changed = before.map_or(u64::MAX, |before| {
            let differs = before.iter().zip(&*state).enumerate().filter(|(_, (a, b))| a != b);
            differs.fold(0, |bits, (place, _)| bits | place_bit(place))
        });
        for &member in &self.tested {
            let at = state[member] as usize;
            self.some_tests(&self.tests_at[member][at], changed, (state, stack), model, settled, open, met)?;
        }
        self.some_tests(&self.tests_anywhere, changed, (state, stack), model, settled, open, met)
    }

    #[allow(clippy::too_many_arguments, reason = "as `states`")]
    fn some_tests(
        &self,
        which: &[u32],
        changed: u64,
        (state, stack): (&mut [i64], &mut Vec<i64>),
        model: &CompiledNetwork,
        settled: bool,
        open: &[bool],
        met: &mut Vec<usize>,
    ) -> Result<(), ModelError> {
        for &number in which {
            let test = &self.tests[number as usize];
            // A test that reads nothing is one of the first state.
            let asked = changed == u64::MAX || test.reads & changed != 0;
            let looks = asked && open[test.goal] && (settled || !test.settled);
            if looks && test.holds(state, stack, model).map_err(no_value)? {
                met.push(test.goal);
            }
        }
        Ok(())
    }

    /// The goals over clocks that a symbolic state meets, of those still open.
    pub(crate) fn zones<N: DbmNumber>(
        &self,
        look: &mut SymbolicStateRef<'_, '_, N>,
        settled: bool,
        open: &[bool],
        met: &mut Vec<usize>,
    ) -> Result<(), ModelError> {
        for (goal, wants_settled, formula) in &self.symbolic {
            if !open[*goal] || (*wants_settled && !settled) {
                continue;
            }
            if look.meets(formula).map_err(no_value)? {
                met.push(*goal);
            }
        }
        Ok(())
    }

    /// Calls `f` with each place of the state that the goals look at.
    pub(crate) fn each_place(&self, model: &CompiledNetwork, f: &mut dyn FnMut(u32)) {
        self.tests.iter().for_each(|t| t.code.each_var(&model.library, f));
        self.symbolic.iter().for_each(|s| s.2.each_place(model, f));
    }
}

fn no_value(fault: CodeEvalError) -> ModelError {
    let error = match fault {
        CodeEvalError::Eval(e) => e,
        CodeEvalError::Range { value, .. } => hrdsl_ir::expr::EvalError::Range(value),
        CodeEvalError::Argument { .. } | CodeEvalError::Negative { .. } => hrdsl_ir::expr::EvalError::Type,
    };
    ModelError::Question(format!("a goal has no value: {error}"))
}

fn state_formula(model: &CompiledNetwork, names: &VariableScope, f: &StateFormula) -> CompiledExpr {
    let all =
        |fs: &[StateFormula], empty: i64, join: fn(Box<(CompiledExpr, CompiledExpr)>) -> CompiledExpr| {
            let codes = fs.iter().map(|f| state_formula(model, names, f));
            codes.reduce(|a, b| join(Box::new((a, b)))).unwrap_or(CompiledExpr::Const(empty))
        };
    match f {
        StateFormula::And(fs) => all(fs, 1, CompiledExpr::And),
        StateFormula::Or(fs) => all(fs, 0, CompiledExpr::Or),
        StateFormula::Not(f) => CompiledExpr::Not(Box::new(state_formula(model, names, f))),
        StateFormula::At { automaton, location } => {
            CompiledExpr::VarConst(NumberComparison::Eq, *automaton as u32, i64::from(location.0))
        }
        StateFormula::Data(e) => model.library.compile(names, e, NumberType::Bool),
        // INVARIANT: `check_goal` lets through none of these.
        StateFormula::Clock(_) | StateFormula::Deadlock => CompiledExpr::Const(0),
        StateFormula::CounterIn { counter, lo, hi } => {
            let at = model.counter_at(*counter) as u32;
            let low = CompiledExpr::VarConst(NumberComparison::Ge, at, *lo);
            match hi {
                None => low,
                Some(hi) => {
                    CompiledExpr::And(Box::new((low, CompiledExpr::VarConst(NumberComparison::Le, at, *hi))))
                }
            }
        }
    }
}

/// Compiles a formula; what has no clocks becomes one piece of code.
fn symbolic(
    model: &CompiledNetwork,
    names: &VariableScope,
    f: &QueryFormula,
) -> Result<SymbolicFormula, ModelError> {
    let many = |fs: &[QueryFormula], empty: i64, and: bool| -> Result<SymbolicFormula, ModelError> {
        let parts: Vec<SymbolicFormula> =
            fs.iter().map(|f| symbolic(model, names, f)).collect::<Result<_, _>>()?;
        let (data, mut rest): (Vec<_>, Vec<_>) =
            parts.into_iter().partition(|p| matches!(p, SymbolicFormula::Data(_)));
        let codes =
            data.into_iter().filter_map(|d| if let SymbolicFormula::Data(c) = d { Some(c) } else { None });
        let join: fn(Box<(CompiledExpr, CompiledExpr)>) -> CompiledExpr =
            if and { CompiledExpr::And } else { CompiledExpr::Or };
        let code = codes.reduce(|a, b| join(Box::new((a, b)))).unwrap_or(CompiledExpr::Const(empty));
        if rest.is_empty() {
            return Ok(SymbolicFormula::Data(code));
        }
        rest.insert(0, SymbolicFormula::Data(code));
        Ok(if and { SymbolicFormula::And(rest) } else { SymbolicFormula::Or(rest) })
    };
    Ok(match f {
        QueryFormula::At { automaton, location } => {
            let known = model.members.get(usize::from(*automaton));
            if known.is_none_or(|m| usize::from(location.0) >= m.locations.len()) {
                return Err(ModelError::Question("a formula speaks of a location that is not there".into()));
            }
            SymbolicFormula::Data(CompiledExpr::VarConst(
                NumberComparison::Eq,
                u32::from(*automaton),
                i64::from(location.0),
            ))
        }
        QueryFormula::Data(e) => SymbolicFormula::Data(model.library.compile(names, e, NumberType::Bool)),
        QueryFormula::Clock(c) => {
            let clock = |c: hrdsl_ir::ta::ClockId| c.0 + 1;
            let (i, j) = (clock(c.clock), c.minus.map_or(0, clock));
            if usize::from(i.max(j)) >= model.dim {
                return Err(ModelError::Question("a formula speaks of a clock that is not there".into()));
            }
            let terms = c.bound.terms.iter();
            let term = |t: &hrdsl_ir::ta::TimeTerm| {
                (t.factor / model.unit, model.library.compile(names, &t.value, NumberType::Int))
            };
            let time = TimeExpr { units: c.bound.nanos / model.unit, terms: terms.map(term).collect() };
            SymbolicFormula::Clock(ParametricConstraint { i, j, op: c.op, time, span: (0, 0) })
        }
        QueryFormula::Deadlock => {
            return Err(ModelError::Question("`deadlock` is no goal of a search by zones alone".into()));
        }
        QueryFormula::Not(f) => {
            let formula = symbolic(model, names, f)?;
            if let SymbolicFormula::Data(code) = formula {
                SymbolicFormula::Data(CompiledExpr::Not(Box::new(code)))
            } else {
                SymbolicFormula::Not(Box::new(formula))
            }
        }
        QueryFormula::And(fs) => many(fs, 1, true)?,
        QueryFormula::Or(fs) => many(fs, 0, false)?,
    })
}

impl SymbolicFormula {
    fn each_place(&self, model: &CompiledNetwork, f: &mut dyn FnMut(u32)) {
        match self {
            SymbolicFormula::Data(code) => code.each_var(&model.library, f),
            SymbolicFormula::Clock(c) => c.time.terms.iter().for_each(|t| t.1.each_var(&model.library, f)),
            SymbolicFormula::Not(a) => a.each_place(model, f),
            SymbolicFormula::And(all) | SymbolicFormula::Or(all) => {
                all.iter().for_each(|a| a.each_place(model, f))
            }
        }
    }
}

/// A symbolic state to look at.
pub(crate) struct SymbolicStateRef<'a, 'p, N> {
    pub model: &'a CompiledNetwork<'p>,
    pub state: &'a mut [i64],
    pub stack: &'a mut Vec<i64>,
    pub frame: &'a ActiveClocks,
    pub zone: &'a Dbm<N>,
    /// The last clock is the time since the start: how early the formula holds is asked, too.
    pub timed: bool,
    /// The lower bound of that time, of what has met a formula.
    pub earliest: Option<N>,
}

impl<N: DbmNumber> SymbolicStateRef<'_, '_, N> {
    /// Whether the formula holds for some valuation of the zone.
    pub(crate) fn meets(&mut self, formula: &SymbolicFormula) -> Result<bool, CodeEvalError> {
        let zone = self.zone.clone();
        Ok(self.some(&mut vec![(formula, true)], zone)? || self.earliest.is_some())
    }

    /// Whether all of these hold (or do not, as the flag says) for some valuation. With times it goes through all ways, and never says so.
    fn some(&mut self, all: &mut Vec<(&SymbolicFormula, bool)>, zone: Dbm<N>) -> Result<bool, CodeEvalError> {
        let Some((formula, yes)) = all.pop() else { return Ok(self.found(&zone)) };
        let found = match (formula, yes) {
            (SymbolicFormula::Data(code), _) => {
                let n = code.eval(&mut CodeEvalContext::new(&self.model.library, self.state, self.stack))?;
                (n != 0) == yes && self.some(all, zone)?
            }
            (SymbolicFormula::Clock(c), _) => self.clock(c, yes, all, zone)?,
            (SymbolicFormula::Not(a), _) => {
                all.push((a, !yes));
                self.some(all, zone)?
            }
            (SymbolicFormula::And(parts), true) | (SymbolicFormula::Or(parts), false) => {
                let before = all.clone();
                // The part without clocks stands first, and is asked first: most states do not meet it.
                all.extend(parts.iter().rev().map(|p| (p, yes)));
                let found = self.some(all, zone)?;
                *all = before;
                found
            }
            (SymbolicFormula::And(parts), false) | (SymbolicFormula::Or(parts), true) => {
                let mut found = false;
                for p in parts {
                    let mut with = all.clone();
                    with.push((p, yes));
                    if self.some(&mut with, zone.clone())? {
                        found = true;
                        break;
                    }
                }
                found
            }
        };
        Ok(found)
    }

    fn found(&mut self, zone: &Dbm<N>) -> bool {
        if zone.is_empty() || !self.timed {
            return !zone.is_empty();
        }
        let least = zone.entry(0, zone.dim() - 1);
        self.earliest = Some(self.earliest.map_or(least, |e| e.max(least)));
        false
    }

    fn clock(
        &mut self,
        c: &ParametricConstraint,
        yes: bool,
        all: &mut Vec<(&SymbolicFormula, bool)>,
        zone: Dbm<N>,
    ) -> Result<bool, CodeEvalError> {
        let n = c.time.eval(&mut CodeEvalContext::new(&self.model.library, self.state, self.stack))?;
        let mut parts: Vec<DifferenceConstraint> = Vec::new();
        constraints(c.i, c.j, c.op, n, &mut |c| parts.push(c));
        let keep = |zone: &mut Dbm<N>, frame: &ActiveClocks, c: DifferenceConstraint| {
            let (i, j) = (frame.index(c.i), frame.index(c.j));
            i.zip(j).is_none_or(|(i, j)| zone.constrain(i, j, c.bound))
        };
        if yes {
            let mut zone = zone;
            return Ok(parts.iter().all(|&c| keep(&mut zone, self.frame, c)) && self.some(all, zone)?);
        }
        for c in parts {
            let mut part = zone.clone();
            if keep(&mut part, self.frame, c.negated()) && self.some(&mut all.clone(), part)? {
                return Ok(true);
            }
        }
        Ok(false)
    }
}
