//! Requirements in English: what each says, and what each verdict on it means.

use hrdsl_ir::{ArgPattern, EventPattern};
use hrdsl_model::{Scenario, TypedExpr, TypedOccurrence, TypedRequirement, TypedTemporal};
use hrdsl_source::SourceFiles;
use hrdsl_syntax::{CountBound, LastingBound, RequirementPattern, RequirementScope};
use serde::Serialize;

use crate::{
    formula_reading::{FormulaReader, FormulaReading},
    lower::monitor::one_line,
};

/// A requirement, read out. A verdict that it cannot have is none.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RequirementReading {
    pub requirement: String,
    pub title: String,
    #[serde(skip_serializing_if = "String::is_empty")]
    pub doc: String,
    pub text: String,
    pub says: String,
    pub pass: Option<String>,
    pub fail: Option<String>,
    pub vacuous: Option<String>,
    pub inconclusive: Option<String>,
}

/// What a pattern says of the part of a run that its scope is.
struct PatternReading {
    says: String,
    fail: Option<String>,
    vacuous: Option<String>,
    /// What is due when the run ends.
    due: Option<String>,
    /// What has to come before its part ends.
    owes: Option<&'static str>,
}

/// All requirements of a scenario without errors.
#[must_use]
pub fn readings(scenario: &Scenario, files: &SourceFiles) -> Vec<RequirementReading> {
    scenario
        .requirements
        .iter()
        .map(|r| RequirementReader { scenario, files, requirement: r }.read())
        .collect()
}

struct RequirementReader<'a> {
    scenario: &'a Scenario,
    files: &'a SourceFiles,
    requirement: &'a TypedRequirement,
}

impl RequirementReader<'_> {
    fn read(&self) -> RequirementReading {
        let sentence = &self.requirement.pattern;
        if let RequirementPattern::Formula(formula) = &sentence.pattern {
            return self.formula(formula);
        }
        let pattern = self.pattern();
        let (part, ends, counts_if_it_ends) = match &sentence.scope {
            RequirementScope::Whole => ("In the whole run".to_owned(), false, false),
            RequirementScope::Before(e) => {
                (format!("Before the first {}, if one comes", self.any(e)), true, true)
            }
            RequirementScope::After(e) => (format!("From the first {} on", self.any(e)), false, false),
            RequirementScope::Between(a, b) => {
                (format!("From {} to the next {}, if that comes", self.any(a), self.any(b)), true, true)
            }
            RequirementScope::AfterUntil(a, b) => (
                format!("From {} to the next {}, or to the end of the run", self.any(a), self.any(b)),
                true,
                false,
            ),
            RequirementScope::While(c) => (format!("As long as {} holds", self.condition(c)), true, false),
        };
        let owed =
            pattern.owes.filter(|_| ends).map(|what| format!("its part of the run ends before {what}"));
        let mut fail: Vec<String> = pattern.fail.into_iter().chain(owed).collect();
        if counts_if_it_ends && !fail.is_empty() {
            fail.push("each counts once, when its part of the run ends".to_owned());
        }
        let in_doubt = counts_if_it_ends.then(|| {
            "the run ends in a part in which it has been violated, and that has not ended".to_owned()
        });
        let inconclusive: Vec<String> = pattern.due.into_iter().chain(in_doubt).collect();
        let none_of_these = if fail.is_empty() && inconclusive.is_empty() {
            "it is triggered at least once"
        } else {
            "it is triggered at least once, and none of this happens"
        };
        let vacuous = pattern.vacuous;
        let never_passes = matches!(
            &sentence.pattern,
            RequirementPattern::NeverWhile { condition: None, .. } if sentence.scope.is_whole()
        );
        let joined = |all: Vec<String>| (!all.is_empty()).then(|| all.join("; or "));
        RequirementReading {
            requirement: self.requirement.name.clone(),
            title: self.requirement.title.clone(),
            doc: self.requirement.doc.clone(),
            text: one_line(self.files.text(self.requirement.text)),
            says: format!("{part}, {}.", pattern.says),
            pass: (!never_passes).then(|| none_of_these.to_owned()),
            fail: joined(fail).map(|f| f.replace("; or each counts", "; each counts")),
            vacuous,
            inconclusive: joined(inconclusive),
        }
    }

    fn formula(&self, formula: &TypedTemporal) -> RequirementReading {
        let reader = FormulaReader { any: &|list| self.any(list), condition: &|e| self.condition(e) };
        let FormulaReading { says, pass, fail, vacuous, inconclusive } = reader.read(formula);
        RequirementReading {
            requirement: self.requirement.name.clone(),
            title: self.requirement.title.clone(),
            doc: self.requirement.doc.clone(),
            text: one_line(self.files.text(self.requirement.text)),
            says,
            pass: Some(pass),
            fail,
            vacuous,
            inconclusive,
        }
    }

    fn pattern(&self) -> PatternReading {
        match &self.requirement.pattern.pattern {
            RequirementPattern::Causes { trigger, response, not_before, within } => {
                self.causes([trigger, response], *not_before, *within)
            }
            RequirementPattern::Forbids { trigger, forbidden, until } => {
                self.forbids([trigger, forbidden, until])
            }
            RequirementPattern::Precedes { first, then, not_before, within } => {
                self.precedes([first, then], *not_before, *within)
            }
            RequirementPattern::NeverWhile { events, condition: Some(condition) } => {
                let (e, c) = (self.any(events), self.condition(condition));
                PatternReading {
                    says: format!("{e} does not happen while {c}"),
                    fail: Some(format!("{e} comes when {c}")),
                    vacuous: self.without(&e),
                    due: None,
                    owes: None,
                }
            }
            RequirementPattern::NeverWhile { events, condition: None } => self.at_most(events, 0),
            RequirementPattern::Globally(condition) => {
                let c = self.condition(condition);
                PatternReading {
                    says: format!("{c} holds at every moment"),
                    fail: Some(format!("{c} does not hold when it is first measured, or ceases to")),
                    vacuous: Some(format!("nothing that {c} reads is measured{}", self.in_its_part())),
                    due: None,
                    owes: None,
                }
            }
            RequirementPattern::Eventually { events, condition, within } => {
                self.eventually(events, condition.as_ref(), *within)
            }
            RequirementPattern::Counts { events, bound, count } => {
                let n = count.unwrap_or(0);
                match bound {
                    CountBound::AtMost => self.at_most(events, n),
                    CountBound::AtLeast => self.at_least(events, n, false),
                    CountBound::Exactly => self.at_least(events, n, true),
                }
            }
            // It is read by itself.
            RequirementPattern::Formula(_) => {
                PatternReading { says: String::new(), fail: None, vacuous: None, due: None, owes: None }
            }
            RequirementPattern::Lasts { condition, bound, time } => {
                self.lasts(condition, *bound, time.unwrap_or(0.0))
            }
        }
    }

    fn causes(
        &self,
        [trigger, response]: [&[TypedOccurrence]; 2],
        not_before: Option<f64>,
        within: Option<f64>,
    ) -> PatternReading {
        let (t, r) = (self.any(trigger), self.any(response));
        let early = not_before.map(|d| format!("{r} comes less than {d} s after {t}"));
        let late = within.map(|d| format!("no {r} has come {d} s after the first {t} that waits for one"));
        let times =
            [not_before.map(|d| format!(" not before {d} s")), within.map(|d| format!(" within {d} s"))];
        let times = times.into_iter().flatten().collect::<Vec<_>>().join(" and");
        let fail: Vec<String> = early.into_iter().chain(late).collect();
        PatternReading {
            says: format!("each {t} is answered by {r}{times}; one answer is enough for all that wait"),
            fail: (!fail.is_empty()).then(|| fail.join("; or ")),
            vacuous: self.without(&t),
            due: Some(format!("the run ends while {t} waits for its answer")),
            owes: Some("the answer has come"),
        }
    }

    fn forbids(&self, lists: [&[TypedOccurrence]; 3]) -> PatternReading {
        let [t, f, u] = lists.map(|list| self.any(list));
        PatternReading {
            says: format!("{f} does not happen from each {t} to the next {u}, or to the end"),
            fail: Some(format!("{f} comes after {t} and before {u}")),
            vacuous: self.without(&t),
            due: None,
            owes: None,
        }
    }

    fn eventually(
        &self,
        events: &[TypedOccurrence],
        condition: Option<&TypedExpr>,
        within: Option<f64>,
    ) -> PatternReading {
        let what = match condition {
            Some(c) => format!("{} holds", self.condition(c)),
            None => format!("{} happens", self.any(events)),
        };
        let late = within.map(|d| format!(" within {d} s"));
        PatternReading {
            says: format!("{what} at least once{}", late.as_deref().unwrap_or_default()),
            fail: late.map(|late| format!("that has not come about{late} of the beginning")),
            vacuous: self.without_a_part(),
            due: Some("the run ends before that has come about, and before it is too late".to_owned()),
            owes: Some("that has come about"),
        }
    }

    fn precedes(
        &self,
        [first, then]: [&[TypedOccurrence]; 2],
        not_before: Option<f64>,
        within: Option<f64>,
    ) -> PatternReading {
        let (f, t) = (self.any(first), self.any(then));
        let (says, also) = match (not_before, within) {
            (Some(d), _) => (
                format!("{t} comes {d} s after the first {f} at the earliest"),
                format!(", or less than {d} s after the first"),
            ),
            (None, Some(d)) => (
                format!("{t} comes {d} s after the last {f} at the latest"),
                format!(", or more than {d} s after the last"),
            ),
            (None, None) => (format!("no {t} comes before the first {f}"), String::new()),
        };
        PatternReading {
            says,
            fail: Some(format!("{t} comes before any {f}{also}")),
            vacuous: self.without(&t),
            due: None,
            owes: None,
        }
    }

    fn at_most(&self, events: &[TypedOccurrence], n: u32) -> PatternReading {
        let e = self.any(events);
        let says = match n {
            0 => format!("{e} does not happen"),
            1 => format!("{e} happens once at the most"),
            n => format!("{e} happens {n} times at the most"),
        };
        let vacuous = match &self.requirement.pattern.scope {
            RequirementScope::Whole => self.without(&e),
            RequirementScope::Before(_) | RequirementScope::Between(..) => {
                Some("no such part of the run ends".to_owned())
            }
            RequirementScope::After(_) | RequirementScope::AfterUntil(..) | RequirementScope::While(_) => {
                self.without_a_part()
            }
        };
        let fail = if n == 0 { format!("{e} comes") } else { format!("{e} comes once more than that") };
        PatternReading { says, fail: Some(fail), vacuous, due: None, owes: None }
    }

    fn at_least(&self, events: &[TypedOccurrence], n: u32, exactly: bool) -> PatternReading {
        let e = self.any(events);
        let times = if n == 1 { "once".to_owned() } else { format!("{n} times") };
        let how = if exactly {
            format!("{times}, neither more nor less often")
        } else {
            format!("{times} at the least")
        };
        PatternReading {
            says: format!("{e} happens {how}"),
            fail: exactly.then(|| format!("{e} comes once more than that")),
            vacuous: self.without_a_part(),
            due: Some(format!("the run ends before {e} has come so often")),
            owes: Some("that has come so often"),
        }
    }

    fn lasts(&self, condition: &TypedExpr, bound: LastingBound, d: f64) -> PatternReading {
        let c = self.condition(condition);
        let due = Some(format!("the run ends while {c} has held for less than {d} s"));
        match bound {
            LastingBound::AtLeast => PatternReading {
                says: format!("whenever {c} becomes true it holds for {d} s at the least"),
                fail: Some(format!("{c} ceases to hold less than {d} s after it has become true")),
                vacuous: Some(format!("{c} does not become true{}", self.in_its_part())),
                due,
                owes: None,
            },
            LastingBound::AtMost => PatternReading {
                says: format!("{c} holds for {d} s at the most at a time"),
                fail: Some(format!("{c} has held for {d} s, and still does")),
                vacuous: Some(format!("{c} is never true{}", self.in_its_part())),
                due,
                owes: None,
            },
        }
    }

    /// The verdict for want of a trigger.
    fn without(&self, event: &str) -> Option<String> {
        Some(format!("no {event} happens{}", self.in_its_part()))
    }

    /// What begins with its part of the run lacks that alone.
    fn without_a_part(&self) -> Option<String> {
        match &self.requirement.pattern.scope {
            RequirementScope::Whole | RequirementScope::Before(_) => None,
            RequirementScope::After(_)
            | RequirementScope::Between(..)
            | RequirementScope::AfterUntil(..)
            | RequirementScope::While(_) => Some("there is no such part of the run".to_owned()),
        }
    }

    fn in_its_part(&self) -> &'static str {
        if self.requirement.pattern.scope.is_whole() { "" } else { " in such a part of the run" }
    }

    /// `` `a` or `b(true)` ``
    fn any(&self, list: &[TypedOccurrence]) -> String {
        let one = |occurrence: &TypedOccurrence| match occurrence {
            TypedOccurrence::Event(pattern) => format!("`{}`", self.event(pattern)),
            TypedOccurrence::Edge { rising, condition } => {
                let name = if *rising { "rising" } else { "falling" };
                format!("`{name}({})`", one_line(self.files.text(condition.span)))
            }
        };
        list.iter().map(one).collect::<Vec<_>>().join(" or ")
    }

    fn event(&self, pattern: &EventPattern) -> String {
        let name = self.scenario.events.get(usize::from(pattern.event.0)).map_or("", |e| e.name.as_str());
        if pattern.args.iter().all(|a| *a == ArgPattern::Any) {
            return name.to_owned();
        }
        format!("{name}({})", pattern.args.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "))
    }

    fn condition(&self, e: &TypedExpr) -> String {
        format!("`{}`", one_line(self.files.text(e.span)))
    }
}
