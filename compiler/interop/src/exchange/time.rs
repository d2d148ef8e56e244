//! Times of a network in other tools: the unit in which all its constants are whole, and how a time is read best.

use hrdsl_ir::{
    Nanos, Program,
    ta::{Ask, Automaton, Formula, Time, Update},
    value::SECOND,
};

/// The greatest unit in which all time constants are whole; a second if there are none.
pub(crate) fn unit(program: &Program, automata: &[&Automaton]) -> Nanos {
    let mut all = 0;
    let mut see = |time: &Time| {
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
                    Update::Reset { to, .. } => see(to),
                    Update::Assign { .. } | Update::Call { .. } => {}
                }
            }
        }
    }
    for query in &program.queries {
        match &query.ask {
            Ask::Possibly(f) | Ask::Invariantly(f) | Ask::PotentiallyAlways(f) | Ask::Eventually(f) => {
                formula(f, &mut see);
            }
            Ask::LeadsTo(f, g) => {
                formula(f, &mut see);
                formula(g, &mut see);
            }
            Ask::Sup { when, .. } | Ask::Inf { when, .. } => formula(when, &mut see),
        }
    }
    Nanos::try_from(all).ok().filter(|n| *n > 0).unwrap_or(SECOND)
}

/// A time as it is read best.
pub(crate) fn seconds(nanos: Nanos) -> String {
    let units = [(SECOND, "s"), (SECOND / 1_000, "ms"), (SECOND / 1_000_000, "us"), (1, "ns")];
    let (size, name) = units.into_iter().find(|(size, _)| nanos % size == 0).unwrap_or((1, "ns"));
    format!("{} {name}", nanos / size)
}

fn formula(f: &Formula, see: &mut impl FnMut(&Time)) {
    match f {
        Formula::Clock(c) => see(&c.bound),
        Formula::Not(f) => formula(f, see),
        Formula::And(fs) | Formula::Or(fs) => fs.iter().for_each(|f| formula(f, see)),
        Formula::At { .. } | Formula::Data(_) | Formula::Deadlock => {}
    }
}

fn gcd(mut a: u64, mut b: u64) -> u64 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}
