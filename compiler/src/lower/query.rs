//! Queries: variables get the slots that they have in their network.

use hrdsl_ir::{
    Expr,
    ta::{Ask, Automaton, ClockConstraint, Formula, Measure, Query, Time, TimeTerm},
    value::nanos,
};
use hrdsl_model::{self as model, Leaf, Scenario};
use hrdsl_source::Files;

use super::{
    expr::{self, Source},
    monitor::one_line,
};

/// `automata` are the scenario's, lowered: they may have more variables than were written.
pub(crate) fn query(q: &model::Query, scenario: &Scenario, automata: &[Automaton], files: &Files) -> Query {
    let network = &scenario.networks[usize::from(q.network.0)];
    let (mut own, mut next) = (Vec::new(), slot(scenario.shared.len()));
    for id in &network.automata {
        let at = usize::from(id.0);
        own.extend((0..slot(scenario.automata[at].vars.len())).map(|v| next + v));
        next += slot(automata[at].vars.len());
    }
    let slots = Slots { own };
    Query {
        name: q.name.clone(),
        title: q.title.clone(),
        text: one_line(files.text(q.text)),
        network: q.network.0,
        ask: slots.ask(&q.ask),
        origin: q.span,
    }
}

fn slot(n: usize) -> u16 {
    u16::try_from(n).unwrap_or(u16::MAX)
}

/// The network's slot of each variable of the automata as they were written.
struct Slots {
    own: Vec<u16>,
}

impl Slots {
    fn ask(&self, ask: &model::Ask) -> Ask {
        match ask {
            model::Ask::Possibly(f) => Ask::Possibly(self.formula(f)),
            model::Ask::Invariantly(f) => Ask::Invariantly(self.formula(f)),
            model::Ask::PotentiallyAlways(f) => Ask::PotentiallyAlways(self.formula(f)),
            model::Ask::Eventually(f) => Ask::Eventually(self.formula(f)),
            model::Ask::LeadsTo(f, g) => Ask::LeadsTo(self.formula(f), self.formula(g)),
            model::Ask::Sup { of, when } => Ask::Sup { of: self.measures(of), when: self.formula(when) },
            model::Ask::Inf { of, when } => Ask::Inf { of: self.measures(of), when: self.formula(when) },
        }
    }

    fn formulas(&self, fs: &[model::Formula]) -> Vec<Formula> {
        fs.iter().map(|f| self.formula(f)).collect()
    }

    fn formula(&self, f: &model::Formula) -> Formula {
        match f {
            model::Formula::At { automaton, location } => {
                Formula::At { automaton: *automaton, location: *location }
            }
            model::Formula::Data(e) => Formula::Data(self.expr(e)),
            model::Formula::Clock(c) => Formula::Clock(ClockConstraint {
                clock: c.clock,
                minus: c.minus,
                op: c.op,
                bound: self.time(&c.bound),
            }),
            model::Formula::Deadlock => Formula::Deadlock,
            model::Formula::Not(f) => Formula::Not(Box::new(self.formula(f))),
            model::Formula::And(fs) => Formula::And(self.formulas(fs)),
            model::Formula::Or(fs) => Formula::Or(self.formulas(fs)),
        }
    }

    fn measures(&self, of: &[model::Measure]) -> Vec<Measure> {
        let measure = |m: &model::Measure| match m {
            model::Measure::Clock(clock) => Measure::Clock(*clock),
            model::Measure::Data(e) => Measure::Data(self.expr(e)),
        };
        of.iter().map(measure).collect()
    }

    fn time(&self, sum: &model::Linear) -> Time {
        let term = |(factor, value): &(f64, model::Expr)| TimeTerm {
            factor: nanos(*factor),
            value: self.expr(value),
        };
        Time { nanos: nanos(sum.seconds), terms: sum.terms.iter().map(term).collect() }
    }

    fn expr(&self, e: &model::Expr) -> Expr {
        expr::expr(e, &mut |source| match source {
            Source::Leaf(Leaf::Shared(i)) => Expr::Var(i),
            Source::Leaf(Leaf::Own(i)) => {
                self.own.get(usize::from(i)).map_or(Expr::bool(false), |slot| Expr::Var(*slot))
            }
            // INVARIANT: the checker lets nothing else into a query.
            Source::Leaf(Leaf::Local(_) | Leaf::Signal(_)) | Source::Term(..) => Expr::bool(false),
        })
    }
}
