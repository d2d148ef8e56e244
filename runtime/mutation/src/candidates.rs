//! Requirements that hold in all runs of the original, as far as can be told without a monitor, and that another run breaks.

use std::{cmp::Reverse, collections::BTreeMap};

use hrdsl_ir::{Nanos, Program, Type, value::seconds, world::SignalId};

use crate::{
    bounds::{LEEWAY, NO_LEEWAY, between, earliest, time_bound},
    common::{CommonFacts, FormedRun},
    facts::RunMoment,
    forms::{EventForm, narrower},
};

/// Requirements of a kind that are tried for one run.
const MOST_OF_A_KIND: usize = 8;
/// Of these, about the same.
const MOST_OF_A_TOPIC: usize = 2;
/// The language counts no further in `at most N E`.
const MOST_COUNTED: usize = 1000;

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
/// How many arguments are asked for, whether only a test tells when, and how shortly before.
type NoveltyRank = (usize, bool, Reverse<RunMoment>);

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
    fn novelties(&self) -> Ranked<NoveltyRank> {
        let mut new: BTreeMap<String, (usize, RunMoment)> = BTreeMap::new();
        for event in &self.run.facts.events {
            let forms = std::iter::once(EventForm::any(self.program, event.event));
            for form in forms.chain(narrower(self.program, event)) {
                if !form.is_played && !self.common.known.contains(&form.text) {
                    let narrowness = form.narrowness();
                    new.entry(form.text).or_insert((narrowness, event.moment));
                }
            }
        }
        let mut found = Vec::new();
        for (text, (narrowness, first)) in new {
            self.never(&text, narrowness, first, &mut found);
        }
        found
    }

    fn never(&self, text: &str, narrowness: usize, first: RunMoment, found: &mut Ranked<NoveltyRank>) {
        for (at, opening) in self.common.forms.iter().enumerate() {
            let before = self.run.moments(at).first().filter(|moment| **moment < first);
            let (Some(before), true) = (before, self.common.count(at).1 > 0) else { continue };
            let pattern = format!("never {text} after {}", opening.text);
            let rank = (narrowness + opening.narrowness(), opening.is_stimulus, Reverse(*before));
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
        let high = between(common.least_of_most, own.1).filter(|high| *high > own.1);
        let high = self.reached(signal, after, (">=", common.high, high), |value, high| value >= high);
        let low = between(common.most_of_least, own.0).filter(|low| *low < own.0);
        let low = self.reached(signal, after, ("<=", common.low, low), |value, low| value <= low);
        found.extend(high.into_iter().chain(low));
        found
    }

    /// `known` is a bound that all runs of the original meet, with the latest time at which they do; `closer` another one, if the run does not come so
    /// far.
    fn reached(
        &self,
        signal: SignalId,
        after: Option<usize>,
        (comparison, known, closer): (&str, (f64, Nanos), Option<f64>),
        is_met: impl Fn(f64, f64) -> bool + Copy,
    ) -> Option<String> {
        let other = closer.filter(|bound| *bound != known.0);
        let (bound, latest) = match other {
            Some(bound) => (bound, self.common.longest_until(signal, after, |value| is_met(value, bound))?),
            None => known,
        };
        let latest = time_bound(latest, LEEWAY);
        let own = self.run.time_until(signal, after, |value| is_met(value, bound));
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
