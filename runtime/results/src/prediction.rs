//! Whether a run went as the model of its suite said: the model as an oracle beside the requirements.

use hrdsl_ir::{coverage::BinName, test::TestMethod};
use hrdsl_trace::RunEnd;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An await of a test that came to nothing: nothing that it names happened in its time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct UnmetAwait {
    /// Its place in the test's `steps`, from 0.
    pub step: usize,
    /// Seconds.
    pub since: f64,
    /// When it was given up, or the test ended. Seconds.
    pub until: f64,
}

/// What a run says about the prediction that its test was made with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PredictionOutcome {
    /// What was seen is what was predicted.
    Kept,
    /// Model and code differ. Either may be wrong.
    Left,
    /// The run broke off.
    Error,
}

/// What the model predicted, held against what was seen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PredictionVerdict {
    pub outcome: PredictionOutcome,
    /// Bins that were predicted, and not hit.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(with = "Vec<String>")]
    pub missed: Vec<BinName>,
    /// Bins that were hit, and not predicted.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(with = "Vec<String>")]
    pub unforeseen: Vec<BinName>,
    /// The first await that came to nothing, where the model went on: there the run left the prediction, at the latest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unmet: Option<UnmetAwait>,
}

/// What is known of a run when it is held against its prediction.
#[derive(Clone, Copy, Debug)]
pub struct PredictedRun<'a> {
    pub method: TestMethod,
    pub ended: RunEnd,
    pub predicted: &'a [BinName],
    pub hit: &'a [BinName],
    /// In the order of the times at which they were given up.
    pub unmet: &'a [UnmetAwait],
}

impl PredictionVerdict {
    /// The verdict on a run; `None` if nothing was predicted: at random, and by hand unless the test names bins. What awaits of a
    /// test written by hand come to is no part of a prediction.
    #[must_use]
    pub fn of(run: PredictedRun<'_>) -> Option<Self> {
        let from_model = match run.method {
            TestMethod::Agents | TestMethod::Search => true,
            TestMethod::Random => return None,
            TestMethod::Hand => false,
        };
        if !from_model && run.predicted.is_empty() {
            return None;
        }
        if run.ended == RunEnd::Error {
            return Some(Self::broken_off());
        }
        let without = |some: &[BinName], others: &[BinName]| -> Vec<BinName> {
            some.iter().filter(|name| !others.contains(name)).cloned().collect()
        };
        let missed = without(run.predicted, run.hit);
        let unforeseen = without(run.hit, run.predicted);
        let unmet = run.unmet.first().filter(|_| from_model).copied();
        let is_kept = missed.is_empty() && unforeseen.is_empty() && unmet.is_none();
        let outcome = if is_kept { PredictionOutcome::Kept } else { PredictionOutcome::Left };
        Some(Self { outcome, missed, unforeseen, unmet })
    }

    /// Of a run that broke off: what it did not do, it might have done.
    #[must_use]
    pub fn broken_off() -> Self {
        Self { outcome: PredictionOutcome::Error, missed: Vec::new(), unforeseen: Vec::new(), unmet: None }
    }

    /// Where and how a run left its prediction, for people: ``awaited `await released within 90 s` in vain from 12.3 s on; missed
    /// bin x``; `steps` are the test's. `None` if it did not.
    #[must_use]
    pub fn departure(&self, steps: &[String]) -> Option<String> {
        match self.outcome {
            PredictionOutcome::Left => {}
            PredictionOutcome::Kept | PredictionOutcome::Error => return None,
        }
        let mut parts = Vec::new();
        if let Some(unmet) = &self.unmet {
            let step = steps.get(unmet.step).map_or("a step", String::as_str);
            parts.push(format!("from {:.2} s on in vain: `{step}`", unmet.since));
        }
        let bins = |what: &str, names: &[BinName]| {
            let plural = if names.len() == 1 { "" } else { "s" };
            let names: Vec<&str> = names.iter().map(BinName::as_str).collect();
            (!names.is_empty()).then(|| format!("{what} bin{plural} {}", names.join("; ")))
        };
        parts.extend(bins("missed", &self.missed));
        parts.extend(bins("unforeseen", &self.unforeseen));
        Some(parts.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bins(names: &[&str]) -> Vec<BinName> {
        names.iter().filter_map(|name| BinName::parse(name)).collect()
    }

    fn verdict(
        method: TestMethod,
        ended: RunEnd,
        hit: &[&str],
        unmet: &[UnmetAwait],
    ) -> Option<PredictionVerdict> {
        let (predicted, hit) = (bins(&["legs.one", "legs.two"]), bins(hit));
        PredictionVerdict::of(PredictedRun { method, ended, predicted: &predicted, hit: &hit, unmet })
    }

    #[test]
    fn a_run_keeps_its_prediction_only_if_it_hits_the_same_bins_and_nothing_is_awaited_in_vain() {
        let vain = [UnmetAwait { step: 1, since: 2.0, until: 92.0 }];
        let of = |hit: &[&str], unmet: &[UnmetAwait]| {
            verdict(TestMethod::Search, RunEnd::Quiescent, hit, unmet).unwrap()
        };
        assert_eq!(of(&["legs.two", "legs.one"], &[]).outcome, PredictionOutcome::Kept);
        let less = of(&["legs.one", "legs.three"], &[]);
        assert_eq!(less.outcome, PredictionOutcome::Left);
        assert_eq!(
            (less.missed.clone(), less.unforeseen.clone()),
            (bins(&["legs.two"]), bins(&["legs.three"]))
        );
        assert_eq!(less.departure(&[]).as_deref(), Some("missed bin legs.two, unforeseen bin legs.three"));
        let late = of(&["legs.one", "legs.two"], &vain);
        assert_eq!(late.outcome, PredictionOutcome::Left);
        let steps = ["ask".to_owned(), "await given within 90 s".to_owned()];
        assert_eq!(
            late.departure(&steps).as_deref(),
            Some("from 2.00 s on in vain: `await given within 90 s`")
        );
    }

    #[test]
    fn who_predicts_nothing_has_no_verdict_and_a_run_that_broke_off_says_nothing() {
        let vain = [UnmetAwait::default()];
        assert_eq!(verdict(TestMethod::Random, RunEnd::Limit, &[], &vain), None);
        let by_hand = verdict(TestMethod::Hand, RunEnd::Limit, &["legs.one", "legs.two"], &vain).unwrap();
        assert_eq!(by_hand.outcome, PredictionOutcome::Kept, "a person may await what must not come");
        let broken = verdict(TestMethod::Agents, RunEnd::Error, &[], &vain).unwrap();
        assert_eq!(broken, PredictionVerdict::broken_off());
        assert_eq!(broken.departure(&[]), None);
    }
}
