//! Queries, and what suites by search reach: variables get the slots that they have in their network.

use hrdsl_ir::{
    Expr,
    expr::BinaryOp,
    lowering,
    suite::Suite,
    ta::{Automaton, NetworkId, Query, location_variable},
};
use hrdsl_model::{self as model, Scenario, TypedMethod, VariableRef};
use hrdsl_source::{SourceFiles, Span};

use super::{
    expr::{self, LeafSource},
    monitor::one_line,
};

/// `automata` are the scenario's, lowered: they may have more variables than were written.
pub(crate) fn query(
    q: &model::TypedQuery,
    scenario: &Scenario,
    automata: &[Automaton],
    files: &SourceFiles,
) -> Query {
    let slots = QueryVariableSlots::of(q.network, scenario, automata);
    Query {
        name: q.name.clone(),
        title: q.title.clone(),
        text: one_line(files.text(q.text)),
        network: q.network,
        ask: q.ask.lower(&slots),
        origin: q.origin,
    }
}

/// A suite; what one by search reaches speaks of its network as queries do.
pub(crate) fn suite(
    s: &model::TypedSuite,
    scenario: &Scenario,
    automata: &[Automaton],
    files: &SourceFiles,
) -> Suite {
    let slots = match &s.method {
        TypedMethod::Search { network, .. } => QueryVariableSlots::of(*network, scenario, automata),
        TypedMethod::Agents { .. } | TypedMethod::Random { .. } => QueryVariableSlots::default(),
    };
    let text = |span: &Span| one_line(files.text(*span));
    s.lower(&expr::local, &|goal| goal.lower(&slots, &text))
}

fn slot(n: usize) -> u16 {
    u16::try_from(n).unwrap_or(u16::MAX)
}

/// The network's slot of each variable of the automata as they were written.
#[derive(Default)]
struct QueryVariableSlots {
    own: Vec<u16>,
    /// After them, each location: the automaton in the network, and its number there.
    locations: Vec<(u16, usize)>,
}

impl QueryVariableSlots {
    fn of(network: NetworkId, scenario: &Scenario, automata: &[Automaton]) -> Self {
        let network = &scenario.networks[usize::from(network.0)];
        let (mut own, mut next) = (Vec::new(), slot(scenario.shared.len()));
        let mut locations = Vec::new();
        for (place, id) in (0..).zip(&network.automata) {
            let at = usize::from(id.0);
            locations.extend((0..scenario.automata[at].locations.len()).map(|l| (place, l)));
            own.extend((0..slot(scenario.automata[at].vars.len())).map(|v| next + v));
            next += slot(automata[at].vars.len());
        }
        Self { own, locations }
    }

    fn leaf(&self, leaf: &VariableRef) -> Expr {
        let after =
            if let VariableRef::Own(i) = leaf { usize::from(*i).checked_sub(self.own.len()) } else { None };
        match after.and_then(|at| self.locations.get(at)) {
            Some(&(automaton, location)) => Expr::binary(
                BinaryOp::Eq,
                Expr::Var(location_variable(automaton)),
                Expr::int(i64::try_from(location).unwrap_or(i64::MAX)),
            ),
            None => Expr::Var(lowering::VariableSlots::slot(self, leaf)),
        }
    }
}

impl lowering::VariableSlots<model::TypedExpr, VariableRef> for QueryVariableSlots {
    fn expr(&self, e: &model::TypedExpr) -> Expr {
        expr::expr(e, &mut |source| match source {
            LeafSource::Leaf(leaf) => self.leaf(&leaf),
            LeafSource::Term(..) => expr::ruled_out("measurement in a query"),
        })
    }

    fn slot(&self, of: &VariableRef) -> u16 {
        match of {
            VariableRef::Shared(i) => *i,
            VariableRef::Own(i) => {
                let own = self.own.get(usize::from(*i)).copied();
                own.unwrap_or_else(|| expr::ruled_out("variable of no automaton in a query"))
            }
            VariableRef::Local(_) | VariableRef::Signal(_) => expr::ruled_out("local or signal in a query"),
        }
    }
}
