//! Requirements that hold in all runs of the original, as far as can be told without a monitor, and that another run breaks.

use hrdsl_ir::{Nanos, Program, Type, value::seconds, world::SignalId};

use crate::{
    common::{CommonFacts, FormedRun},
    facts::RunMoment,
    forms::narrower,
};

/// Requirements of a kind that are tried for one run.
const MOST_OF_A_KIND: usize = 8;
/// Of these, about the same.
const MOST_OF_A_TOPIC: usize = 2;
/// Bounds on times are so much longer than the longest that was seen: the next test may take a little longer.
const LEEWAY: f64 = 1.05;
/// Where only that tells a mutant from the original, they have none.
const NO_LEEWAY: f64 = 1.0;
/// The step of bounds on times, in seconds.
const TIME_STEP: f64 = 0.1;
/// The language counts no further in `at most N E`.
const MOST_COUNTED: usize = 1000;
/// Digits of a bound on a signal: so many if that tells a mutant from the original, and more only if not.
const DIGITS: std::ops::RangeInclusive<i32> = 3..=4;

/// A requirement that would notice something, and is yet to be tried.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Candidate {
    /// As it is written after `require NAME KIND`.
    pub pattern: String,
    /// What it is about: of two that say the same of it, one is enough.
    pub topic: String,
}

/// Candidates of a kind, with what the narrower and the better readable have less of.
type Ranked<R> = Vec<(R, Candidate)>;

/// What a run breaks of what the runs of the original have in common.
pub(crate) struct BrokenFacts<'a> {
    pub program: &'a Program,
    pub common: &'a CommonFacts,
    pub run: &'a FormedRun,
}

impl BrokenFacts<'_> {
    /// The candidates of all kinds; of each kind, the narrowest first.
    pub(crate) fn candidates(&self) -> Vec<Candidate> {
        let mut all = best(self.answers());
        all.extend(best(self.separations()));
        all.extend(best(self.occurrences()));
        all.extend(best(self.orders()));
        all.extend(best(self.novelties()));
        all.extend(best(self.ranges()));
        all
    }

    /// `C causes E within D`, and not before it.
    fn answers(&self) -> Ranked<(bool, Nanos, usize)> {
        let mut found = Vec::new();
        for ((first, second), pair) in &self.common.pairs {
            let Some((shortest, longest)) = pair.answered.filter(|_| pair.firsts > 0) else { continue };
            let other = self.run.pair(*first, *second);
            if other.firsts == 0 {
                continue;
            }
            let is_late = |bound: &f64| other.answered.is_none_or(|(_, late)| seconds(late) > *bound);
            let is_early = |bound: &f64| other.answered.is_some_and(|(early, _)| seconds(early) < *bound);
            let late = [time_bound(longest, LEEWAY), time_bound(longest, NO_LEEWAY)];
            let early = [earliest(shortest, LEEWAY), earliest(shortest, NO_LEEWAY)];
            let (loose, late) = (time_bound(longest, LEEWAY), late.into_iter().find(is_late));
            let bounds = match (late, early.into_iter().find(is_early)) {
                (Some(late), _) => format!("within {late} s"),
                (None, Some(early)) => format!("not before {early} s within {loose} s"),
                (None, None) => continue,
            };
            let pattern = format!("{} causes {} {bounds}", self.text(*first), self.text(*second));
            found.push((
                (self.is_stimulus(*first), longest, self.narrowness([*first, *second])),
                Candidate { pattern, topic: format!("when {}", self.text(*second)) },
            ));
        }
        found
    }

    /// `E forbids E until C`.
    fn separations(&self) -> Ranked<(bool, usize)> {
        let pairs = self.common.pairs.iter().filter(|((first, second), pair)| {
            pair.separated && pair.seconds > 0 && !self.run.pair(*first, *second).separated
        });
        let candidate = |(first, second)| {
            let (first_text, second_text) = (self.text(first), self.text(second));
            let pattern = format!("{second_text} forbids {second_text} until {first_text}");
            let candidate = Candidate { pattern, topic: format!("twice {second_text}") };
            ((self.is_stimulus(first), self.narrowness([first, second])), candidate)
        };
        pairs.map(|(pair, _)| candidate(*pair)).collect()
    }

    /// `at most N E`, and `eventually E within D`.
    fn occurrences(&self) -> Ranked<usize> {
        let mut found = Vec::new();
        for (at, form) in self.common.forms.iter().enumerate().filter(|(_, form)| !form.is_played) {
            let (most, text) = (self.common.count(at).1, &form.text);
            let own = self.run.moments(at);
            let topic = format!("count {text}");
            if own.len() > most && (1..=MOST_COUNTED).contains(&most) {
                let pattern = format!("at most {most} {text}");
                found.push((form.narrowness(), Candidate { pattern, topic }));
            } else if let Some(latest) = self.common.latest_first(at) {
                let bounds = [time_bound(latest, LEEWAY), time_bound(latest, NO_LEEWAY)];
                let is_late = |bound: &f64| own.first().is_none_or(|first| seconds(first.time) > *bound);
                if let Some(bound) = bounds.into_iter().find(is_late) {
                    let pattern = format!("eventually {text} within {bound} s");
                    found.push((form.narrowness(), Candidate { pattern, topic }));
                }
            }
        }
        found
    }

    /// `C precedes E`.
    fn orders(&self) -> Ranked<(bool, usize)> {
        let pairs = self.common.pairs.iter().filter(|((first, second), pair)| {
            pair.preceded && pair.seconds > 0 && !self.run.pair(*first, *second).preceded
        });
        let candidate = |(first, second)| {
            let pattern = format!("{} precedes {}", self.text(first), self.text(second));
            let candidate = Candidate { pattern, topic: format!("order {}", self.text(second)) };
            ((self.is_stimulus(first), self.narrowness([first, second])), candidate)
        };
        pairs.map(|(pair, _)| candidate(*pair)).collect()
    }

    /// `never E after C`, where no run of the original has an E: in the whole run, nothing would show that it says anything of them.
    fn novelties(&self) -> Ranked<(usize, bool, std::cmp::Reverse<RunMoment>)> {
        let known = self.common.known();
        let mut found = Vec::new();
        for (at, form) in self.common.forms.iter().enumerate() {
            let first = self.run.moments(at).first();
            let (Some(first), false) = (first, form.is_played || known.contains(form.text.as_str())) else {
                continue;
            };
            self.never(&form.text, 0, *first, &mut found);
        }
        for seen in &self.run.facts.events {
            for form in narrower(self.program, seen) {
                if !form.is_played && !known.contains(form.text.as_str()) {
                    self.never(&form.text, form.narrowness(), seen.moment, &mut found);
                }
            }
        }
        found
    }

    fn never(
        &self,
        text: &str,
        narrowness: usize,
        first: RunMoment,
        found: &mut Ranked<(usize, bool, std::cmp::Reverse<RunMoment>)>,
    ) {
        for (at, opening) in self.common.forms.iter().enumerate() {
            let before = self.run.moments(at).first().filter(|moment| **moment < first);
            let (Some(before), true) = (before, self.common.count(at).1 > 0) else { continue };
            let pattern = format!("never {text} after {}", opening.text);
            let rank = (narrowness + opening.narrowness(), opening.is_stimulus, std::cmp::Reverse(*before));
            found.push((rank, Candidate { pattern, topic: format!("new {text}") }));
        }
    }

    /// `always S <= V`, `eventually S >= V within D`, and both after an event.
    fn ranges(&self) -> Ranked<(bool, bool, usize)> {
        let mut found = Vec::new();
        let openings = std::iter::once(None).chain((0..self.common.forms.len()).map(Some));
        for after in openings.filter(|after| self.run.opening(*after).is_some()) {
            let (is_stimulus, narrowness, scope) = match after {
                None => (false, 0, String::new()),
                Some(form) => {
                    (self.is_stimulus(form), self.narrowness([form]), format!(" after {}", self.text(form)))
                }
            };
            for signal in self.run.facts.signals() {
                for condition in self.broken_ranges(signal, after) {
                    let pattern = format!("{condition}{scope}");
                    let topic = format!("signal {} {}", signal.0, condition.starts_with("always"));
                    found.push(((after.is_some(), is_stimulus, narrowness), Candidate { pattern, topic }));
                }
            }
        }
        found
    }

    fn broken_ranges(&self, signal: SignalId, after: Option<usize>) -> Vec<String> {
        let (Some(common), Some(own)) = (self.common.range(signal, after), self.run.range(signal, after))
        else {
            return Vec::new();
        };
        let mut found = Vec::new();
        if let Some(most) = between(common.most, own.1).filter(|most| *most < own.1) {
            found.push(format!("always {}", self.condition(signal, "<=", most)));
        }
        if let Some(least) = between(common.least, own.0).filter(|least| *least > own.0) {
            found.push(format!("always {}", self.condition(signal, ">=", least)));
        }
        // All runs of the original come so far, and in time.
        let least_digits = *DIGITS.start();
        let high = between(common.least_of_most, own.1).filter(|high| *high > own.1);
        let high = high.unwrap_or_else(|| beyond(common.least_of_most, -1.0, least_digits));
        found.extend(self.reached(signal, after, (">=", high), |value| value >= high));
        let low = between(common.most_of_least, own.0).filter(|low| *low < own.0);
        let low = low.unwrap_or_else(|| beyond(common.most_of_least, 1.0, least_digits));
        found.extend(self.reached(signal, after, ("<=", low), |value| value <= low));
        found
    }

    fn reached(
        &self,
        signal: SignalId,
        after: Option<usize>,
        (comparison, bound): (&str, f64),
        is_met: impl Fn(f64) -> bool + Copy,
    ) -> Option<String> {
        let latest = time_bound(self.common.longest_until(signal, after, is_met)?, LEEWAY);
        let own = self.run.time_until(signal, after, is_met);
        let is_late = own.is_none_or(|own| seconds(own) > latest);
        is_late.then(|| format!("eventually {} within {latest} s", self.condition(signal, comparison, bound)))
    }

    /// A truth value is 0 or 1.
    fn condition(&self, signal: SignalId, comparison: &str, bound: f64) -> String {
        let declared = self.program.signal(signal);
        let name = &declared.name;
        match declared.ty {
            Type::Bool if comparison == ">=" => name.clone(),
            Type::Bool => format!("!{name}"),
            Type::Float(unit) => {
                format!("{name} {comparison} {bound} {}", unit.symbol()).trim_end().to_owned()
            }
            Type::Int { .. } | Type::Enum(_) | Type::Text | Type::List(_) => {
                format!("{name} {comparison} {bound}")
            }
        }
    }

    fn text(&self, form: usize) -> &str {
        self.common.forms.get(form).map_or("", |form| form.text.as_str())
    }

    /// What a test does is less of a cause than what is said or seen.
    fn is_stimulus(&self, form: usize) -> bool {
        self.common.forms.get(form).is_some_and(|form| form.is_stimulus)
    }

    fn narrowness<const N: usize>(&self, forms: [usize; N]) -> usize {
        let forms = forms.into_iter().filter_map(|form| self.common.forms.get(form));
        forms.map(|form| form.narrowness()).sum()
    }
}

/// The first of a kind, few about the same.
fn best<R: Ord>(mut found: Ranked<R>) -> Vec<Candidate> {
    found.sort();
    let mut kept: Vec<Candidate> = Vec::new();
    for (_, candidate) in found {
        let same = kept.iter().filter(|other| other.topic == candidate.topic).count();
        if same < MOST_OF_A_TOPIC && !kept.contains(&candidate) {
            kept.push(candidate);
        }
        if kept.len() == MOST_OF_A_KIND {
            break;
        }
    }
    kept
}

/// A bound in seconds that the longest time keeps, with some leeway.
fn time_bound(longest: Nanos, leeway: f64) -> f64 {
    let steps = (seconds(longest) * leeway / TIME_STEP).ceil().max(1.0);
    (steps * TIME_STEP * 10.0).round() / 10.0
}

/// A bound in seconds that the shortest time keeps, with some leeway; 0 if there is no room for one.
fn earliest(shortest: Nanos, leeway: f64) -> f64 {
    let steps = (seconds(shortest) / leeway / TIME_STEP).floor();
    (steps * TIME_STEP * 10.0).round() / 10.0
}

/// A number between what all runs of the original keep and what another run has, at no distance from the former that can be helped.
fn between(kept: f64, other: f64) -> Option<f64> {
    let direction = other - kept;
    let mut bounds = DIGITS.map(|digits| beyond(kept, direction, digits));
    bounds.find(|bound| (other - bound) * direction > 0.0)
}

/// The next number in a direction with so many digits: a bound that is kept by what was seen, and can be read.
fn beyond(value: f64, direction: f64, digits: i32) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    let scale = 10_f64.powi(digits - 1 - value.abs().log10().floor() as i32);
    let scaled = if direction > 0.0 { (value * scale).ceil() } else { (value * scale).floor() };
    // Through its decimal text, so that it is written with these digits.
    format!("{:.6e}", scaled / scale).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::value::SECOND;

    use super::*;

    #[test]
    fn bounds_are_kept_by_what_was_seen_and_can_be_read() {
        assert_eq!(time_bound(0, LEEWAY), 0.1);
        let three = 3 * SECOND;
        assert_eq!(
            (time_bound(three, LEEWAY), earliest(three, LEEWAY), earliest(SECOND / 20, LEEWAY)),
            (3.2, 2.8, 0.0)
        );
        assert_eq!((time_bound(three, NO_LEEWAY), earliest(three, NO_LEEWAY)), (3.0, 3.0));
        assert_eq!((beyond(0.123_41, 1.0, 3), beyond(0.123_41, -1.0, 3)), (0.124, 0.123));
        assert_eq!((beyond(-7.001, 1.0, 3), beyond(-7.001, -1.0, 3)), (-7.0, -7.01));
        assert_eq!((beyond(1234.5, 1.0, 3), beyond(0.0, 1.0, 3)), (1240.0, 0.0));
    }

    #[test]
    fn a_bound_has_as_many_digits_as_it_needs() {
        assert_eq!(between(0.7051, 0.9), Some(0.706));
        assert_eq!(between(0.705_12, 0.7055), Some(0.7052), "0.706 would be kept, too");
        assert_eq!(between(0.705_12, 0.705_13), None, "nobody would ask for that");
        assert_eq!(between(0.7051, 0.2), Some(0.705));
        assert_eq!((between(1.0, 0.0), between(0.0, 1.0), between(1.0, 1.0)), (Some(1.0), Some(0.0), None));
    }
}
