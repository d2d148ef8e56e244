//! ROS 1's sums: the text that stands for a message, and MD5 of it.
//!
//! The text has the constants first, each `TYPE NAME=VALUE` with its value as written, then the fields, each `TYPE NAME`, where the sum
//! of a message stands for its type, without the brackets of an array. Comments and blanks are no part of it.

use std::fmt::Write as _;

use md5::{Digest, Md5};

use crate::{
    definition::MessageDefinition,
    name::{InterfaceName, RosVersion},
};

/// The lines that are summed; `None` if the sum of a message that it holds is not known.
pub(crate) fn summed_text<'s>(
    message: &MessageDefinition,
    sum_of: impl Fn(&InterfaceName) -> Option<&'s str>,
) -> Option<String> {
    let constants =
        message.constants.iter().map(|c| Some(format!("{} {}={}", c.of.word(), c.name, c.written)));
    let fields = message.fields.iter().map(|field| {
        let of = match field.of.message() {
            Some(held) => sum_of(held)?.to_owned(),
            None => field.of.written(RosVersion::Ros1),
        };
        Some(format!("{of} {}", field.name))
    });
    let lines: Option<Vec<String>> = constants.chain(fields).collect();
    lines.map(|lines| lines.join("\n").trim().to_owned())
}

/// MD5 of some texts, one after the other, in hexadecimal: one of a message, two of a service.
pub(crate) fn sum(texts: &[&str]) -> String {
    let mut digest = Md5::new();
    for text in texts {
        digest.update(text.as_bytes());
    }
    let mut hexadecimal = String::new();
    for byte in digest.finalize() {
        // Writing into a text never fails.
        let _ = write!(hexadecimal, "{byte:02x}");
    }
    hexadecimal
}
