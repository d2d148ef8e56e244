//! Where clocks stand still: deadlocks, bounds, fastest runs and what holds along whole runs, by hand and against a judge that tries all
//! times of a grid.
//!
//! `HRDSL_CASES` sets the number of networks, `HRDSL_SEED` the first seed.

mod common;

use common::asked::{at, query};
use common::grid::{GRID, GridJudge, GridState, MOST, random};
use common::{add, automaton, bin, clock, edge, eq, location, n, normal, program, shared, v};
use hrdsl_ir::{
    Program,
    expr::BinaryOp,
    suite::WitnessKind,
    ta::{ClockId, ClockOp, LocationId, LocationKind, QueryFormula, QueryKind, QueryMeasure},
    value::SECOND,
};
use hrdsl_ta::{
    ExtremumLimit, ExtremumValue, MeasureExtremum, QueryAnswer, QueryOptions, QueryVerdict, RunEnding,
    SearchBudget, WitnessRun, answer,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

fn options(witness: WitnessKind) -> QueryOptions {
    let budget = SearchBudget { states: 3_000, ..SearchBudget::default() };
    QueryOptions { budget, witness, ..QueryOptions::default() }
}

fn ask(p: &Program, ask: QueryKind) -> QueryAnswer {
    answer(p, &p.networks[0], &query(ask), &options(WitnessKind::Any)).unwrap()
}

// ── By hand ──

/// x runs in `first` and `second`, y in `second` and `third`, z in `first` and `third`, w always; at the end the first three are 1 at most.
fn pairs(op: ClockOp) -> Program {
    let mut p = program();
    let mut a = automaton("P", &["x", "y", "z", "w"]);
    let places: Vec<LocationId> = ["first", "second", "third", "end"].map(|l| normal(&mut a, l)).to_vec();
    for (place, stands) in places.iter().zip([1u16, 2, 0]) {
        a.locations[usize::from(place.0)].stopped = vec![ClockId(stands)];
    }
    a.locations[3].kind = LocationKind::Urgent;
    edge(places[0], places[1]).to(&mut a);
    edge(places[1], places[2]).to(&mut a);
    edge(places[2], places[3]).clock(0, op, 1).clock(1, ClockOp::Le, 1).clock(2, ClockOp::Le, 1).to(&mut a);
    add(&mut p, a);
    p
}

fn bounds(p: &Program, measure: QueryMeasure, when: QueryFormula) -> [ExtremumLimit; 2] {
    let one = |ask: QueryKind| {
        let answer = self::ask(p, ask);
        assert_eq!(answer.extrema.len(), 1);
        answer.extrema[0].limit
    };
    let of = vec![measure];
    let inf = QueryKind::Inf { of: of.clone(), when: when.clone() };
    [one(inf), one(QueryKind::Sup { of, when })]
}

fn seconds(value: i64, attained: bool) -> ExtremumLimit {
    ExtremumLimit::At { value: ExtremumValue::Nanos(value), attained }
}

#[test]
fn a_bound_may_be_a_fraction_of_all_constants() {
    let (w, end) = (QueryMeasure::Clock(ClockId(3)), at(0, LocationId(3)));
    let limits = bounds(&pairs(ClockOp::Le), w.clone(), end.clone());
    assert_eq!(limits, [seconds(0, true), seconds(3 * SECOND / 2, true)]);
    let limits = bounds(&pairs(ClockOp::Lt), w.clone(), end.clone());
    assert_eq!(limits, [seconds(0, true), seconds(3 * SECOND / 2, false)]);
    let limits = bounds(&pairs(ClockOp::Eq), w.clone(), end);
    assert_eq!(limits, [seconds(SECOND, true), seconds(3 * SECOND / 2, true)]);
    let before = bounds(&pairs(ClockOp::Eq), w, at(0, LocationId(2)));
    assert_eq!(before, [seconds(0, true), ExtremumLimit::Unbounded]);
    let x = bounds(&pairs(ClockOp::Gt), QueryMeasure::Clock(ClockId(0)), at(0, LocationId(3)));
    assert_eq!(x, [seconds(SECOND, false), seconds(2 * SECOND, true)]);
}

/// Counts rounds of 2 s at least, up to 50 within 100 s.
fn rounds() -> Program {
    let mut p = program();
    let k = shared(&mut p, "k", 0, 50, 0);
    let mut a = automaton("P", &["x", "t"]);
    let on =
        location(&mut a, "on", LocationKind::Normal, &[clock(0, ClockOp::Le, 2), clock(1, ClockOp::Le, 100)]);
    let off = location(&mut a, "off", LocationKind::Normal, &[clock(1, ClockOp::Le, 100)]);
    a.locations[usize::from(off.0)].stopped = vec![ClockId(0)];
    edge(on, off).clock(0, ClockOp::Eq, 2).set(k, bin(BinaryOp::Add, v(k), n(1))).to(&mut a);
    edge(off, on).reset(0).to(&mut a);
    add(&mut p, a);
    p
}

#[test]
fn an_int_far_away_is_found_by_halving() {
    let k = QueryMeasure::Data(v(0));
    let all = QueryFormula::And(Vec::new());
    let number = |n| ExtremumLimit::At { value: ExtremumValue::Number(n), attained: true };
    assert_eq!(bounds(&rounds(), k, all.clone()), [number(0), number(50)]);
    let odd = QueryMeasure::Data(eq(bin(BinaryOp::Rem, v(0), n(2)), n(1)));
    assert_eq!(bounds(&rounds(), odd, all), [number(0), number(1)]);
}

#[test]
fn the_fastest_run_is_found_by_a_longer_path() {
    // The short way stands still for 3 s; the long one, of three edges, takes 2 s.
    let mut p = program();
    let mut a = automaton("P", &["x", "y"]);
    let [start, slow, one, two, end] = ["start", "slow", "one", "two", "end"].map(|l| normal(&mut a, l));
    a.locations[usize::from(slow.0)].stopped = vec![ClockId(0)];
    edge(start, slow).clock(0, ClockOp::Ge, 1).reset(1).to(&mut a);
    edge(slow, end).clock(1, ClockOp::Ge, 3).to(&mut a);
    edge(start, one).to(&mut a);
    edge(one, two).to(&mut a);
    edge(two, end).clock(0, ClockOp::Gt, 2).to(&mut a);
    add(&mut p, a);
    let found = |witness| {
        let query = query(QueryKind::Possibly(at(0, end)));
        *answer(&p, &p.networks[0], &query, &options(witness)).unwrap().run.unwrap()
    };
    let (short, fast) = (found(WitnessKind::Shortest), found(WitnessKind::Fastest));
    assert_eq!((short.steps.len(), short.end), (2, 4 * SECOND * short.ticks));
    assert_eq!(fast.steps.len(), 3);
    assert!(fast.end > 2 * SECOND * fast.ticks && fast.end < 21 * SECOND / 10 * fast.ticks, "{}", fast.end);
}

/// A worker that pauses: x, the work that is done, stands meanwhile. It comes to an end at last if pauses do.
fn worker(pauses_end: bool) -> Program {
    let mut p = program();
    let mut a = automaton("P", &["x", "y"]);
    let work = location(&mut a, "work", LocationKind::Normal, &[clock(0, ClockOp::Le, 3)]);
    let most = pauses_end.then(|| clock(1, ClockOp::Le, 2));
    let pause = location(&mut a, "pause", LocationKind::Normal, most.as_slice());
    let done = normal(&mut a, "done");
    a.locations[usize::from(pause.0)].stopped = vec![ClockId(0)];
    edge(work, pause).clock(1, ClockOp::Ge, 1).reset(1).to(&mut a);
    edge(pause, work).clock(1, ClockOp::Ge, 1).reset(1).to(&mut a);
    edge(work, done).clock(0, ClockOp::Eq, 3).to(&mut a);
    add(&mut p, a);
    p
}

#[test]
fn what_comes_at_last_is_proved_and_what_waits_for_ever_is_shown() {
    let done = || at(0, LocationId(2));
    let verdict = |pauses_end, ask| self::ask(&worker(pauses_end), ask).verdict;
    let holds = QueryVerdict::Holds;
    assert_eq!(verdict(true, QueryKind::Eventually(done())), holds);
    assert_eq!(verdict(true, QueryKind::LeadsTo(at(0, LocationId(1)), done())), holds);
    assert_eq!(
        verdict(true, QueryKind::PotentiallyAlways(QueryFormula::Not(Box::new(done())))),
        QueryVerdict::Fails
    );
    let forever = self::ask(&worker(false), QueryKind::Eventually(done()));
    assert_eq!(forever.verdict, QueryVerdict::Fails, "{}", forever.why);
    assert_eq!(forever.run.map(|run| run.ending), Some(RunEnding::Waits));
    // Work takes 3 s, so that three pauses at most are long.
    let late = QueryFormula::And(vec![
        at(0, LocationId(0)),
        QueryFormula::Clock(clock(0, ClockOp::Ge, 1)),
        QueryFormula::Clock(clock(1, ClockOp::Ge, 2)),
    ]);
    assert_eq!(verdict(true, QueryKind::Eventually(late)), QueryVerdict::Fails);
}

#[test]
fn a_loop_is_one_if_its_clocks_come_round() {
    // x stands in both places, so that the first edge stays open for ever.
    let mut p = program();
    let mut a = automaton("P", &["x", "y"]);
    let [one, two, end] =
        ["one", "two", "end"].map(|l| location(&mut a, l, LocationKind::Normal, &[clock(1, ClockOp::Le, 2)]));
    for place in [one, two] {
        a.locations[usize::from(place.0)].stopped = vec![ClockId(0)];
    }
    edge(one, two).clock(0, ClockOp::Le, 1).clock(1, ClockOp::Ge, 1).reset(1).to(&mut a);
    edge(two, one).clock(1, ClockOp::Ge, 1).reset(1).to(&mut a);
    edge(one, end).to(&mut a);
    add(&mut p, a.clone());
    let found = self::ask(&p, QueryKind::Eventually(at(0, end)));
    assert_eq!(found.verdict, QueryVerdict::Fails, "{}", found.why);
    assert!(matches!(found.run.as_ref().map(|r| r.ending), Some(RunEnding::Again(_))));
    assert!(!found.why.contains("Zeno"), "{}", found.why);
    // If it runs in one of them by at least a second, it is gone round twice at most.
    p.automata[0].locations[usize::from(two.0)].stopped.clear();
    let found = self::ask(&p, QueryKind::PotentiallyAlways(QueryFormula::Not(Box::new(at(0, end)))));
    assert_eq!(found.verdict, QueryVerdict::Fails, "{}", found.why);
}

// ── At random, against a grid ──

fn number(name: &str, default: u64) -> u64 {
    #[allow(clippy::disallowed_methods, reason = "how long to look is asked from outside")]
    let given = std::env::var(name).ok();
    given.and_then(|n| n.parse().ok()).unwrap_or(default)
}

fn cases() -> u64 {
    number("HRDSL_CASES", 150)
}

/// All times of a run are on the judge's grid.
fn is_on_grid(run: &WitnessRun) -> bool {
    run.steps
        .iter()
        .map(|s| s.time)
        .chain([run.end])
        .all(|t| i128::from(t) * i128::from(GRID) % (i128::from(run.ticks) * i128::from(SECOND)) == 0)
}

/// How many were yes, no, open, and yes by runs of other times than the judge has.
#[derive(Debug, Default)]
struct Tally {
    yes: u64,
    no: u64,
    open: u64,
    finer: u64,
}

impl Tally {
    /// `shows`: what the engine shows a run for, if it does.
    fn judge(&mut self, what: &str, shown: Option<(bool, Option<&WitnessRun>)>, is_so: bool) {
        match shown {
            None => self.open += 1,
            Some((true, run)) => {
                self.yes += 1;
                let finer = run.is_some_and(|run| !is_on_grid(run));
                assert!(is_so || finer, "{what}: it is not so, but there is a run: {run:?}");
                self.finer += u64::from(!is_so);
            }
            Some((false, _)) => {
                self.no += 1;
                assert!(!is_so, "{what}: it is so, and said not to be");
            }
        }
    }
}

fn shown(answer: &QueryAnswer, by: QueryVerdict) -> Option<(bool, Option<&WitnessRun>)> {
    (answer.verdict != QueryVerdict::Inconclusive).then(|| (answer.verdict == by, answer.run.as_deref()))
}

/// A network of which the start is allowed, with its judge's states.
fn each(mut f: impl FnMut(u64, &Program, &GridJudge, &[(GridState, i64)])) {
    let first = number("HRDSL_SEED", 0);
    for seed in first..first + cases() {
        let p = random(&mut ChaCha8Rng::seed_from_u64(seed));
        let judge = GridJudge { p: &p, grid: GRID };
        let states: Vec<(GridState, i64)> = judge.states().into_iter().collect();
        if !states.is_empty() {
            f(seed, &p, &judge, &states);
        }
    }
}

#[test]
fn deadlocks_agree_with_a_grid() {
    let mut tally = Tally::default();
    each(|seed, p, judge, states| {
        for l in 0..3 {
            let formula = QueryFormula::And(vec![at(0, LocationId(l)), QueryFormula::Deadlock]);
            let answer = ask(p, QueryKind::Possibly(formula));
            let is_so = states.iter().any(|(s, _)| s.0[0] == usize::from(l) && judge.is_deadlock(s));
            tally.judge(&format!("{seed}: l{l}"), shown(&answer, QueryVerdict::Holds), is_so);
        }
    });
    let Tally { yes, no, open, finer } = tally;
    assert!(yes > cases() / 4 && no > cases() / 4 && open * 20 <= yes + no && finer * 10 <= yes, "{tally:?}");
}

#[test]
fn what_holds_along_runs_agrees_with_a_grid() {
    let mut tally = Tally::default();
    each(|seed, p, judge, states| {
        let start: [GridState; 1] = [([0, 0], 0, [0; 3])];
        for l in 0..3 {
            let end = at(1, LocationId(l));
            let is_there = |s: &GridState| s.0[1] == usize::from(l);
            let stays = judge.stays(&start, &|s| !is_there(s));
            let answer = ask(p, QueryKind::Eventually(end.clone()));
            tally.judge(&format!("{seed}: A<> l{l}"), shown(&answer, QueryVerdict::Fails), stays);
            let always = QueryKind::PotentiallyAlways(QueryFormula::Not(Box::new(end.clone())));
            tally.judge(&format!("{seed}: E[] l{l}"), shown(&ask(p, always), QueryVerdict::Holds), stays);
            let first = QueryFormula::And(vec![
                QueryFormula::Data(eq(v(0), n(i64::from(l)))),
                QueryFormula::Clock(clock(0, ClockOp::Ge, 2)),
            ]);
            let from: Vec<GridState> = states
                .iter()
                .map(|(s, _)| *s)
                .filter(|s| s.1 == i64::from(l) && s.2[0] >= 2 * GRID)
                .collect();
            let stays = judge.stays(&from, &|s| !is_there(s));
            let answer = ask(p, QueryKind::LeadsTo(first, end));
            tally.judge(&format!("{seed}: --> l{l}"), shown(&answer, QueryVerdict::Fails), stays);
        }
    });
    let Tally { yes, no, open, finer } = tally;
    assert!(yes > cases() && no > cases() / 4 && open * 5 <= yes + no && finer * 10 <= yes, "{tally:?}");
}

#[test]
fn bounds_agree_with_a_grid() {
    let (mut known, mut open, mut finer) = (0, 0, 0);
    each(|seed, p, _, states| {
        for l in 0..3 {
            let when = at(0, LocationId(l));
            let here: Vec<&GridState> =
                states.iter().map(|(s, _)| s).filter(|s| s.0[0] == usize::from(l)).collect();
            let measures =
                [QueryMeasure::Data(v(0)), QueryMeasure::Clock(ClockId(0)), QueryMeasure::Clock(ClockId(2))];
            for (which, measure) in measures.into_iter().enumerate() {
                // The network's clocks: the shared one, then one of each automaton.
                let value = |s: &&GridState| [s.1, s.2[0], s.2[2]][which];
                for greatest in [true, false] {
                    let (of, when) = (vec![measure.clone()], when.clone());
                    let kind =
                        if greatest { QueryKind::Sup { of, when } } else { QueryKind::Inf { of, when } };
                    let found = ask(p, kind).extrema.remove(0);
                    let values = here.iter().map(value);
                    let want = if greatest { values.max() } else { values.min() };
                    let what = format!("{seed}: l{l} {which} {greatest}");
                    match compared(&what, &found, want, greatest) {
                        None => open += 1,
                        Some(is_finer) => (known, finer) = (known + 1, finer + u64::from(is_finer)),
                    }
                }
            }
        }
    });
    assert!(known > 6 * cases() && open * 20 <= known && finer * 10 <= known, "{known} {open} {finer}");
}

/// Whether the bound is one that only finer times than the grid's come to; `None`: it is open.
fn compared(what: &str, found: &MeasureExtremum, want: Option<i64>, greatest: bool) -> Option<bool> {
    // In parts of nanoseconds or of ones.
    let (value, of_want) = match found.limit {
        ExtremumLimit::Inconclusive { .. } => return None,
        ExtremumLimit::Nowhere => {
            assert_eq!(want, None, "{what}");
            return Some(false);
        }
        ExtremumLimit::Unbounded => {
            assert_eq!(want, Some((MOST + 1) * GRID), "{what}: unbounded");
            return Some(false);
        }
        ExtremumLimit::At { value: ExtremumValue::Number(n), .. } => (n, 1),
        // Beyond its cap the grid does not count on.
        ExtremumLimit::At { value: ExtremumValue::Nanos(n), .. } => {
            (n.min((MOST + 1) * SECOND) * GRID, SECOND)
        }
    };
    let is_finer = found.run.as_deref().is_some_and(|run| !is_on_grid(run));
    let Some(want) = want else {
        assert!(is_finer, "{what}: {found:?} is nowhere");
        return Some(true);
    };
    let is_short = if greatest { value < want * of_want } else { value > want * of_want };
    assert!(!is_short, "{what}: {found:?} is short of {want}");
    assert!(is_finer || value == want * of_want, "{what}: {found:?} is beyond {want}");
    Some(value != want * of_want)
}

#[test]
fn fastest_runs_agree_with_a_grid() {
    let (mut found, mut finer) = (0, 0);
    each(|seed, p, _, states| {
        for l in 0..3 {
            let ask = query(QueryKind::Possibly(at(1, LocationId(l))));
            let answer = answer(p, &p.networks[0], &ask, &options(WitnessKind::Fastest)).unwrap();
            let Some(run) = answer.run else { continue };
            let here = states.iter().filter(|(s, _)| s.0[1] == usize::from(l));
            let want = here.map(|(_, time)| *time).min();
            found += 1;
            let end = i128::from(run.end) * i128::from(GRID);
            let scale = i128::from(run.ticks) * i128::from(SECOND);
            let is_late = want.is_some_and(|want| end > i128::from(want) * scale);
            assert!(!is_late, "{seed}: l{l} is reached after {want:?} parts of a second: {run:?}");
            if want.is_none_or(|want| end < i128::from(want) * scale) {
                assert!(!is_on_grid(&run), "{seed}: l{l} is not reached before {want:?}: {run:?}");
                finer += 1;
            }
        }
    });
    assert!(found > cases() && finer * 10 <= found, "{found} {finer}");
}
