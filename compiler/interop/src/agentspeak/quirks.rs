//! What is well formed and cannot be meant, or means something else in a scenario than in Jason.

use hrdsl_source::Span;
use indexmap::{IndexMap, IndexSet};

use super::{
    ast::{
        AgentSpeakItemKind, AgentSpeakPlan, AgentSpeakProgram, AgentSpeakTriggerKind, BeliefAddition,
        PredicateIndicator, TermKind,
    },
    survey::{OccurrenceKind, PredicateOccurrence, PredicateSurvey, survey},
    system::{AgentSpeakAgent, AgentSpeakSystem},
    term::literal,
};
use crate::exchange::note::NoteSeverity;

/// A finding: its place, how much it matters, what is so, and what to do.
pub type AgentSpeakQuirk = (Span, NoteSeverity, String, Option<String>);

/// The findings of a system.
pub fn quirks(system: &AgentSpeakSystem, surveys: &[PredicateSurvey]) -> Vec<AgentSpeakQuirk> {
    let mut all = Vec::new();
    for agent in &system.agents {
        let look = AgentQuirkCheck::new(system, surveys, agent);
        look.unknown_beliefs(&mut all);
        look.unwanted_goals(&mut all);
        look.changes(&mut all);
    }
    for program in &system.programs {
        shadowed(system, program, &mut all);
        several_goals(program, &mut all);
        namesakes(program, &mut all);
    }
    all
}

/// What one agent does and gets.
struct AgentQuirkCheck<'a> {
    agent: &'a AgentSpeakAgent,
    survey: &'a PredicateSurvey,
    /// Beliefs that it adds itself, that others tell it, both by name and sign.
    own: IndexSet<(PredicateIndicator, bool)>,
    told: IndexSet<(PredicateIndicator, bool)>,
    goals: IndexSet<PredicateIndicator>,
}

impl<'a> AgentQuirkCheck<'a> {
    fn new(system: &'a AgentSpeakSystem, surveys: &'a [PredicateSurvey], agent: &'a AgentSpeakAgent) -> Self {
        let survey = &surveys[agent.program];
        let adds = |m: &&PredicateOccurrence| {
            matches!(
                m.what,
                OccurrenceKind::Initial
                    | OccurrenceKind::Rule
                    | OccurrenceKind::Added(_)
                    | OccurrenceKind::Replaced
            )
        };
        let named = |m: &PredicateOccurrence| (m.key.clone(), m.negated);
        let mut own: IndexSet<_> = survey.beliefs.iter().filter(adds).map(named).collect();
        own.extend(agent.beliefs.iter().map(|b| (b.key(), b.negated)));
        let mut told = IndexSet::new();
        let mut goals: IndexSet<PredicateIndicator> =
            agent.goals.iter().map(super::ast::AgentSpeakLiteral::key).collect();
        goals
            .extend(survey.goals.iter().filter(|m| m.what == OccurrenceKind::Adopted).map(|m| m.key.clone()));
        for other in &system.agents {
            let sends = &surveys[other.program];
            for m in sends.beliefs.iter().chain(&sends.goals) {
                let OccurrenceKind::Sent { to, goal, told: says } = &m.what else { continue };
                let arrives =
                    to.as_ref().map_or(other.name != agent.name, |t| *t == agent.name || t == "self");
                if *goal && arrives {
                    goals.insert(m.key.clone());
                } else if !goal && ((*says && arrives) || (!says && other.name == agent.name)) {
                    told.insert(named(m));
                }
            }
        }
        Self { agent, survey, own, told, goals }
    }

    fn unknown_beliefs(&self, all: &mut Vec<AgentSpeakQuirk>) {
        let mut said = IndexSet::new();
        for m in &self.survey.beliefs {
            let asks = matches!(
                m.what,
                OccurrenceKind::Tested(_)
                    | OccurrenceKind::Waited
                    | OccurrenceKind::Trigger(AgentSpeakTriggerKind::Added | AgentSpeakTriggerKind::Removed)
            );
            let name = (m.key.clone(), m.negated);
            let answered =
                self.survey.beliefs.iter().any(|o| {
                    o.key == m.key && o.what == OccurrenceKind::Trigger(AgentSpeakTriggerKind::Test)
                });
            if !asks
                || answered
                || self.own.contains(&name)
                || self.told.contains(&name)
                || !said.insert(name)
            {
                continue;
            }
            let (functor, args) = &m.key;
            let waits = if m.what == OccurrenceKind::Waited {
                "this waits for a belief that nobody adds or sends: "
            } else {
                ""
            };
            let sign = if m.negated { "~" } else { "" };
            let known = self.own.iter().chain(&self.told).map(|(k, _)| k.0.as_str());
            let near = nearest(functor, known).map(|n| format!("; did you mean `{n}`?")).unwrap_or_default();
            let places = if *args > 0 { "(…)" } else { "" };
            all.push((
                m.span,
                NoteSeverity::Warning,
                format!("{waits}nobody adds `{sign}{functor}` to `{}`: a percept of the environment, or misspelt{near}", self.agent.name),
                Some(format!("declare `belief {functor}{places} on EVENT`, if an event tells the agent")),
            ));
        }
    }

    fn unwanted_goals(&self, all: &mut Vec<AgentSpeakQuirk>) {
        let planned = self
            .survey
            .goals
            .iter()
            .filter(|m| m.what == OccurrenceKind::Trigger(AgentSpeakTriggerKind::Achieve));
        for m in planned.filter(|m| !self.goals.contains(&m.key)) {
            let near = nearest(&m.key.0, self.goals.iter().map(|k| k.0.as_str()));
            let other = self.goals.iter().find(|k| k.0 == m.key.0);
            let help = other.map_or_else(
                || near.map(|n| format!("did you mean `{n}`?")),
                |k| Some(format!("`{}` is adopted with {} arguments", k.0, k.1)),
            );
            let message = format!(
                "nobody adopts the goal `{}` of `{}`, so this plan never runs",
                m.key.0, self.agent.name
            );
            all.push((m.span, NoteSeverity::Warning, message, help));
        }
    }

    /// Whether all that the agent ever does with a belief is to remove it.
    fn is_only_removed(&self, of: &PredicateOccurrence) -> bool {
        let name = (of.key.clone(), of.negated);
        let same = |o: &&PredicateOccurrence| o.key == of.key && o.negated == of.negated;
        let only =
            self.survey.beliefs.iter().filter(same).all(|o| matches!(o.what, OccurrenceKind::Removed(_)));
        only && !self.own.contains(&name) && !self.told.contains(&name)
    }

    /// Steps that change beliefs and do it otherwise.
    fn changes(&self, all: &mut Vec<AgentSpeakQuirk>) {
        for m in &self.survey.beliefs {
            let name = (m.key.clone(), m.negated);
            let functor = &m.key.0;
            match &m.what {
                OccurrenceKind::Removed(_) if self.is_only_removed(m) => {
                    let known = self.own.iter().chain(&self.told).map(|(k, _)| k.0.as_str());
                    let near = nearest(functor, known);
                    let help = near.map(|n| format!("did you mean `{n}`?"));
                    let message = format!(
                        "`{functor}` is only ever removed: nobody adds it to `{}`, and nothing asks for it",
                        self.agent.name
                    );
                    all.push((m.span, NoteSeverity::Warning, message, help));
                }
                OccurrenceKind::Removed(false) if !self.own.contains(&name) => {
                    let who = if self.told.contains(&name) {
                        "is told by others"
                    } else {
                        "comes from the environment"
                    };
                    all.push((
                        m.span,
                        NoteSeverity::Warning,
                        format!("`-{functor}` takes away what the agent believes itself; `{functor}` {who}, and stays"),
                        Some(format!("write `-{functor}(…)[source(_)]`")),
                    ));
                }
                OccurrenceKind::Added(BeliefAddition::NewFocus) => {
                    let message = format!(
                        "`++{functor}` becomes `+{functor}`: its event has no intention of its own, and the next step waits for its plan"
                    );
                    all.push((m.span, NoteSeverity::Warning, message, None));
                }
                OccurrenceKind::Added(BeliefAddition::Last) => {
                    let message =
                        format!("`+>{functor}` becomes `+{functor}`: the newest fact is asked first");
                    all.push((m.span, NoteSeverity::Warning, message, None));
                }
                OccurrenceKind::Initial
                | OccurrenceKind::Rule
                | OccurrenceKind::Added(_)
                | OccurrenceKind::Replaced
                | OccurrenceKind::Removed(_)
                | OccurrenceKind::Tested(_)
                | OccurrenceKind::Waited
                | OccurrenceKind::Trigger(_)
                | OccurrenceKind::Adopted
                | OccurrenceKind::Sent { .. } => {}
            }
        }
    }
}

/// A plan after one that always fits.
fn shadowed(system: &AgentSpeakSystem, program: &AgentSpeakProgram, all: &mut Vec<AgentSpeakQuirk>) {
    let mut first: IndexMap<(AgentSpeakTriggerKind, PredicateIndicator, bool), Span> = IndexMap::new();
    for item in &program.items {
        let AgentSpeakItemKind::Plan(plan) = &item.kind else { continue };
        let Ok(of) = literal(&plan.trigger.of) else { continue };
        let key = (plan.trigger.kind, of.key(), of.negated);
        if let Some(before) = first.get(&key) {
            let line = system.files.position(*before).line;
            let message = format!(
                "this plan is never selected: the one in line {line} has the same trigger, and always fits"
            );
            all.push((item.span, NoteSeverity::Warning, message, None));
        } else if always(plan) {
            first.insert(key, item.span);
        }
    }
}

fn always(plan: &AgentSpeakPlan) -> bool {
    let Ok(of) = literal(&plan.trigger.of) else { return false };
    let mut seen = IndexSet::new();
    let free = of.args.iter().all(|a| match &a.kind {
        TermKind::Any => true,
        TermKind::Var { name, .. } => seen.insert(name.clone()),
        _ => false,
    });
    let open = plan.context.as_ref().is_none_or(|c| matches!(c.kind, TermKind::Bool(true)));
    free && open && of.annotations.is_empty()
}

fn several_goals(program: &AgentSpeakProgram, all: &mut Vec<AgentSpeakQuirk>) {
    let goals: Vec<Span> = program
        .items
        .iter()
        .filter(|i| matches!(i.kind, AgentSpeakItemKind::Goal(_)))
        .map(|i| i.span)
        .collect();
    if let [_, second, ..] = goals.as_slice() {
        let message = "several initial goals: hrdsl adopts them in this order, after all events of initial beliefs, and their plans take turns step by step";
        all.push((*second, NoteSeverity::Info, message.to_owned(), None));
    }
}

/// A plan that tests a belief, and removes one that is called nearly so and that it does not test.
fn namesakes(program: &AgentSpeakProgram, all: &mut Vec<AgentSpeakQuirk>) {
    /// Shorter names are often alike.
    const SHORTEST: usize = 4;
    for item in &program.items {
        if !matches!(item.kind, AgentSpeakItemKind::Plan(_)) {
            continue;
        }
        let survey = survey(&AgentSpeakProgram { items: vec![item.clone()] });
        let named = |is: fn(&OccurrenceKind) -> bool| {
            let found = survey.beliefs.iter().filter(move |m| is(&m.what));
            found.map(|m| (m.key.0.as_str(), m.span)).collect::<Vec<_>>()
        };
        let tested = named(|w| {
            matches!(w, OccurrenceKind::Tested(_) | OccurrenceKind::Trigger(AgentSpeakTriggerKind::Added))
        });
        for (removed, span) in named(|w| matches!(w, OccurrenceKind::Removed(_))) {
            let long = tested.iter().map(|(n, _)| *n).filter(|n| n.len() >= SHORTEST);
            if removed.len() >= SHORTEST
                && tested.iter().all(|(n, _)| *n != removed)
                && let Some(near) = nearest(removed, long)
            {
                let message = format!("this plan tests `{near}` and removes `{removed}`");
                all.push((span, NoteSeverity::Warning, message, Some("are both meant?".to_owned())));
            }
        }
    }
}

/// The name nearest to one, if it is near enough to be meant.
fn nearest<'n>(name: &str, known: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    let most = if name.chars().count() < 5 { 1 } else { 2 };
    let far = known.filter(|k| *k != name).map(|k| (distance(name, k), k)).filter(|(d, _)| *d <= most);
    far.min_by_key(|(d, _)| *d).map(|(_, k)| k)
}

/// How many letters differ (Levenshtein).
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut corner = std::mem::replace(&mut row[0], i + 1);
        for (j, y) in b.iter().enumerate() {
            let changed = corner + usize::from(x != *y);
            corner = row[j + 1];
            row[j + 1] = changed.min(corner + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_names_are_found() {
        assert_eq!((distance("at", "at"), distance("kitten", "sitting")), (0, 3));
        assert_eq!(nearest("batery", ["charge", "battery"].into_iter()), Some("battery"));
        assert_eq!(nearest("on", ["off", "at"].into_iter()), None);
    }
}
