//! Names with what resolves them, by what they are of: each table is filled by one phase, and read by those after it.

use std::{
    collections::{BTreeMap, BTreeSet},
    rc::Rc,
};

use hrdsl_messages::MessageLibrary;
use hrdsl_source::{Enumeration, FileId, Span};
use hrdsl_syntax::ast::{self, InstanceSyntax, NameSyntax, TemplateSyntaxKind};

use super::{
    function::FunctionCalls,
    item::ExprItem,
    phase::CheckPhase,
    record::{DeclaredFields, RecordEntry},
    scope::NameScope,
    table::{NameTable, OrderedMap},
    template::{DeclaredTemplate, TemplateArguments},
    world::WorldNames,
};
use crate::{PlayerRef, TypedCombinations, descriptions::DescriptionLibrary};

/// What is checked: the items of a scenario and of its modules, and what of them could not be read.
pub(crate) struct CheckedSource<'a> {
    pub items: Vec<&'a ast::ItemSyntax>,
    /// The first items come from modules.
    pub from_modules: usize,
    /// A module is missing, which may have the parts that are used.
    pub missing_modules: bool,
    /// The definitions of the versions of ROS that the systems use.
    pub interfaces: &'a [MessageLibrary],
    /// The robots and maps that are named.
    pub descriptions: Option<&'a DescriptionLibrary>,
    /// A declaration of the scenario, or a member of its world, could not be read.
    pub unread_items: bool,
    /// A member of the agent or automaton that is being checked could not be read.
    pub unread_members: bool,
    /// One declaration is checked alone.
    pub alone: Option<LoneDeclaration>,
}

/// The declaration that is checked alone: the only one of its file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LoneDeclaration {
    pub file: FileId,
    pub phase: CheckPhase,
}

impl CheckedSource<'_> {
    /// Whether what is declared there in this phase is looked at.
    pub fn looks_at(&self, phase: CheckPhase, at: Span) -> bool {
        self.alone.is_none_or(|alone| alone.file == at.file || alone.phase.speaks_of(phase))
    }

    /// Whether a phase comes to its turn: it does, unless the one declaration is of an earlier one.
    pub fn reaches(&self, phase: CheckPhase) -> bool {
        self.alone.is_none_or(|alone| phase <= alone.phase)
    }
}

/// An agent or automaton: as written, and if it is an instance of a template, what is given.
pub(crate) struct DeclaredPlayer<'a, T> {
    pub syntax: &'a T,
    pub given: Option<Rc<TemplateArguments>>,
    pub instance: Option<&'a InstanceSyntax>,
}

impl<T> Clone for DeclaredPlayer<'_, T> {
    fn clone(&self) -> Self {
        Self { syntax: self.syntax, given: self.given.clone(), instance: self.instance }
    }
}

/// How far the value of a constant is known.
pub(crate) enum ConstState {
    Unseen,
    /// Its own value is being worked out.
    Open,
    Done(ExprItem),
}

pub(crate) struct ConstEntry<'a> {
    pub name: &'a NameSyntax,
    pub value: &'a ast::ExprSyntax,
    pub state: ConstState,
}

/// Enumerations and records.
#[derive(Default)]
pub(crate) struct TypeNames<'a> {
    pub enums: NameTable,
    /// By their bare names: the values of enumerations.
    pub values: OrderedMap<&'a str, Vec<Enumeration>>,
    pub record_names: NameTable,
    pub records: Vec<RecordEntry<'a>>,
    /// How many records are being resolved, each in the one before.
    pub open_records: usize,
}

/// Templates, and the instance of one that is being checked.
#[derive(Default)]
pub(crate) struct TemplateNames<'a> {
    /// By sort and name.
    pub declared: OrderedMap<(TemplateSyntaxKind, &'a str), DeclaredTemplate<'a>>,
    /// Instances that could not be made: nothing is said about their names.
    pub broken_instances: BTreeSet<String>,
    /// What the parameters stand for in the instance that is being checked.
    pub given: Option<Rc<TemplateArguments>>,
    /// A template is being checked by itself, with some values.
    pub by_itself: bool,
}

/// Events and stimuli, which are numbered together.
#[derive(Default)]
pub(crate) struct EventNames {
    pub table: NameTable,
    /// By [`EventId`](crate::EventId): the parameters as declared.
    pub fields: Vec<DeclaredFields>,
}

/// Agents and automata.
pub(crate) struct PlayerNames<'a> {
    pub table: NameTable,
    pub ids: Vec<PlayerRef>,
    pub agents: Vec<DeclaredPlayer<'a, ast::AgentSyntax>>,
    pub automata: Vec<DeclaredPlayer<'a, ast::AutomatonSyntax>>,
    /// The names of all agents, `self` and `percept`.
    pub agent_names: Enumeration,
}

/// What all automata share: variables, clocks and functions.
#[derive(Default)]
pub(crate) struct SharedNames {
    pub names: NameTable,
    /// What every automaton sees of them, and of the shared clocks.
    pub scope: Rc<NameScope>,
    pub clocks: NameTable,
    /// What is known of the functions that are being checked.
    pub functions: FunctionCalls,
}

/// Channels of automata.
#[derive(Default)]
pub(crate) struct ChannelNames {
    pub table: NameTable,
    /// By [`ChannelId`](crate::ChannelId): the parameters as declared.
    pub fields: Vec<DeclaredFields>,
    /// Some participant of these channels has a diagnostic.
    pub vague: BTreeSet<String>,
}

/// The world's names.
pub(crate) struct WorldState {
    pub exists: bool,
    pub names: WorldNames,
    /// What needs a world where the scenario has none: one cause, which is said once.
    pub missed: Vec<(Span, String)>,
}

/// What a belief's rules need of an argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum ArgumentMode {
    /// Nothing: the rules give it a value.
    Free,
    /// No value for a variable: some rule's head has `_` there.
    Named,
    /// A value.
    Input,
}

/// An argument of a goal that a plan leaves open for the goal to give it a value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct GoalArgument {
    /// The value is taken: not only `_` stands there.
    pub wanted: bool,
    /// It is not given after all, and must have a value.
    pub ungiving: Option<Ungiving>,
}

/// Why a goal does not give a value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Ungiving {
    /// The trigger of the plan that does not.
    pub plan: Span,
    /// Where it is wanted.
    pub call: Span,
    pub argument: usize,
    /// The plan reads it before it has a value.
    pub reads: bool,
}

/// A goal that some plan achieves.
#[derive(Clone, Debug, Default)]
pub(crate) struct GoalEntry {
    /// How many arguments are written.
    pub arity: usize,
    /// If their types are declared.
    pub fields: Option<DeclaredFields>,
    /// Its declaration's name, or that of the first plan for it.
    pub place: Span,
}

/// What agents have declared, by agent.
#[derive(Default)]
pub(crate) struct AgentNames {
    pub beliefs: Vec<NameTable>,
    /// By belief: the parameters as declared.
    pub belief_fields: Vec<Vec<DeclaredFields>>,
    pub goals: Vec<OrderedMap<String, GoalEntry>>,
    /// By agent and belief: what its rules need of its arguments.
    pub modes: BTreeMap<(u16, u16), Vec<ArgumentMode>>,
    /// By agent and goal: the arguments that its plans are to give.
    pub wanted: BTreeMap<(u16, u16), BTreeMap<usize, GoalArgument>>,
}

impl AgentNames {
    /// Of an agent that has declared nothing yet.
    pub fn add(&mut self) {
        self.beliefs.push(NameTable::default());
        self.belief_fields.push(Vec::new());
        self.goals.push(OrderedMap::default());
    }

    /// Keeps the names of the first agents.
    pub fn truncate(&mut self, agents: usize) {
        self.beliefs.truncate(agents);
        self.belief_fields.truncate(agents);
        self.goals.truncate(agents);
        self.modes.retain(|(agent, _), _| usize::from(*agent) < agents);
        self.wanted.retain(|(agent, _), _| usize::from(*agent) < agents);
    }
}

/// Networks of automata, and what is asked of them.
#[derive(Default)]
pub(crate) struct NetworkNames {
    pub table: NameTable,
    pub queries: NameTable,
    /// By member of a suite: the values that it reaches. What has a diagnostic is not among them.
    pub combinations: BTreeMap<Span, TypedCombinations>,
}
