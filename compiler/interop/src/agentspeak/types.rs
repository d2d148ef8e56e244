//! Types by unification: classes of places where the same values meet.

use hrdsl_source::Span;
use indexmap::{IndexMap, IndexSet};

use super::ast::PredicateIndicator;

/// A class of places; an index.
pub type TyId = usize;

/// What is known of a class.
#[derive(Clone, Debug, PartialEq)]
pub enum AgentSpeakType {
    Unknown,
    Number {
        float: bool,
    },
    Text,
    Bool,
    /// Atoms; `agent`: they name agents.
    Atoms {
        names: IndexSet<String>,
        agent: bool,
    },
    List(TyId),
    Struct(String, Vec<TyId>),
    /// Values of several types: the classes of those, each of another sort.
    Union(Vec<TyId>),
}

#[derive(Clone, Debug)]
enum UnificationNode {
    Same(TyId),
    Root(AgentSpeakType),
}

/// Why two classes cannot be one.
pub type TypeClash = String;

/// The classes of all places of a system.
#[derive(Clone, Debug, Default)]
pub struct UnificationTable {
    nodes: Vec<UnificationNode>,
    /// What was changed since the last mark: a class and what it was.
    changed: Vec<(TyId, UnificationNode)>,
    /// The arguments of beliefs, goals and actions of the environment.
    pub beliefs: IndexMap<PredicateIndicator, Vec<TyId>>,
    pub goals: IndexMap<PredicateIndicator, Vec<TyId>>,
    pub actions: IndexMap<PredicateIndicator, Vec<TyId>>,
    /// The values of annotations.
    pub annotations: IndexMap<(PredicateIndicator, String), TyId>,
    /// Every term that was looked at.
    pub terms: IndexMap<Span, TyId>,
    /// The agents of the system.
    pub agents: IndexSet<String>,
    /// `.concat` of what is not known yet: its arguments, its result.
    pub concats: Vec<(Vec<TyId>, TyId)>,
    /// Pairs of classes whose numbers have decimals if those of the other have.
    pub(super) decimals: Vec<(TyId, TyId)>,
}

/// A state to go back to: how much there was of everything.
pub struct UnificationSnapshot {
    nodes: usize,
    places: [usize; 5],
    decimals: usize,
    concats: Vec<(Vec<TyId>, TyId)>,
}

impl UnificationTable {
    /// Remembers how things are. What was marked before is forgotten.
    pub fn mark(&mut self) -> UnificationSnapshot {
        self.changed.clear();
        let places = [
            self.beliefs.len(),
            self.goals.len(),
            self.actions.len(),
            self.annotations.len(),
            self.terms.len(),
        ];
        UnificationSnapshot {
            nodes: self.nodes.len(),
            places,
            decimals: self.decimals.len(),
            concats: self.concats.clone(),
        }
    }

    /// Goes back to how things were at the last mark.
    pub fn back(&mut self, mark: UnificationSnapshot) {
        while let Some((id, node)) = self.changed.pop() {
            self.nodes[id] = node;
        }
        self.nodes.truncate(mark.nodes);
        let [beliefs, goals, actions, annotations, terms] = mark.places;
        self.beliefs.truncate(beliefs);
        self.goals.truncate(goals);
        self.actions.truncate(actions);
        self.annotations.truncate(annotations);
        self.terms.truncate(terms);
        self.decimals.truncate(mark.decimals);
        self.concats = mark.concats;
    }

    fn set(&mut self, id: TyId, node: UnificationNode) {
        let before = std::mem::replace(&mut self.nodes[id], node);
        self.changed.push((id, before));
    }

    pub fn add(&mut self, ty: AgentSpeakType) -> TyId {
        self.nodes.push(UnificationNode::Root(ty));
        self.nodes.len() - 1
    }

    pub fn fresh(&mut self) -> TyId {
        self.add(AgentSpeakType::Unknown)
    }

    pub fn number(&mut self, float: bool) -> TyId {
        self.add(AgentSpeakType::Number { float })
    }

    /// The name of an agent.
    pub fn agent(&mut self) -> TyId {
        self.add(AgentSpeakType::Atoms { names: IndexSet::new(), agent: true })
    }

    pub fn root(&self, mut id: TyId) -> TyId {
        while let UnificationNode::Same(next) = self.nodes[id] {
            id = next;
        }
        id
    }

    pub fn get(&self, id: TyId) -> &AgentSpeakType {
        match &self.nodes[self.root(id)] {
            UnificationNode::Root(ty) => ty,
            UnificationNode::Same(_) => &AgentSpeakType::Unknown,
        }
    }

    /// The places of the arguments of a belief.
    pub fn belief(&mut self, key: &PredicateIndicator) -> Vec<TyId> {
        if let Some(found) = self.beliefs.get(key) {
            return found.clone();
        }
        let args: Vec<TyId> = (0..key.1).map(|_| self.fresh()).collect();
        self.beliefs.insert(key.clone(), args.clone());
        args
    }

    pub fn goal(&mut self, key: &PredicateIndicator) -> Vec<TyId> {
        if let Some(found) = self.goals.get(key) {
            return found.clone();
        }
        let args: Vec<TyId> = (0..key.1).map(|_| self.fresh()).collect();
        self.goals.insert(key.clone(), args.clone());
        args
    }

    pub fn action(&mut self, key: &PredicateIndicator) -> Vec<TyId> {
        if let Some(found) = self.actions.get(key) {
            return found.clone();
        }
        let args: Vec<TyId> = (0..key.1).map(|_| self.fresh()).collect();
        self.actions.insert(key.clone(), args.clone());
        args
    }

    /// The value of an annotation of a belief.
    pub fn annotation(&mut self, key: &PredicateIndicator, name: &str) -> TyId {
        if name == "source" {
            return self.agent();
        }
        let place = (key.clone(), name.to_owned());
        if let Some(found) = self.annotations.get(&place) {
            return *found;
        }
        let id = self.fresh();
        self.annotations.insert(place, id);
        id
    }

    /// Remembers of which class a term is.
    pub fn record(&mut self, span: Span, id: TyId) -> Result<(), TypeClash> {
        match self.terms.get(&span) {
            Some(known) => self.unify(*known, id),
            None => {
                self.terms.insert(span, id);
                Ok(())
            }
        }
    }

    /// Makes two classes one.
    pub fn unify(&mut self, a: TyId, b: TyId) -> Result<(), TypeClash> {
        let (a, b) = (self.root(a), self.root(b));
        if a == b {
            return Ok(());
        }
        let (left, right) = (self.get(a).clone(), self.get(b).clone());
        let is_known = left != AgentSpeakType::Unknown && right != AgentSpeakType::Unknown;
        if is_known && self.differ(a, b) {
            return self.join(a, b);
        }
        let (ty, pairs) = match (left, right) {
            (AgentSpeakType::Unknown, ty) | (ty, AgentSpeakType::Unknown) => (ty, Vec::new()),
            (AgentSpeakType::Number { float: x }, AgentSpeakType::Number { float: y }) => {
                (AgentSpeakType::Number { float: x || y }, Vec::new())
            }
            (AgentSpeakType::Text, AgentSpeakType::Text) => (AgentSpeakType::Text, Vec::new()),
            (AgentSpeakType::Bool, AgentSpeakType::Bool) => (AgentSpeakType::Bool, Vec::new()),
            (AgentSpeakType::Atoms { names, agent: x }, AgentSpeakType::Atoms { names: more, agent: y }) => {
                let all: IndexSet<String> = names.union(&more).cloned().collect();
                let agent = x || y;
                if let Some(other) = all.iter().find(|n| agent && !self.is_agent(n)) {
                    return Err(format!("no agent is called `{other}`"));
                }
                (AgentSpeakType::Atoms { names: all, agent }, Vec::new())
            }
            (AgentSpeakType::List(x), AgentSpeakType::List(y)) => (AgentSpeakType::List(x), vec![(x, y)]),
            (AgentSpeakType::Struct(f, x), AgentSpeakType::Struct(_, y)) => {
                let pairs = x.iter().copied().zip(y).collect();
                (AgentSpeakType::Struct(f, x), pairs)
            }
            (
                AgentSpeakType::Number { .. }
                | AgentSpeakType::Text
                | AgentSpeakType::Bool
                | AgentSpeakType::Atoms { .. }
                | AgentSpeakType::List(_)
                | AgentSpeakType::Struct(..)
                | AgentSpeakType::Union(_),
                _,
            ) => return self.join(a, b),
        };
        self.replace(a, b, ty)?;
        pairs.into_iter().try_for_each(|(x, y)| self.unify(x, y))
    }

    /// Makes two classes one of that type.
    pub(super) fn replace(&mut self, a: TyId, b: TyId, ty: AgentSpeakType) -> Result<(), TypeClash> {
        if self.contains(&ty, a) || self.contains(&ty, b) {
            return Err(
                "a value would contain others of its own type, to any depth: it has no fixed number of parts"
                    .to_owned(),
            );
        }
        self.set(a, UnificationNode::Root(ty));
        self.set(b, UnificationNode::Same(a));
        Ok(())
    }

    /// Numbers of a class have decimals.
    pub(super) fn give_decimals(&mut self, id: TyId) {
        let root = self.root(id);
        self.set(root, UnificationNode::Root(AgentSpeakType::Number { float: true }));
    }

    /// Whether a class is within a type.
    fn contains(&self, ty: &AgentSpeakType, id: TyId) -> bool {
        let within = |inner: &TyId| self.root(*inner) == id || self.contains(self.get(*inner), id);
        match ty {
            AgentSpeakType::List(of) => within(of),
            AgentSpeakType::Struct(_, args) | AgentSpeakType::Union(args) => args.iter().any(within),
            AgentSpeakType::Unknown
            | AgentSpeakType::Number { .. }
            | AgentSpeakType::Text
            | AgentSpeakType::Bool
            | AgentSpeakType::Atoms { .. } => false,
        }
    }

    pub fn is_agent(&self, name: &str) -> bool {
        matches!(name, "self" | "percept") || self.agents.contains(name)
    }

    /// Whether the values of a class are agents' names.
    pub fn is_of_agents(&self, id: TyId) -> bool {
        matches!(
            self.get(id),
            AgentSpeakType::Atoms { names, agent } if *agent || names.iter().all(|n| self.is_agent(n))
        )
    }

    /// In a few words, for people.
    pub fn describe(&self, id: TyId) -> String {
        match self.get(id) {
            AgentSpeakType::Unknown => "anything".to_owned(),
            AgentSpeakType::Number { .. } => "a number".to_owned(),
            AgentSpeakType::Text => "a string".to_owned(),
            AgentSpeakType::Bool => "a truth value".to_owned(),
            AgentSpeakType::Atoms { names, .. } => match names.first() {
                Some(first) => format!("an atom (`{first}`)"),
                None => "the name of an agent".to_owned(),
            },
            AgentSpeakType::List(_) => "a list".to_owned(),
            AgentSpeakType::Struct(functor, args) => format!("a structure (`{functor}/{}`)", args.len()),
            AgentSpeakType::Union(_) => "values of several types".to_owned(),
        }
    }

    /// The single values of which a value of the class consists: those of a structure one by one; of several types,
    /// the tag and those of each alternative. A list of such values is as many lists.
    pub fn leaves(&self, id: TyId) -> Vec<ListLeafType> {
        match self.get(id) {
            AgentSpeakType::Struct(_, args) => args.iter().flat_map(|a| self.leaves(*a)).collect(),
            AgentSpeakType::Union(all) => {
                let tag = ListLeafType { lists: 0, of: self.root(id) };
                std::iter::once(tag).chain(all.iter().flat_map(|a| self.leaves(*a))).collect()
            }
            AgentSpeakType::List(of) => {
                self.leaves(*of).into_iter().map(|l| ListLeafType { lists: l.lists + 1, of: l.of }).collect()
            }
            AgentSpeakType::Unknown
            | AgentSpeakType::Number { .. }
            | AgentSpeakType::Text
            | AgentSpeakType::Bool
            | AgentSpeakType::Atoms { .. } => {
                vec![ListLeafType { lists: 0, of: self.root(id) }]
            }
        }
    }

    /// Whether only agents know such a value: events and stimuli have no strings and lists.
    pub fn is_for_agents(&self, leaf: ListLeafType) -> bool {
        leaf.lists > 0 || *self.get(leaf.of) == AgentSpeakType::Text
    }

    /// Whether values of the class are taken apart.
    pub fn is_compound(&self, id: TyId) -> bool {
        match self.get(id) {
            AgentSpeakType::Struct(..) | AgentSpeakType::Union(_) => true,
            AgentSpeakType::List(of) => self.is_compound(*of),
            AgentSpeakType::Unknown
            | AgentSpeakType::Number { .. }
            | AgentSpeakType::Text
            | AgentSpeakType::Bool
            | AgentSpeakType::Atoms { .. } => false,
        }
    }

    /// Decides what is still open of `.concat`: strings if one part is a string, otherwise lists.
    pub fn settle_concats(&mut self, finally: bool) -> Result<(), TypeClash> {
        for (args, result) in std::mem::take(&mut self.concats) {
            let any = |t: &Self, is: fn(&AgentSpeakType) -> bool| {
                args.iter().chain([&result]).any(|a| is(t.get(*a)))
            };
            if any(self, |t| *t == AgentSpeakType::Text) {
                let text = self.add(AgentSpeakType::Text);
                self.demand(result, text)?;
            } else if finally || any(self, |t| matches!(t, AgentSpeakType::List(_))) {
                let of = self.fresh();
                let list = self.add(AgentSpeakType::List(of));
                args.iter().chain([&result]).try_for_each(|a| self.demand(*a, list))?;
            } else {
                self.concats.push((args, result));
            }
        }
        Ok(())
    }
}

/// A single value, or lists of lists of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ListLeafType {
    pub lists: usize,
    pub of: TyId,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_taken_back_never_was() {
        let mut types = UnificationTable::default();
        let place = types.belief(&("b".to_owned(), 1))[0];
        let int = types.number(false);
        types.unify(place, int).unwrap();
        let mark = types.mark();
        let float = types.number(true);
        types.unify(place, float).unwrap();
        types.belief(&("c".to_owned(), 2));
        assert_eq!(*types.get(int), AgentSpeakType::Number { float: true });
        types.back(mark);
        assert_eq!((types.get(place), types.beliefs.len()), (&AgentSpeakType::Number { float: false }, 1));
    }

    #[test]
    fn a_value_does_not_contain_itself() {
        let mut types = UnificationTable::default();
        let x = types.fresh();
        let list = types.add(AgentSpeakType::List(x));
        assert!(types.unify(x, list).is_err());
    }

    #[test]
    fn a_list_of_structures_is_as_many_lists() {
        let mut types = UnificationTable::default();
        let (a, b) = (types.number(false), types.add(AgentSpeakType::Text));
        let pair = types.add(AgentSpeakType::Struct("pair".to_owned(), vec![a, b]));
        let list = types.add(AgentSpeakType::List(pair));
        assert_eq!(types.leaves(list), [ListLeafType { lists: 1, of: a }, ListLeafType { lists: 1, of: b }]);
    }
}
