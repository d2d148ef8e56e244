//! Messages that the scenario makes: the gaps of a template get the values of the moment.

use std::{collections::BTreeMap, fmt::Write as _};

use hrdsl_ir::{
    EventId, EventPattern, Nanos, Value,
    binding::{
        GapRead, GapValue, MessageGap, MessageScalar, MessageStep, MessageTemplate, MiddlewareKind,
        ToldNumbers, place_text,
    },
    device_state::DeviceState,
    value::SECOND,
    world::DeviceId,
};

use crate::{port::MessageText, stage::WorldStage};

/// What clocks of programs show at the beginning of a test, in seconds since 1970: 2025-01-01 00:00:00 UTC.
const EPOCH: i64 = 1_735_689_600;

/// When events last happened, each with its arguments.
#[derive(Default)]
pub(super) struct HeardEvents {
    /// Of each event the last occurrence with each list of arguments, the newest last.
    events: BTreeMap<EventId, Vec<(Vec<Value>, Nanos)>>,
}

impl HeardEvents {
    pub fn add(&mut self, event: EventId, args: &[Value], now: Nanos) {
        let known = self.events.entry(event).or_default();
        known.retain(|(of, _)| of.as_slice() != args);
        known.push((args.to_vec(), now));
    }

    /// The arguments of the last occurrence.
    fn arguments(&self, event: EventId) -> Option<&[Value]> {
        self.events.get(&event)?.last().map(|(args, _)| args.as_slice())
    }

    /// When one of these last happened.
    pub fn last_of(&self, patterns: &[EventPattern]) -> Option<Nanos> {
        let of = |p: &EventPattern| {
            let known = self.events.get(&p.event)?;
            known.iter().filter(|(args, _)| p.matches(p.event, args)).map(|(_, time)| *time).max()
        };
        patterns.iter().filter_map(of).max()
    }
}

/// What the gaps of a message depend on.
pub(super) struct GapContext<'a, 'p> {
    pub kind: MiddlewareKind,
    pub heard: &'a HeardEvents,
    pub now: Nanos,
    /// When that was so which the message tells of a device, if that is not now.
    pub stamp: Option<Nanos>,
    /// Which of the conditions hold on which fields depend.
    pub conditions: &'a [bool],
    pub stage: Option<&'a mut WorldStage<'p>>,
}

impl GapContext<'_, '_> {
    /// The message as JSON.
    ///
    /// # Errors
    /// The field, and the value that it cannot hold.
    pub fn filled(&mut self, template: &MessageTemplate) -> Result<MessageText, String> {
        let mut text = String::new();
        self.stamp = self.stage.as_deref().and_then(|stage| sampled_at(template, stage));
        match self.template(template, &mut text) {
            Ok(()) => Ok(text.into()),
            // The text breaks off where the value would stand.
            Err(why) => Err(format!("`{}`: {why}", place_text(&open_place(&text)))),
        }
    }

    fn template(&mut self, template: &MessageTemplate, text: &mut String) -> Result<(), String> {
        text.push_str(template.text.first().map_or("", String::as_str));
        let pieces = template.text.iter().skip(1);
        for (gap, after) in template.gaps.iter().zip(pieces) {
            self.write(gap, text)?;
            text.push_str(after);
        }
        Ok(())
    }

    fn write(&mut self, gap: &MessageGap, text: &mut String) -> Result<(), String> {
        let value = match &gap.value {
            GapValue::Now => {
                self.time(self.stamp.unwrap_or(self.now), text);
                return Ok(());
            }
            GapValue::Held { events, time } => {
                let holds = self.heard.last_of(events).is_some_and(|since| {
                    if *time == 0 { since == self.now } else { self.now < since.saturating_add(*time) }
                });
                Value::Bool(holds)
            }
            GapValue::Value { value, reads } => {
                let values: Vec<Value> = reads.iter().map(|read| self.read(read)).collect();
                value.eval(&|i| values.get(usize::from(i)).copied()).map_err(|e| e.to_string())?
            }
            GapValue::Told { device, what, numbers } => return self.told(*device, *what, *numbers, text),
            GapValue::Fixed(json) => {
                text.push_str(json);
                return Ok(());
            }
            GapValue::Whole(whole) => return self.template(whole, text),
            GapValue::Chosen { cases, otherwise } => {
                let holds = |at: u16| self.conditions.get(usize::from(at)).copied().unwrap_or(false);
                let chosen = cases.iter().find(|case| case.condition.is_none_or(holds));
                return match chosen {
                    Some(case) => self.write(&case.gap, text),
                    None => {
                        text.push_str(otherwise);
                        Ok(())
                    }
                };
            }
        };
        scalar(value, gap.scalar, text)
    }

    /// What a device tells of itself at this moment.
    fn told(
        &self,
        device: DeviceId,
        what: DeviceState,
        numbers: ToldNumbers,
        text: &mut String,
    ) -> Result<(), String> {
        let all = self.stage.as_deref().and_then(|stage| stage.told(device, what));
        let all =
            all.ok_or_else(|| format!("the world does not tell the `{}` of this device", what.name()))?;
        match numbers {
            ToldNumbers::All => {
                text.push('[');
                for (at, number) in all.iter().enumerate() {
                    text.push_str(if at > 0 { "," } else { "" });
                    float(*number, text);
                }
                text.push(']');
            }
            ToldNumbers::One(at) => float(all.get(usize::from(at)).copied().unwrap_or(f64::NAN), text),
        }
        Ok(())
    }

    fn read(&mut self, read: &GapRead) -> Value {
        match read {
            GapRead::Signal(signal) => {
                self.stage.as_deref_mut().map_or(Value::Float(f64::NAN), |stage| stage.reading(*signal))
            }
            GapRead::Argument { event, param, initial } => {
                let args = self.heard.arguments(*event);
                args.and_then(|args| args.get(usize::from(*param))).copied().unwrap_or(*initial)
            }
        }
    }

    fn time(&self, time: Nanos, text: &mut String) {
        // A sample may have been taken before the test began.
        let (seconds, nanos) = (EPOCH + time.div_euclid(SECOND), time.rem_euclid(SECOND));
        let (first, second) = match self.kind {
            MiddlewareKind::Ros1 => ("secs", "nsecs"),
            MiddlewareKind::Ros2 => ("sec", "nanosec"),
        };
        let _ = write!(text, "{{\"{first}\":{seconds},\"{second}\":{nanos}}}");
    }
}

/// When that was so which a message tells of a device.
fn sampled_at(template: &MessageTemplate, stage: &WorldStage<'_>) -> Option<Nanos> {
    let gaps = if stage.has_sensors() { template.leaves() } else { Vec::new() };
    gaps.into_iter().filter_map(GapValue::teller).find_map(|device| stage.sampled_at(device))
}

/// Where the value stands that comes next in a JSON text which breaks off there.
fn open_place(text: &str) -> Vec<MessageStep> {
    let mut place = Vec::new();
    let mut name = String::new();
    let mut chars = text.chars();
    while let Some(c) = chars.next() {
        match (c, place.last_mut()) {
            ('"', _) => {
                name.clear();
                while let Some(c) = chars.next().filter(|c| *c != '"') {
                    name.push(c);
                    if c == '\\' {
                        name.extend(chars.next());
                    }
                }
            }
            ('{', _) => place.push(MessageStep::Field(String::new())),
            ('[', _) => place.push(MessageStep::Element(0)),
            ('}' | ']', _) => drop(place.pop()),
            (':', Some(MessageStep::Field(field))) => *field = std::mem::take(&mut name),
            (',', Some(MessageStep::Element(at))) => *at += 1,
            _ => {}
        }
    }
    place
}

/// A value as its field holds it.
fn scalar(value: Value, field: MessageScalar, text: &mut String) -> Result<(), String> {
    match (field, value) {
        (MessageScalar::Bool, Value::Bool(b)) => text.push_str(if b { "true" } else { "false" }),
        (MessageScalar::Int { .. }, Value::Bool(b)) => text.push(if b { '1' } else { '0' }),
        (MessageScalar::Int { lo, hi }, Value::Int(n)) if (lo..=hi).contains(&n) => {
            let _ = write!(text, "{n}");
        }
        (MessageScalar::Float, Value::Int(n)) => {
            let _ = write!(text, "{n}.0");
        }
        (MessageScalar::Float, Value::Float(x)) => float(x, text),
        (MessageScalar::Text, Value::Symbol(symbol)) => quoted(symbol.name(), text),
        (MessageScalar::Text, Value::Text(words)) => quoted(words.as_str(), text),
        (MessageScalar::Heading, Value::Float(angle)) => heading(angle, text),
        (MessageScalar::Int { lo, hi }, value) => {
            return Err(format!("a field of {lo}..{hi} cannot hold {value}"));
        }
        (
            MessageScalar::Bool
            | MessageScalar::Float
            | MessageScalar::Text
            | MessageScalar::Time
            | MessageScalar::Heading,
            value,
        ) => return Err(format!("a field cannot hold {value}")),
    }
    Ok(())
}

/// A turn about the vertical, to the left.
fn heading(angle: f64, text: &mut String) {
    text.push_str("{\"x\":0.0,\"y\":0.0,\"z\":");
    float(libm::sin(angle / 2.0), text);
    text.push_str(",\"w\":");
    float(libm::cos(angle / 2.0), text);
    text.push('}');
}

/// What JSON has no number for is text.
fn float(x: f64, text: &mut String) {
    if x.is_finite() {
        let _ = write!(text, "{x:?}");
    } else {
        text.push_str(if x.is_nan() {
            "\"nan\""
        } else if x > 0.0 {
            "\"inf\""
        } else {
            "\"-inf\""
        });
    }
}

fn quoted(words: &str, text: &mut String) {
    // INVARIANT: text has a JSON form.
    text.push_str(&serde_json::to_string(words).unwrap_or_default());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_of_what_comes_next_is_read_from_the_text_before() {
        for (text, place) in [
            (r#"{"data":"#, "data"),
            (r#"{"a":{"b":[1,{"c":2},"x:,{\""],"d":"#, "a.d"),
            (r#"{"m":[[1,2],[3,"#, "m[1][1]"),
            (r#"{"name":"a","points":[{"x":1,"y":"#, "points[0].y"),
        ] {
            assert_eq!(place_text(&open_place(text)), place, "{text}");
        }
    }
}
