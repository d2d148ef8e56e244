//! What a search for maximal runs knows of discrete states, each found once: what may happen there, and which clocks end a run.

use std::{
    cell::{OnceCell, RefCell},
    rc::Rc,
};

use rustc_hash::FxHashMap;

use crate::{
    decide::cells::{CellCuts, ClockCell},
    network::{
        actions::{DelayCondition, EnabledTransition},
        error::ModelError,
        graph::ZoneGraph,
        query::StateFormula,
    },
    search::report::WidestVariable,
    zone::{
        constraint::keep,
        dbm::Dbm,
        extrapolation::{ActiveClocks, ExtrapolationAbstraction},
        federation::Federation,
    },
};

/// A discrete state.
pub(super) struct KnownState {
    pub number: u32,
    pub state: Vec<i64>,
    pub stay: DelayCondition,
    pub cuts: CellCuts,
    /// Of all clocks.
    pub frame: ActiveClocks,
    pub moves: Vec<KnownMove>,
    /// By cell: where a run ends.
    ends: RefCell<FxHashMap<ClockCell, Rc<Federation>>>,
}

/// A transition, and the state that it leads to.
pub(super) struct KnownMove {
    pub action: EnabledTransition,
    /// `None`: invariants over variables forbid it.
    there: OnceCell<Result<Option<u32>, ModelError>>,
}

/// All discrete states that were come to.
pub(super) struct KnownStates<'g, 'm, 'p> {
    graph: &'g ZoneGraph<'m, 'p>,
    /// What cuts zones into cells.
    formulas: Vec<&'g StateFormula>,
    abstraction: ExtrapolationAbstraction,
    all: RefCell<Vec<Rc<KnownState>>>,
    numbers: RefCell<FxHashMap<Vec<i64>, u32>>,
}

impl<'g, 'm, 'p> KnownStates<'g, 'm, 'p> {
    pub(super) fn new(
        graph: &'g ZoneGraph<'m, 'p>,
        formulas: &[&'g StateFormula],
        abstraction: ExtrapolationAbstraction,
    ) -> Self {
        Self {
            graph,
            formulas: formulas.to_vec(),
            abstraction,
            all: RefCell::default(),
            numbers: RefCell::default(),
        }
    }

    /// The int with the most values so far.
    pub(super) fn widest(&self) -> Option<WidestVariable> {
        WidestVariable::among(self.graph.model, self.all.borrow().iter().map(|known| known.state.as_slice()))
    }

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        self.all.borrow().len()
    }

    /// The bytes in use, about.
    pub(super) fn bytes(&self) -> usize {
        let of = |s: &KnownState| {
            size_of::<KnownState>()
                + s.state.len() * 24
                + s.moves.len() * (size_of::<KnownMove>() + s.state.len() * 8 + 128)
        };
        let all = self.all.borrow();
        // They are much alike: the first tells enough.
        all.first().map_or(0, |s| of(s) * all.len())
    }

    /// `None`: invariants over variables forbid the state.
    ///
    /// # Errors
    /// If an invariant, or a bound of a formula, has no value there.
    pub(super) fn find(&self, state: &[i64]) -> Result<Option<Rc<KnownState>>, ModelError> {
        if let Some(&number) = self.numbers.borrow().get(state) {
            return Ok(Some(Rc::clone(&self.all.borrow()[number as usize])));
        }
        let Some(stay) = self.graph.stay(state)? else { return Ok(None) };
        let cuts = CellCuts::of(&self.formulas, &self.graph.here(state))?;
        let actions = self.graph.actions(state).into_iter();
        // INVARIANT: memory keeps the number of states below 2³².
        let number = self.all.borrow().len() as u32;
        let known = Rc::new(KnownState {
            number,
            state: state.to_vec(),
            stay,
            cuts,
            frame: self.graph.frame(state, self.abstraction),
            moves: actions.map(|action| KnownMove { action, there: OnceCell::new() }).collect(),
            ends: RefCell::default(),
        });
        self.all.borrow_mut().push(Rc::clone(&known));
        self.numbers.borrow_mut().insert(state.to_vec(), number);
        Ok(Some(known))
    }

    /// Where a transition leads to from some clocks: the state, and the clocks right after it, before time passes. `None`: it is
    /// not possible.
    ///
    /// # Errors
    /// The fault of the model that the transition is.
    pub(super) fn follow(
        &self,
        known: &KnownMove,
        zone: &Dbm,
    ) -> Result<Option<(Rc<KnownState>, Dbm)>, ModelError> {
        let Some((target, mut zone)) = self.graph.guarded(&known.action, zone)? else { return Ok(None) };
        let there = known.there.get_or_init(|| Ok(self.find(target)?.map(|s| s.number)));
        let Some(number) = there.clone()? else { return Ok(None) };
        let there = Rc::clone(&self.all.borrow()[number as usize]);
        Ok(self.graph.take(&known.action, &there.stay, &mut zone).then_some((there, zone)))
    }

    /// Where a run ends in a cell: no transition is possible now or later, and time cannot pass into another cell.
    pub(super) fn ends(&self, known: &KnownState, cell: &ClockCell) -> Rc<Federation> {
        if let Some(ends) = known.ends.borrow().get(cell) {
            return Rc::clone(ends);
        }
        let ends = Rc::new(self.find_ends(known, cell));
        known.ends.borrow_mut().insert(cell.clone(), Rc::clone(&ends));
        ends
    }

    fn find_ends(&self, known: &KnownState, cell: &ClockCell) -> Federation {
        // The whole cell, so that the bounds are those of the model and not of the abstraction.
        let whole = |cell: &ClockCell| {
            let mut all = Dbm::universe(self.graph.dim());
            let bounds = known.cuts.bounds(cell);
            bounds.iter().chain(&known.stay.invariant).all(|c| keep(&mut all, *c)).then_some(all)
        };
        let Some(all) = whole(cell) else { return Federation::empty() };
        let actions = known.moves.iter().map(|m| &m.action);
        let mut left = self.graph.deadlocked_by(actions, &known.stay, &all);
        if !left.is_empty() && known.stay.waits {
            for there in known.cuts.next(cell, &known.stay.stopped).iter().filter_map(whole) {
                left = left.minus(&self.graph.past(&known.stay, &there));
            }
        }
        left
    }
}
