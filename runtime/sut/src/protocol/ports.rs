//! Requests of version 2 that carry a message, or a value: read past it, so that it stays the text that it is.

use std::sync::Arc;

use hrdsl_harness::{GoalEnd, MessageText};
use serde::Deserialize;
use serde_json::value::RawValue;

/// A request that carries messages to others, or a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum MessageRequest {
    Publish { port: u64, message: MessageText },
    Call { port: u64, call: u64, message: MessageText },
    Respond { call: u64, answer: Result<MessageText, String> },
    Feedback { call: u64, message: MessageText },
    Finish { call: u64, end: GoalEnd, message: MessageText, text: String },
    SetParameter { name: String, value: MessageText },
}

impl MessageRequest {
    /// Whether it has no reply of its own.
    pub(super) fn is_one_way(&self) -> bool {
        !matches!(self, MessageRequest::SetParameter { .. })
    }
}

#[derive(Deserialize)]
struct PublishLine<'l> {
    port: u64,
    #[serde(borrow)]
    message: &'l RawValue,
}

#[derive(Deserialize)]
struct CallLine<'l> {
    port: u64,
    call: u64,
    #[serde(borrow)]
    message: &'l RawValue,
}

#[derive(Deserialize)]
struct RespondLine<'l> {
    call: u64,
    #[serde(borrow)]
    message: Option<&'l RawValue>,
    error: Option<String>,
}

#[derive(Deserialize)]
struct FeedbackLine<'l> {
    call: u64,
    #[serde(borrow)]
    message: &'l RawValue,
}

#[derive(Deserialize)]
struct FinishLine<'l> {
    call: u64,
    end: WrittenGoalEnd,
    #[serde(borrow)]
    message: &'l RawValue,
    #[serde(default)]
    text: String,
}

#[derive(Deserialize)]
struct SetParameterLine<'l> {
    name: String,
    #[serde(borrow)]
    value: &'l RawValue,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum WrittenGoalEnd {
    Succeeded,
    Aborted,
    Canceled,
    Rejected,
}

/// The word of an end in the protocol.
pub(super) fn end_word(end: GoalEnd) -> &'static str {
    match end {
        GoalEnd::Succeeded => "succeeded",
        GoalEnd::Aborted => "aborted",
        GoalEnd::Canceled => "canceled",
        GoalEnd::Rejected => "rejected",
    }
}

/// The request of this kind; `None`: it carries no message.
pub(super) fn parse(kind: &str, line: &[u8]) -> Option<serde_json::Result<MessageRequest>> {
    Some(match kind {
        "publish" => serde_json::from_slice(line)
            .map(|l: PublishLine<'_>| MessageRequest::Publish { port: l.port, message: text(l.message) }),
        "call" => serde_json::from_slice(line).map(|l: CallLine<'_>| MessageRequest::Call {
            port: l.port,
            call: l.call,
            message: text(l.message),
        }),
        "respond" => serde_json::from_slice(line).and_then(|l: RespondLine<'_>| {
            let answer = match (l.message, l.error) {
                (Some(message), None) => Ok(text(message)),
                (None, Some(error)) => Err(error),
                (None, None) | (Some(_), Some(_)) => {
                    return Err(serde::de::Error::custom("either `message` or `error` is needed"));
                }
            };
            Ok(MessageRequest::Respond { call: l.call, answer })
        }),
        "feedback" => serde_json::from_slice(line)
            .map(|l: FeedbackLine<'_>| MessageRequest::Feedback { call: l.call, message: text(l.message) }),
        "finish" => serde_json::from_slice(line).map(|l: FinishLine<'_>| MessageRequest::Finish {
            call: l.call,
            end: match l.end {
                WrittenGoalEnd::Succeeded => GoalEnd::Succeeded,
                WrittenGoalEnd::Aborted => GoalEnd::Aborted,
                WrittenGoalEnd::Canceled => GoalEnd::Canceled,
                WrittenGoalEnd::Rejected => GoalEnd::Rejected,
            },
            message: text(l.message),
            text: l.text,
        }),
        "set_parameter" => serde_json::from_slice(line).map(|l: SetParameterLine<'_>| {
            MessageRequest::SetParameter { name: l.name, value: text(l.value) }
        }),
        _ => return None,
    })
}

fn text(message: &RawValue) -> MessageText {
    Arc::from(message.get())
}
