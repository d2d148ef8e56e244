//! All definitions that are known: found by name, checked against each other.

use std::collections::BTreeMap;

use hrdsl_source::{SourceFiles, Span};

use crate::{
    definition::{MessageDefinition, ServiceDefinition},
    fault::MessageFault,
    guess::nearest_interface,
    implied::{ActionInterfaces, implied_by},
    known::{KnownAction, KnownMessage, KnownService},
    name::{InterfaceName, InterfaceSpace, RosVersion},
    parse::InterfaceDefinition,
    resolve,
    standard::{ReadDefinition, read_package_text},
    workspace::{WorkspaceReader, read_workspace},
};

/// The definitions of one version of ROS. What is wrong with one is kept with it, so that it is said only to whoever uses it.
#[derive(Clone, Debug)]
pub struct MessageLibrary {
    version: RosVersion,
    messages: BTreeMap<InterfaceName, KnownMessage>,
    services: BTreeMap<InterfaceName, KnownService>,
    actions: BTreeMap<InterfaceName, KnownAction>,
    folders: BTreeMap<String, String>,
    faults: Vec<MessageFault>,
}

/// A name that no definition has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no {} is called `{written}`", space.noun())]
pub struct UnknownInterface {
    pub written: String,
    pub space: InterfaceSpace,
    /// What was probably meant, as it is to be written.
    pub nearest: Option<String>,
}

/// Collects definitions, package by package; a later package takes the place of an earlier one of the same name.
pub struct MessageLibraryBuilder<'f> {
    version: RosVersion,
    files: &'f mut SourceFiles,
    packages: BTreeMap<String, Vec<ReadDefinition>>,
    folders: BTreeMap<String, String>,
    faults: Vec<MessageFault>,
}

impl<'f> MessageLibraryBuilder<'f> {
    /// Without any definition; `files` gets the texts that are read, so that faults have a place.
    #[must_use]
    pub fn new(version: RosVersion, files: &'f mut SourceFiles) -> Self {
        Self { version, files, packages: BTreeMap::new(), folders: BTreeMap::new(), faults: Vec::new() }
    }

    /// Adds a package whose definitions stand in one text, such as those of the standard library; `file` is shown in faults.
    #[must_use]
    pub fn package(mut self, package: &str, file: &str, text: &str) -> Self {
        let id = self.files.add(file, text);
        let (definitions, faults) = read_package_text(self.version, package, id, text);
        self.faults.extend(faults);
        self.packages.insert(package.to_owned(), definitions);
        self
    }

    /// Adds the packages of a workspace; `place` is where its path is written.
    #[must_use]
    pub fn workspace(mut self, reader: &dyn WorkspaceReader, path: &str, place: Span) -> Self {
        let read = read_workspace(self.version, self.files, reader, path, place);
        self.faults.extend(read.faults);
        self.packages.extend(read.packages);
        self.folders.extend(read.folders);
        self
    }

    /// Adds what the definitions imply, and checks them against each other.
    #[must_use]
    pub fn finish(self) -> MessageLibrary {
        let mut library = MessageLibrary {
            version: self.version,
            messages: BTreeMap::new(),
            services: BTreeMap::new(),
            actions: BTreeMap::new(),
            folders: self.folders,
            faults: self.faults,
        };
        let mut implied = Vec::new();
        for (definition, faults) in self.packages.into_values().flatten() {
            library.add(definition, faults, &mut implied);
        }
        // What is written takes the place of what is implied: installed packages of ROS 1 have files of both.
        for message in implied {
            library
                .messages
                .entry(message.name.clone())
                .or_insert(KnownMessage { definition: message, faults: Vec::new() });
        }
        resolve::check(library.version, &mut library.messages);
        library
    }
}

impl MessageLibrary {
    fn add(
        &mut self,
        definition: InterfaceDefinition,
        faults: Vec<MessageFault>,
        implied: &mut Vec<MessageDefinition>,
    ) {
        match definition {
            InterfaceDefinition::Message(message) => self.add_message(message, faults),
            InterfaceDefinition::Service(service) => self.add_service(service, faults),
            InterfaceDefinition::Action(action) => {
                let (messages, services) = implied_by(&action, self.version);
                implied.extend(messages);
                for service in services {
                    self.add_service(service, Vec::new());
                }
                let span = action.goal.span.to(action.feedback.span);
                let [goal, result, feedback] =
                    [&action.goal, &action.result, &action.feedback].map(|part| part.name.clone());
                let interfaces = ActionInterfaces::of(&action.name, self.version);
                self.actions.insert(action.name, KnownAction { goal, result, feedback, interfaces, span });
                self.add_parts(vec![action.goal, action.result, action.feedback], faults);
            }
        }
    }

    fn add_service(&mut self, service: ServiceDefinition, faults: Vec<MessageFault>) {
        let known =
            KnownService { request: service.request.name.clone(), response: service.response.name.clone() };
        self.services.insert(service.name, known);
        self.add_parts(vec![service.request, service.response], faults);
    }

    /// The parts of one file, each with what is wrong in it; what stands in no part goes with the first.
    fn add_parts(&mut self, mut parts: Vec<MessageDefinition>, mut faults: Vec<MessageFault>) {
        while let Some(part) = parts.pop() {
            let is_inside = |fault: &MessageFault| parts.is_empty() || fault.span.start >= part.span.start;
            let (inside, before) = faults.into_iter().partition(is_inside);
            faults = before;
            self.add_message(part, inside);
        }
    }

    fn add_message(&mut self, definition: MessageDefinition, faults: Vec<MessageFault>) {
        self.messages.insert(definition.name.clone(), KnownMessage { definition, faults });
    }

    #[must_use]
    pub fn version(&self) -> RosVersion {
        self.version
    }

    /// What is wrong with the workspaces themselves: folders, packages, their names.
    #[must_use]
    pub fn faults(&self) -> &[MessageFault] {
        &self.faults
    }

    /// Where the packages of the workspaces are, by their names; those without definitions, too.
    #[must_use]
    pub fn package_folders(&self) -> &BTreeMap<String, String> {
        &self.folders
    }

    /// All messages, the implied ones and the parts of services and actions among them, in the order of their names.
    pub fn messages(&self) -> impl Iterator<Item = (&InterfaceName, &KnownMessage)> {
        self.messages.iter()
    }

    pub fn services(&self) -> impl Iterator<Item = (&InterfaceName, &KnownService)> {
        self.services.iter()
    }

    pub fn actions(&self) -> impl Iterator<Item = (&InterfaceName, &KnownAction)> {
        self.actions.iter()
    }

    #[must_use]
    pub fn message(&self, name: &InterfaceName) -> Option<&KnownMessage> {
        self.messages.get(name)
    }

    #[must_use]
    pub fn service(&self, name: &InterfaceName) -> Option<&KnownService> {
        self.services.get(name)
    }

    #[must_use]
    pub fn action(&self, name: &InterfaceName) -> Option<&KnownAction> {
        self.actions.get(name)
    }

    /// The library's own name of a message, and the message.
    pub(crate) fn messages_from(&self, name: &InterfaceName) -> Option<(&InterfaceName, &KnownMessage)> {
        self.messages.get_key_value(name)
    }

    pub(crate) fn services_from(&self, name: &InterfaceName) -> Option<(&InterfaceName, &KnownService)> {
        self.services.get_key_value(name)
    }

    pub(crate) fn actions_from(&self, name: &InterfaceName) -> Option<(&InterfaceName, &KnownAction)> {
        self.actions.get_key_value(name)
    }

    /// The interface of this name, as `PACKAGE/NAME` or `PACKAGE/msg/NAME`.
    ///
    /// # Errors
    /// If there is none, with the nearest name.
    pub fn find(&self, written: &str, space: InterfaceSpace) -> Result<&InterfaceName, UnknownInterface> {
        let wanted = InterfaceName::read(written, space);
        let known = wanted.as_ref().and_then(|wanted| match space {
            InterfaceSpace::Msg => self.message_named(wanted),
            InterfaceSpace::Srv => self.services_from(wanted).map(|known| known.0),
            InterfaceSpace::Action => self.actions_from(wanted).map(|known| known.0),
        });
        known.ok_or_else(|| {
            let nearest = match &wanted {
                Some(wanted) => self.nearest(wanted, space),
                // Nobody wrote a package: a name alone may be enough to find it.
                None => self.nearest(&InterfaceName::new("", space, written), space),
            };
            UnknownInterface { written: written.to_owned(), space, nearest }
        })
    }

    /// In ROS 1 the names of a service's two messages do not say that they are of a service.
    fn message_named(&self, wanted: &InterfaceName) -> Option<&InterfaceName> {
        let of_service = || InterfaceName::new(&wanted.package, InterfaceSpace::Srv, &wanted.name);
        let known = self.messages_from(wanted).or_else(|| match self.version {
            RosVersion::Ros1 => self.messages_from(&of_service()),
            RosVersion::Ros2 => None,
        });
        known.map(|known| known.0)
    }

    /// The names of all messages, services or actions.
    fn named(&self, space: InterfaceSpace) -> Box<dyn Iterator<Item = &InterfaceName> + '_> {
        match space {
            InterfaceSpace::Msg => Box::new(self.messages.keys()),
            InterfaceSpace::Srv => Box::new(self.services.keys()),
            InterfaceSpace::Action => Box::new(self.actions.keys()),
        }
    }

    fn nearest(&self, wanted: &InterfaceName, space: InterfaceSpace) -> Option<String> {
        nearest_interface(wanted, self.named(space).filter(|name| name.space == space))
            .map(|name| name.in_field(RosVersion::Ros1))
    }
}
