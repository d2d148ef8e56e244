//! Times of a network in other tools: the unit in which all its constants are whole, and how a time is read best.

use hrdsl_ir::{
    Nanos, Program,
    ta::{Automaton, EdgeAssignment, QueryFormula, TimeSum},
    value::SECOND,
};

/// The longest time of a scenario, in seconds: one of their units is one in what is imported.
const LONGEST: u64 = 1_000_000_000;

/// What is wrong with an imported number of seconds, and what to do about it, if it is too long for a scenario.
pub(crate) fn too_long(seconds: i64) -> Option<String> {
    (seconds.unsigned_abs() > LONGEST).then(|| {
        format!(
            "the time {seconds} is too long: one unit of time is a second in a scenario, whose times are at most {LONGEST} s; \
             write a smaller number, or divide all times of the model by the same one"
        )
    })
}

/// The greatest unit in which all time constants are whole; a second if there are none.
pub(crate) fn unit(program: &Program, automata: &[&Automaton]) -> Nanos {
    let mut all = 0;
    let mut see = |time: &TimeSum| {
        all = gcd(all, time.nanos.unsigned_abs());
        for term in &time.terms {
            all = gcd(all, term.factor.unsigned_abs());
        }
    };
    for a in automata {
        a.locations.iter().flat_map(|l| &l.invariant).for_each(|c| see(&c.bound));
        for e in &a.edges {
            e.clock_guard.iter().for_each(|c| see(&c.bound));
            for u in &e.updates {
                match u {
                    EdgeAssignment::Reset { to, .. } => see(to),
                    EdgeAssignment::Assign { .. } | EdgeAssignment::Call { .. } => {}
                }
            }
        }
    }
    for query in &program.queries {
        query.ask.formulas().into_iter().for_each(|f| formula(f, &mut see));
    }
    Nanos::try_from(all).ok().filter(|n| *n > 0).unwrap_or(SECOND)
}

/// A time as it is read best.
pub(crate) fn seconds(nanos: Nanos) -> String {
    let units = [(SECOND, "s"), (SECOND / 1_000, "ms"), (SECOND / 1_000_000, "us"), (1, "ns")];
    let (size, name) = units.into_iter().find(|(size, _)| nanos % size == 0).unwrap_or((1, "ns"));
    format!("{} {name}", nanos / size)
}

fn formula(f: &QueryFormula, see: &mut impl FnMut(&TimeSum)) {
    match f {
        QueryFormula::Clock(c) => see(&c.bound),
        QueryFormula::Not(f) => formula(f, see),
        QueryFormula::And(fs) | QueryFormula::Or(fs) => fs.iter().for_each(|f| formula(f, see)),
        QueryFormula::At { .. } | QueryFormula::Data(_) | QueryFormula::Deadlock => {}
    }
}

fn gcd(mut a: u64, mut b: u64) -> u64 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}
