//! Six automata that share an int which counts time: raised by constants, and read only to say that it is not yet so late. With many
//! goals, each a conjunction over locations and ints.

use hrdsl_ir::{
    Program,
    expr::BinaryOp::{Add, Ge as AtLeast, Le as AtMost, Lt, Sub},
    ta::{
        ClockOp::{Ge, Le},
        LocationId,
        LocationKind::Normal,
        QueryFormula,
    },
};

use super::{add, automaton, bin, clock, edge, eq, location, n, normal, program, shared, v};

/// Slots of the shared variables.
const TIME: u16 = 0;
const STOCK: u16 = 1;

/// What an automaton's edges take: minutes of the shared time, in the order of its locations.
const MINUTES: [[i64; 4]; 6] =
    [[1, 5, 2, 3], [2, 7, 1, 4], [3, 11, 2, 1], [1, 13, 5, 2], [4, 3, 1, 6], [2, 9, 3, 1]];

/// Cranes that fetch, carry and put down until the end of the shift.
pub fn shift(end: i64) -> Program {
    let mut p = program();
    let time = shared(&mut p, "time", 0, end, 0);
    let stock = shared(&mut p, "stock", 0, 2, 0);
    assert_eq!((time, stock), (TIME, STOCK));
    for (i, minutes) in MINUTES.iter().enumerate() {
        let mut a = automaton(&format!("Crane{i}"), if i == 0 { &["x"] } else { &[] });
        let timed = i == 0;
        let idle = normal(&mut a, "idle");
        let fetch = normal(&mut a, "fetch");
        let carry = if timed {
            location(&mut a, "carry", Normal, &[clock(0, Le, 6)])
        } else {
            normal(&mut a, "carry")
        };
        let rest = normal(&mut a, "rest");
        let places = [idle, fetch, carry, rest];
        for (at, &takes) in minutes.iter().enumerate() {
            let mut e = edge(places[at], places[(at + 1) % 4]);
            // The later half of the cranes stops earlier.
            let last = if i < 3 { end } else { end - end / 20 };
            e = e.when(bin(Lt, v(time), n(last - takes))).set(time, bin(Add, v(time), n(takes)));
            if timed && at == 1 {
                e = e.reset(0);
            } else if timed && at == 2 {
                e = e.clock(0, Ge, 2);
            }
            e = match (i, at) {
                (0 | 1, 2) => e.when(bin(Lt, v(stock), n(2))).set(stock, bin(Add, v(stock), n(1))),
                (4 | 5, 0) => e.when(bin(AtLeast, v(stock), n(1))).set(stock, bin(Sub, v(stock), n(1))),
                _ => e,
            };
            e.to(&mut a);
        }
        add(&mut p, a);
    }
    p
}

/// 91 conjunctions of 5 to 20 literals over locations, the stock and the time.
pub fn goals(end: i64) -> Vec<QueryFormula> {
    let mut seed = 1u64;
    let mut below = |n: u64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) % n
    };
    (0..91)
        .map(|_| {
            let many = 5 + below(16) as usize;
            let mut literals = Vec::new();
            // A location for some of the cranes, for the others where they are not.
            for automaton in 0..6u16 {
                let here = below(4) as u16;
                let at = |l: u16| QueryFormula::At { automaton, location: LocationId(l % 4) };
                if below(3) > 0 {
                    literals.push(at(here));
                } else {
                    literals.extend((1..3).map(|k| QueryFormula::Not(Box::new(at(here + k)))));
                }
            }
            literals.push(QueryFormula::Data(eq(v(STOCK), n(below(3) as i64))));
            let latest =
                if below(4) == 0 { 12 + below(40) as i64 } else { end - below(100) as i64 * end / 200 };
            literals.push(QueryFormula::Data(bin(Lt, v(TIME), n(latest))));
            while literals.len() < many {
                literals.push(QueryFormula::Data(bin(AtMost, v(TIME), n(latest + below(50) as i64))));
            }
            literals.truncate(many.max(8));
            QueryFormula::And(literals)
        })
        .collect()
}
