//! What the programs of a system said in a run, for looking only: their log, and the messages of their topics, services and actions. In bounded
//! memory, and only if somebody asks for it.

use std::collections::BTreeMap;

use hrdsl_ir::Nanos;

use crate::{
    log::{KeptRecord, LogRecord, shortened},
    port::{MessageText, PortDeclaration},
};

/// So many records of the log are kept.
const MOST_RECORDS: usize = 5_000;
/// Of so many names messages are kept, so many of each, and so many texts of each.
const MOST_NAMES: usize = 500;
const MOST_MESSAGES: usize = 50_000;
const MOST_TEXTS: usize = 200;
/// A text that is longer is not kept: scans and pictures say little to people.
const LONGEST_TEXT: usize = 300;

/// What was said in a run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SaidHistory {
    /// In the order in which it came.
    pub log: Vec<KeptRecord>,
    /// How many records were too many to be kept.
    pub log_left_out: u64,
    /// By their names, those that the programs hear first.
    pub topics: Vec<TopicHistory>,
}

/// What messages are to a name: of a topic, or which step of the calls of a service or an action.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum MessagePart {
    #[default]
    Message,
    /// A request of a service, or a goal.
    Request,
    /// The answer of a service, or the result of a goal; or why there is none.
    Answer,
    /// How far a goal is.
    Feedback,
}

/// The messages of a name that are one part of it, in one direction.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TopicHistory {
    /// `/scan`
    pub name: String,
    /// `sensor_msgs/LaserScan`
    pub interface: String,
    /// Whether a program of the system said it; otherwise the scenario did.
    pub outward: bool,
    pub part: MessagePart,
    pub times: Vec<Nanos>,
    /// The texts of the first messages, as far as they are short.
    pub texts: Vec<Option<MessageText>>,
}

/// Writes down what is said.
#[derive(Debug, Default)]
pub(crate) struct SaidRecorder {
    pub now: Nanos,
    log: Vec<KeptRecord>,
    log_left_out: u64,
    topics: BTreeMap<(bool, String, MessagePart), TopicHistory>,
}

impl SaidRecorder {
    /// A program has logged something.
    pub fn logged(&mut self, program: &str, record: &LogRecord) {
        if self.log.len() >= MOST_RECORDS {
            self.log_left_out += 1;
            return;
        }
        let LogRecord { level, node, text } = record.clone();
        let record = LogRecord { level, node: shortened(node), text: shortened(text) };
        self.log.push(KeptRecord { time: self.now, program: program.to_owned(), record });
    }

    /// A message was sent through a port.
    pub fn sent(&mut self, port: &PortDeclaration, outward: bool, part: MessagePart, message: &MessageText) {
        let key = (outward, port.name.clone(), part);
        if self.topics.len() >= MOST_NAMES && !self.topics.contains_key(&key) {
            return;
        }
        let topic = self.topics.entry(key).or_insert_with(|| TopicHistory {
            name: port.name.clone(),
            interface: port.type_name.clone(),
            outward,
            part,
            ..TopicHistory::default()
        });
        if topic.times.len() < MOST_MESSAGES {
            topic.times.push(self.now);
        }
        if topic.texts.len() < MOST_TEXTS {
            topic.texts.push((message.len() <= LONGEST_TEXT).then(|| message.clone()));
        }
    }

    /// All of it.
    pub fn history(&self) -> SaidHistory {
        SaidHistory {
            log: self.log.clone(),
            log_left_out: self.log_left_out,
            topics: self.topics.values().cloned().collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        log::ProgramLogLevel,
        port::{PortKind, PortQos},
    };

    fn port(name: &str) -> PortDeclaration {
        PortDeclaration {
            port: 1,
            kind: PortKind::Publisher,
            name: name.to_owned(),
            type_name: "std_msgs/String".to_owned(),
            kept: 0,
            depth: 1,
            qos: PortQos::default(),
        }
    }

    #[test]
    fn messages_are_kept_by_name_and_direction_and_long_texts_are_not() {
        let mut recorder = SaidRecorder::default();
        for now in 0..300 {
            recorder.now = now;
            recorder.sent(&port("/b"), true, MessagePart::Message, &"short".into());
        }
        recorder.sent(&port("/a"), true, MessagePart::Message, &"x".repeat(LONGEST_TEXT + 1).into());
        recorder.sent(&port("/b"), false, MessagePart::Message, &"in".into());
        let topics = recorder.history().topics;
        let shown: Vec<(&str, bool, usize, usize)> =
            topics.iter().map(|t| (t.name.as_str(), t.outward, t.times.len(), t.texts.len())).collect();
        assert_eq!(shown, [("/b", false, 1, 1), ("/a", true, 1, 1), ("/b", true, 300, MOST_TEXTS)]);
        assert_eq!(topics[1].texts, [None]);
        assert_eq!((topics[2].times[299], topics[0].times[0]), (299, 299));
    }

    #[test]
    fn the_log_is_kept_to_its_limit_and_the_rest_is_counted() {
        let mut recorder = SaidRecorder::default();
        let record =
            LogRecord { level: ProgramLogLevel::Debug, node: "/n".to_owned(), text: "t".repeat(10_000) };
        for _ in 0..MOST_RECORDS + 3 {
            recorder.logged("brain", &record);
        }
        let history = recorder.history();
        assert_eq!((history.log.len(), history.log_left_out), (MOST_RECORDS, 3));
        assert!(history.log[0].record.text.chars().count() < 1_000);
    }
}
