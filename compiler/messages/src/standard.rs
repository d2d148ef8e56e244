//! A package whose definitions stand in one text, as the standard ones do: a line `== msg/Header.msg`, then the lines of that
//! definition, then the next.

use hrdsl_source::FileId;

use crate::{
    fault::{MessageFault, MessageFaultKind},
    name::{InterfaceSpace, RosVersion},
    parse::{DefinitionText, InterfaceDefinition, parse_definition},
    placed::PlacedText,
};

const SECTION: &str = "== ";

/// A definition with what is wrong in it.
pub(crate) type ReadDefinition = (InterfaceDefinition, Vec<MessageFault>);

/// The definitions of the text, and what stands outside of them.
pub(crate) fn read_package_text(
    version: RosVersion,
    package: &str,
    file: FileId,
    text: &str,
) -> (Vec<ReadDefinition>, Vec<MessageFault>) {
    let text = PlacedText { file, at: 0, text };
    let mut definitions = Vec::new();
    let mut faults = Vec::new();
    let mut heads = text.lines().filter(|line| line.text.starts_with(SECTION)).peekable();
    let before = heads.peek().map_or(text.text.len(), |head| head.at);
    let outside = text.part(0, text.text.get(..before).unwrap_or_default()).trimmed();
    if !outside.is_empty() {
        faults.push(
            MessageFaultKind::MisplacedText.at(outside.span(), "begin with a line such as `== msg/NAME.msg`"),
        );
    }
    while let Some(head) = heads.next() {
        let start = (head.at + head.text.len() + 1).min(text.text.len());
        let end = heads.peek().map_or(text.text.len(), |next| next.at);
        let body = text.text.get(start..end).unwrap_or_default();
        let path = head.after(SECTION).unwrap_or(head).trimmed();
        let Some((space, name)) = space_and_name(path.text) else {
            let help = "write `== msg/NAME.msg`, `== srv/NAME.srv` or `== action/NAME.action`";
            faults.push(MessageFaultKind::MisplacedText.at(head.span(), help));
            continue;
        };
        let source = DefinitionText { version, package, name, file, start, text: body };
        definitions.push(parse_definition(source, space));
    }
    (definitions, faults)
}

/// From `msg/Header.msg`.
pub(crate) fn space_and_name(path: &str) -> Option<(InterfaceSpace, &str)> {
    let (folder, file) = path.split_once('/')?;
    let space = InterfaceSpace::of_folder(folder)?;
    let name = file.strip_suffix(space.folder())?.strip_suffix('.')?;
    Some((space, name))
}
