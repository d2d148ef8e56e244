//! What an actor may say and hear: the events and signals of the scenario by their names, compared with what a program wrote.

use std::collections::BTreeMap;

use hrdsl_ir::{
    ActorId, Event, EventId, Nanos, Parameter, Program, Type, Value,
    world::{Signal, SignalId},
};

use super::{
    mailbox::HeardEvent,
    seam::{SystemAnswer, SystemArrival},
};
use crate::{argument::SystemArgument, player::is_perceived, stage::WorldStage};

/// The scenario as an actor knows it.
#[derive(Clone, Copy)]
pub(super) struct ActorVocabulary<'p> {
    pub program: &'p Program,
    pub actor: ActorId,
}

impl ActorVocabulary<'_> {
    pub fn read(&self, name: &str, stage: Option<&mut WorldStage<'_>>) -> SystemAnswer {
        let readable = |s: &&Signal| s.to.contains(&self.actor);
        let found = self.program.signals.iter().zip(0u16..).find(|(s, _)| s.name == name && readable(s));
        match (found, stage) {
            (Some((_, index)), Some(stage)) => SystemAnswer::Value(stage.reading(SignalId(index))),
            (Some(_), None) => refuse("there is no world to read signals from", None),
            (None, _) => {
                let known = self.program.signals.iter().filter(readable).map(|s| s.name.as_str());
                refuse(format!("no signal `{name}` that this actor can read"), list("signals", known))
            }
        }
    }

    /// The ids of events that the program can hear.
    pub fn audible(&self, names: &[String]) -> Result<Vec<EventId>, SystemAnswer> {
        names.iter().map(|name| self.audible_event(name)).collect()
    }

    fn audible_event(&self, name: &str) -> Result<EventId, SystemAnswer> {
        match self.program.event_named(name) {
            Some(id) if self.hears(id) => Ok(id),
            Some(_) | None => {
                let ids = (0u16..).map(EventId).take(self.program.events.len());
                let known = ids.filter(|id| self.hears(*id)).map(|id| self.program.event(id).name.as_str());
                Err(refuse(format!("no event `{name}` that this actor can hear"), list("events", known)))
            }
        }
    }

    /// The event and its arguments in order, if the program may make it.
    pub fn emission(
        &self,
        name: &str,
        args: &BTreeMap<String, SystemArgument>,
    ) -> Result<(EventId, Vec<Value>), SystemAnswer> {
        let own = |e: &&Event| e.from == self.actor && !e.is_stimulus();
        let id = self.program.event_named(name).filter(|id| own(&self.program.event(*id)));
        let Some(id) = id else {
            let known = self.program.events.iter().filter(own).map(|e| e.name.as_str());
            return Err(refuse(format!("no event `{name}` that this actor makes"), list("events", known)));
        };
        let params = &self.program.event(id).params;
        if let Some(extra) = args.keys().find(|k| params.iter().all(|p| p.name != **k)) {
            let known = params.iter().map(|p| p.name.as_str());
            return Err(refuse(format!("`{name}` has no argument `{extra}`"), list("arguments", known)));
        }
        let values = params.iter().map(|p| argument(name, p, args.get(&p.name))).collect::<Result<_, _>>()?;
        Ok((id, values))
    }

    pub fn event_answer(&self, heard: HeardEvent) -> SystemAnswer {
        let (name, args, time) = self.told(heard);
        SystemAnswer::Event { name, args, time }
    }

    pub fn event_arrival(&self, heard: HeardEvent) -> SystemArrival {
        let (name, args, time) = self.told(heard);
        SystemArrival::Event { name, args, time }
    }

    fn told(&self, heard: HeardEvent) -> (String, BTreeMap<String, Value>, Nanos) {
        let event = self.program.event(heard.event);
        let args = event.params.iter().map(|p| p.name.clone()).zip(heard.args).collect();
        (event.name.clone(), args, heard.time)
    }

    /// Whether the actor hears the event from somebody else.
    pub fn hears(&self, id: EventId) -> bool {
        is_perceived(self.program, self.actor, id) && self.program.event(id).from != self.actor
    }
}

pub(super) fn refuse(error: impl Into<String>, help: Option<String>) -> SystemAnswer {
    SystemAnswer::Refused { error: error.into(), help }
}

fn list<'a>(what: &str, names: impl Iterator<Item = &'a str>) -> Option<String> {
    let names: Vec<&str> = names.collect();
    (!names.is_empty()).then(|| format!("{what} it can use: {}", names.join(", ")))
}

fn argument(event: &str, param: &Parameter, given: Option<&SystemArgument>) -> Result<Value, SystemAnswer> {
    let Some(given) = given else {
        return Err(refuse(format!("`{event}` needs the argument `{}`", param.name), None));
    };
    let value = match (param.ty, given) {
        (Type::Float(_), SystemArgument::Scalar(Value::Int(n))) => Some(Value::Float(*n as f64)),
        (Type::Enum(e), SystemArgument::Text(name)) => e.symbol(name).map(Value::Symbol),
        (
            Type::Bool | Type::Int { .. } | Type::Float(_) | Type::Enum(_) | Type::Text | Type::List(_),
            SystemArgument::Scalar(value),
        ) => Some(*value),
        (
            Type::Bool | Type::Int { .. } | Type::Float(_) | Type::Enum(_) | Type::Text | Type::List(_),
            SystemArgument::Text(_) | SystemArgument::Numbers(_),
        ) => None,
    };
    value.filter(|v| param.ty.admits(*v)).ok_or_else(|| {
        let ty = match param.ty {
            Type::Bool => "a bool".to_owned(),
            Type::Int { lo, hi } => format!("an integer of {lo}..{hi}"),
            Type::Float(_) => "a number".to_owned(),
            Type::Enum(e) => format!("the name of a value of `{e}` ({})", e.listed()),
            // The checker lets no event have these.
            Type::Text => "a string".to_owned(),
            Type::List(_) => "a list".to_owned(),
        };
        refuse(format!("`{event}`: `{}` is {given}, but must be {ty}", param.name), None)
    })
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::{Enumeration, Symbol, Unit};

    use super::*;

    fn given(ty: Type, arg: SystemArgument) -> Result<Value, String> {
        let param = Parameter { name: "p".into(), ty };
        argument("e", &param, Some(&arg)).map_err(|answer| match answer {
            SystemAnswer::Refused { error, .. } => error,
            other => panic!("{other:?}"),
        })
    }

    fn text(text: &str) -> SystemArgument {
        SystemArgument::Text(text.into())
    }

    fn scalar(value: Value) -> SystemArgument {
        SystemArgument::Scalar(value)
    }

    #[test]
    fn a_symbol_is_given_by_its_name() {
        let pace = Enumeration::intern("Pace", &["slow", "fast"]);
        let ty = Type::Enum(pace);
        assert_eq!(given(ty, text("fast")), Ok(Value::Symbol(Symbol::intern("fast"))));
        let numbers = SystemArgument::Numbers(vec![1.5]);
        let wrong = [text("quick"), text(""), scalar(Value::Int(1)), scalar(Value::Bool(true)), numbers];
        for (wrong, shown) in wrong.into_iter().zip(["\"quick\"", "\"\"", "1", "true", "[1.5]"]) {
            let must = "the name of a value of `Pace` (`slow`, `fast`)";
            assert_eq!(given(ty, wrong), Err(format!("`e`: `p` is {shown}, but must be {must}")));
        }
    }

    #[test]
    fn text_is_no_other_value() {
        let (int, float) = (Type::Int { lo: 0, hi: 4 }, Type::Float(Unit::Metre));
        assert_eq!(given(Type::Bool, scalar(Value::Bool(true))), Ok(Value::Bool(true)));
        assert_eq!(given(int, scalar(Value::Int(4))), Ok(Value::Int(4)));
        assert_eq!(given(float, scalar(Value::Int(4))), Ok(Value::Float(4.0)));
        let error = |ty, arg| given(ty, arg).unwrap_err();
        assert_eq!(error(Type::Bool, text("true")), "`e`: `p` is \"true\", but must be a bool");
        assert_eq!(error(int, text("1")), "`e`: `p` is \"1\", but must be an integer of 0..4");
        assert_eq!(error(int, scalar(Value::Int(5))), "`e`: `p` is 5, but must be an integer of 0..4");
        assert_eq!(error(float, text("nan")), "`e`: `p` is \"nan\", but must be a number");
        assert_eq!(
            error(float, SystemArgument::Numbers(vec![0.5])),
            "`e`: `p` is [0.5], but must be a number"
        );
    }
}
