//! Actors, events, stimuli, and the system under test.

use hrdsl_ir::{
    Actor, ArgPattern, Event, EventPattern,
    event::{Sample, Stimulus, StimulusStep},
    system::System,
    value::nanos,
};
use hrdsl_model as model;

use super::{expr, world};

pub(crate) fn actors(scenario: &model::Scenario) -> Vec<Actor> {
    let actor = |a: &model::Actor| Actor { name: a.name.clone(), role: a.role, origin: a.span };
    scenario.actors.iter().map(actor).collect()
}

pub(crate) fn events(scenario: &model::Scenario) -> Vec<Event> {
    let event = |e: &model::Event| Event {
        name: e.name.clone(),
        params: expr::params(&e.params),
        from: e.from,
        to: e.to.clone(),
        stimulus: e.stimulus.as_ref().map(stimulus),
        origin: e.span,
    };
    scenario.events.iter().map(event).collect()
}

fn stimulus(s: &model::Stimulus) -> Stimulus {
    let sample = |s: &model::Sample| Sample {
        name: s.name.clone(),
        ty: expr::ty(s.ty),
        lo: expr::local(&s.lo),
        hi: expr::local(&s.hi),
    };
    Stimulus { samples: s.samples.iter().map(sample).collect(), steps: steps(&s.steps) }
}

fn steps(steps_: &[model::StimulusStep]) -> Vec<StimulusStep> {
    let step = |s: &model::StimulusStep| match s {
        model::StimulusStep::Emit { event, args } => {
            StimulusStep::Emit { event: *event, args: expr::locals(args) }
        }
        model::StimulusStep::Hold(time) => StimulusStep::Hold { seconds: expr::local(time) },
        model::StimulusStep::Act(action) => StimulusStep::Act(world::action(action)),
        model::StimulusStep::If { condition, then, otherwise } => StimulusStep::If {
            condition: expr::local(condition),
            then: steps(then),
            otherwise: steps(otherwise),
        },
    };
    steps_.iter().map(step).collect()
}

pub(crate) fn pattern(p: &model::EventPattern) -> EventPattern {
    let arg = |a: &Option<model::Value>| match a {
        Some(v) => ArgPattern::Is(expr::value(*v)),
        None => ArgPattern::Any,
    };
    EventPattern { event: p.event, args: p.args.iter().map(arg).collect() }
}

pub(crate) fn patterns(ps: &[model::EventPattern]) -> Vec<EventPattern> {
    ps.iter().map(pattern).collect()
}

pub(crate) fn system(s: &model::System) -> System {
    System {
        actor: s.actor,
        run: words(&s.run),
        coverage: s.coverage.clone(),
        limit: nanos(s.limit),
        budget: nanos(s.budget),
        cpu: s.cpu.map(nanos),
        wall: s.wall.map(nanos),
        memory: s.memory.map(|bytes| bytes as u64),
        output: s.output.map(|bytes| bytes as u64),
        env: s.env.clone(),
        online: s.online,
        origin: s.span,
    }
}

/// Splits a command at white space; quotes, single or double, keep words together.
fn words(command: &str) -> Vec<String> {
    let mut words = Vec::new();
    let mut word: Option<String> = None;
    let mut quote: Option<char> = None;
    for c in command.chars() {
        match quote {
            Some(q) if c == q => quote = None,
            Some(_) => word.get_or_insert_default().push(c),
            None if c == '"' || c == '\'' => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            None if c.is_whitespace() => words.extend(word.take()),
            None => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    words
}

#[cfg(test)]
mod tests {
    #[test]
    fn commands_split_at_white_space_outside_of_quotes() {
        assert_eq!(super::words(" python3  robot.py "), ["python3", "robot.py"]);
        assert_eq!(super::words(r#"sh -c "a b" '' x'y z'"#), ["sh", "-c", "a b", "", "xy z"]);
    }
}
