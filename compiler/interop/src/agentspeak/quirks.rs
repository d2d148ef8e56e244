//! What is well formed and cannot be meant, or means something else in a scenario than in Jason.

use hrdsl_source::Span;
use indexmap::{IndexMap, IndexSet};

use super::{
    ast::{Adding, ItemKind, Key, Plan, Program, TermKind, TriggerKind},
    survey::{Mention, Survey, What},
    system::{Entry, System},
    term::literal,
};
use crate::exchange::note::Severity;

/// A finding: its place, how much it matters, what is so, and what to do.
pub type Quirk = (Span, Severity, String, Option<String>);

/// The findings of a system.
pub fn quirks(system: &System, surveys: &[Survey]) -> Vec<Quirk> {
    let mut all = Vec::new();
    for agent in &system.agents {
        let look = Look::new(system, surveys, agent);
        look.unknown_beliefs(&mut all);
        look.unwanted_goals(&mut all);
        look.changes(&mut all);
        look.many_facts(&mut all);
    }
    for program in &system.programs {
        shadowed(system, program, &mut all);
        several_goals(program, &mut all);
    }
    all
}

/// What one agent does and gets.
struct Look<'a> {
    agent: &'a Entry,
    survey: &'a Survey,
    /// Beliefs that it adds itself, that others tell it, both by name and sign.
    own: IndexSet<(Key, bool)>,
    told: IndexSet<(Key, bool)>,
    goals: IndexSet<Key>,
}

impl<'a> Look<'a> {
    fn new(system: &'a System, surveys: &'a [Survey], agent: &'a Entry) -> Self {
        let survey = &surveys[agent.program];
        let adds =
            |m: &&Mention| matches!(m.what, What::Initial | What::Rule | What::Added(_) | What::Replaced);
        let named = |m: &Mention| (m.key.clone(), m.negated);
        let mut own: IndexSet<_> = survey.beliefs.iter().filter(adds).map(named).collect();
        own.extend(agent.beliefs.iter().map(|b| (b.key(), b.negated)));
        let mut told = IndexSet::new();
        let mut goals: IndexSet<Key> = agent.goals.iter().map(super::ast::Literal::key).collect();
        goals.extend(survey.goals.iter().filter(|m| m.what == What::Adopted).map(|m| m.key.clone()));
        for other in &system.agents {
            let sends = &surveys[other.program];
            for m in sends.beliefs.iter().chain(&sends.goals) {
                let What::Sent { to, goal, told: says } = &m.what else { continue };
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

    fn unknown_beliefs(&self, all: &mut Vec<Quirk>) {
        let mut said = IndexSet::new();
        for m in &self.survey.beliefs {
            let asks = matches!(
                m.what,
                What::Tested(_) | What::Waited | What::Trigger(TriggerKind::Added | TriggerKind::Removed)
            );
            let name = (m.key.clone(), m.negated);
            let answered = self
                .survey
                .beliefs
                .iter()
                .any(|o| o.key == m.key && o.what == What::Trigger(TriggerKind::Test));
            if !asks
                || answered
                || self.own.contains(&name)
                || self.told.contains(&name)
                || !said.insert(name)
            {
                continue;
            }
            let (functor, args) = &m.key;
            let waits = if m.what == What::Waited {
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
                Severity::Warning,
                format!("{waits}nobody adds `{sign}{functor}` to `{}`: a percept of the environment, or misspelt{near}", self.agent.name),
                Some(format!("declare `belief {functor}{places} on EVENT`, if an event tells the agent")),
            ));
        }
    }

    fn unwanted_goals(&self, all: &mut Vec<Quirk>) {
        let planned = self.survey.goals.iter().filter(|m| m.what == What::Trigger(TriggerKind::Achieve));
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
            all.push((m.span, Severity::Warning, message, help));
        }
    }

    /// Steps that change beliefs and do it otherwise.
    #[expect(clippy::too_many_lines, reason = "a flat match")]
    fn changes(&self, all: &mut Vec<Quirk>) {
        let count = |m: &Mention, what: &What| {
            self.survey
                .beliefs
                .iter()
                .filter(|o| o.key == m.key && o.negated == m.negated && o.what == *what)
                .count()
        };
        let mut said = IndexSet::new();
        for m in &self.survey.beliefs {
            let name = (m.key.clone(), m.negated);
            let functor = &m.key.0;
            let handled = count(m, &What::Trigger(TriggerKind::Added)) > 0;
            match &m.what {
                What::Removed(false) if !self.own.contains(&name) => {
                    let who = if self.told.contains(&name) {
                        "is told by others"
                    } else {
                        "comes from the environment"
                    };
                    all.push((
                        m.span,
                        Severity::Warning,
                        format!("`-{functor}` takes away what the agent believes itself; `{functor}` {who}, and stays"),
                        Some(format!("write `-{functor}(…)[source(_)]`")),
                    ));
                }
                What::Replaced
                    if count(m, &What::Initial) > 1
                        || count(m, &What::Added(Adding::Plain)) > 0
                        || self.told.contains(&name) =>
                {
                    let message = format!(
                        "`{functor}` may have several facts: in Jason `-+{functor}` takes away one of them, in hrdsl all"
                    );
                    all.push((m.span, Severity::Warning, message, None));
                }
                What::Added(Adding::NewFocus) => {
                    let message = format!(
                        "`++{functor}` becomes `+{functor}`: in hrdsl its event has an intention of its own"
                    );
                    all.push((m.span, Severity::Info, message, None));
                }
                What::Added(Adding::First) => {
                    let message = format!(
                        "`+<{functor}` becomes `+{functor}`: in hrdsl the youngest fact is asked last"
                    );
                    all.push((m.span, Severity::Warning, message, None));
                }
                What::Added(Adding::Plain | Adding::Last) | What::Replaced
                    if handled && said.insert(name.clone()) =>
                {
                    let message = format!(
                        "in hrdsl the plan for `+{functor}` has an intention of its own: the step after this one does not wait for it"
                    );
                    all.push((m.span, Severity::Info, message, None));
                }
                What::Initial
                | What::Rule
                | What::Added(_)
                | What::Replaced
                | What::Removed(_)
                | What::Tested(_)
                | What::Waited
                | What::Trigger(_)
                | What::Adopted
                | What::Sent { .. } => {}
            }
        }
    }

    /// Facts are asked in another order.
    fn many_facts(&self, all: &mut Vec<Quirk>) {
        let mut said = IndexSet::new();
        for m in self.survey.beliefs.iter().filter(|m| m.what == What::Tested(true) && m.key.1 > 0) {
            let same = |o: &&Mention| o.key == m.key && o.negated == m.negated;
            let facts = self.survey.beliefs.iter().filter(same);
            let many = facts.clone().filter(|o| o.what == What::Initial).count() > 1
                || facts.clone().any(|o| matches!(o.what, What::Added(_)))
                || self.told.contains(&(m.key.clone(), m.negated));
            if many && said.insert(m.key.clone()) {
                let message = format!(
                    "if there are several facts of `{}`, Jason takes the newest, hrdsl the oldest",
                    m.key.0
                );
                all.push((m.span, Severity::Info, message, None));
            }
        }
    }
}

/// A plan after one that always fits.
fn shadowed(system: &System, program: &Program, all: &mut Vec<Quirk>) {
    let mut first: IndexMap<(TriggerKind, Key, bool), Span> = IndexMap::new();
    for item in &program.items {
        let ItemKind::Plan(plan) = &item.kind else { continue };
        let Ok(of) = literal(&plan.trigger.of) else { continue };
        let key = (plan.trigger.kind, of.key(), of.negated);
        if let Some(before) = first.get(&key) {
            let line = system.files.position(*before).line;
            let message = format!(
                "this plan is never selected: the one in line {line} has the same trigger, and always fits"
            );
            all.push((item.span, Severity::Warning, message, None));
        } else if always(plan) {
            first.insert(key, item.span);
        }
    }
}

fn always(plan: &Plan) -> bool {
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

fn several_goals(program: &Program, all: &mut Vec<Quirk>) {
    let goals: Vec<Span> =
        program.items.iter().filter(|i| matches!(i.kind, ItemKind::Goal(_))).map(|i| i.span).collect();
    if let [_, second, ..] = goals.as_slice() {
        let message = "several initial goals: hrdsl adopts them in this order, after all events of initial beliefs, and their plans take turns step by step";
        all.push((*second, Severity::Info, message.to_owned(), None));
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
