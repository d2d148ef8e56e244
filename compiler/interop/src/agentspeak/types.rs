//! Types by unification: classes of places where the same values meet.

use hrdsl_source::Span;
use indexmap::{IndexMap, IndexSet};

use super::ast::Key;

/// A class of places; an index.
pub type TyId = usize;

/// What is known of a class.
#[derive(Clone, Debug, PartialEq)]
pub enum Ty {
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
}

#[derive(Clone, Debug)]
enum Node {
    Same(TyId),
    Root(Ty),
}

/// Why two classes cannot be one.
pub type Clash = String;

/// The classes of all places of a system.
#[derive(Clone, Debug, Default)]
pub struct Types {
    nodes: Vec<Node>,
    /// What was changed since the last mark: a class and what it was.
    changed: Vec<(TyId, Node)>,
    /// The arguments of beliefs, goals and actions of the environment.
    pub beliefs: IndexMap<Key, Vec<TyId>>,
    pub goals: IndexMap<Key, Vec<TyId>>,
    pub actions: IndexMap<Key, Vec<TyId>>,
    /// The values of annotations.
    pub annotations: IndexMap<(Key, String), TyId>,
    /// Every term that was looked at.
    pub terms: IndexMap<Span, TyId>,
    /// The agents of the system.
    pub agents: IndexSet<String>,
    /// `.concat` of what is not known yet: its arguments, its result.
    pub concats: Vec<(Vec<TyId>, TyId)>,
}

/// A state to go back to: how much there was of everything.
pub struct Mark {
    nodes: usize,
    places: [usize; 5],
    concats: Vec<(Vec<TyId>, TyId)>,
}

impl Types {
    /// Remembers how things are. What was marked before is forgotten.
    pub fn mark(&mut self) -> Mark {
        self.changed.clear();
        let places = [
            self.beliefs.len(),
            self.goals.len(),
            self.actions.len(),
            self.annotations.len(),
            self.terms.len(),
        ];
        Mark { nodes: self.nodes.len(), places, concats: self.concats.clone() }
    }

    /// Goes back to how things were at the last mark.
    pub fn back(&mut self, mark: Mark) {
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
        self.concats = mark.concats;
    }

    fn set(&mut self, id: TyId, node: Node) {
        let before = std::mem::replace(&mut self.nodes[id], node);
        self.changed.push((id, before));
    }

    pub fn add(&mut self, ty: Ty) -> TyId {
        self.nodes.push(Node::Root(ty));
        self.nodes.len() - 1
    }

    pub fn fresh(&mut self) -> TyId {
        self.add(Ty::Unknown)
    }

    pub fn number(&mut self, float: bool) -> TyId {
        self.add(Ty::Number { float })
    }

    /// The name of an agent.
    pub fn agent(&mut self) -> TyId {
        self.add(Ty::Atoms { names: IndexSet::new(), agent: true })
    }

    pub fn root(&self, mut id: TyId) -> TyId {
        while let Node::Same(next) = self.nodes[id] {
            id = next;
        }
        id
    }

    pub fn get(&self, id: TyId) -> &Ty {
        match &self.nodes[self.root(id)] {
            Node::Root(ty) => ty,
            Node::Same(_) => &Ty::Unknown,
        }
    }

    /// The places of the arguments of a belief.
    pub fn belief(&mut self, key: &Key) -> Vec<TyId> {
        if let Some(found) = self.beliefs.get(key) {
            return found.clone();
        }
        let args: Vec<TyId> = (0..key.1).map(|_| self.fresh()).collect();
        self.beliefs.insert(key.clone(), args.clone());
        args
    }

    pub fn goal(&mut self, key: &Key) -> Vec<TyId> {
        if let Some(found) = self.goals.get(key) {
            return found.clone();
        }
        let args: Vec<TyId> = (0..key.1).map(|_| self.fresh()).collect();
        self.goals.insert(key.clone(), args.clone());
        args
    }

    pub fn action(&mut self, key: &Key) -> Vec<TyId> {
        if let Some(found) = self.actions.get(key) {
            return found.clone();
        }
        let args: Vec<TyId> = (0..key.1).map(|_| self.fresh()).collect();
        self.actions.insert(key.clone(), args.clone());
        args
    }

    /// The value of an annotation of a belief.
    pub fn annotation(&mut self, key: &Key, name: &str) -> TyId {
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
    pub fn record(&mut self, span: Span, id: TyId) -> Result<(), Clash> {
        match self.terms.get(&span) {
            Some(known) => self.unify(*known, id),
            None => {
                self.terms.insert(span, id);
                Ok(())
            }
        }
    }

    /// Makes two classes one.
    pub fn unify(&mut self, a: TyId, b: TyId) -> Result<(), Clash> {
        let (a, b) = (self.root(a), self.root(b));
        if a == b {
            return Ok(());
        }
        let (left, right) = (self.get(a).clone(), self.get(b).clone());
        let clash = format!("{} meets {}", self.describe(a), self.describe(b));
        let (ty, pairs) = match (left, right) {
            (Ty::Unknown, ty) | (ty, Ty::Unknown) => (ty, Vec::new()),
            (Ty::Number { float: x }, Ty::Number { float: y }) => (Ty::Number { float: x || y }, Vec::new()),
            (Ty::Text, Ty::Text) => (Ty::Text, Vec::new()),
            (Ty::Bool, Ty::Bool) => (Ty::Bool, Vec::new()),
            (Ty::Atoms { names, agent: x }, Ty::Atoms { names: more, agent: y }) => {
                let all: IndexSet<String> = names.union(&more).cloned().collect();
                let agent = x || y;
                if let Some(other) = all.iter().find(|n| agent && !self.is_agent(n)) {
                    return Err(format!("no agent is called `{other}`"));
                }
                (Ty::Atoms { names: all, agent }, Vec::new())
            }
            (Ty::List(x), Ty::List(y)) => (Ty::List(x), vec![(x, y)]),
            (Ty::Struct(f, x), Ty::Struct(g, y)) if f == g && x.len() == y.len() => {
                let pairs = x.iter().copied().zip(y).collect();
                (Ty::Struct(f, x), pairs)
            }
            (
                Ty::Number { .. } | Ty::Text | Ty::Bool | Ty::Atoms { .. } | Ty::List(_) | Ty::Struct(..),
                _,
            ) => return Err(clash),
        };
        if self.contains(&ty, a) || self.contains(&ty, b) {
            return Err("a value would contain itself".to_owned());
        }
        self.set(a, Node::Root(ty));
        self.set(b, Node::Same(a));
        pairs.into_iter().try_for_each(|(x, y)| self.unify(x, y))
    }

    /// Whether a class is within a type.
    fn contains(&self, ty: &Ty, id: TyId) -> bool {
        let within = |inner: &TyId| self.root(*inner) == id || self.contains(self.get(*inner), id);
        match ty {
            Ty::List(of) => within(of),
            Ty::Struct(_, args) => args.iter().any(within),
            Ty::Unknown | Ty::Number { .. } | Ty::Text | Ty::Bool | Ty::Atoms { .. } => false,
        }
    }

    pub fn is_agent(&self, name: &str) -> bool {
        matches!(name, "self" | "percept") || self.agents.contains(name)
    }

    /// Whether the values of a class are agents' names.
    pub fn is_of_agents(&self, id: TyId) -> bool {
        match self.get(id) {
            Ty::Atoms { names, agent } => *agent || names.iter().all(|n| self.is_agent(n)),
            Ty::Unknown | Ty::Number { .. } | Ty::Text | Ty::Bool | Ty::List(_) | Ty::Struct(..) => false,
        }
    }

    /// In a few words, for people.
    pub fn describe(&self, id: TyId) -> String {
        match self.get(id) {
            Ty::Unknown => "anything".to_owned(),
            Ty::Number { .. } => "a number".to_owned(),
            Ty::Text => "a string".to_owned(),
            Ty::Bool => "a truth value".to_owned(),
            Ty::Atoms { names, .. } => match names.first() {
                Some(first) => format!("an atom (`{first}`)"),
                None => "the name of an agent".to_owned(),
            },
            Ty::List(_) => "a list".to_owned(),
            Ty::Struct(functor, args) => format!("a structure (`{functor}/{}`)", args.len()),
        }
    }

    /// The single values of which a value of the class consists: those of a structure one by one; a list of structures is
    /// as many lists.
    pub fn leaves(&self, id: TyId) -> Vec<Leaf> {
        match self.get(id) {
            Ty::Struct(_, args) => args.iter().flat_map(|a| self.leaves(*a)).collect(),
            Ty::List(of) => {
                self.leaves(*of).into_iter().map(|l| Leaf { lists: l.lists + 1, of: l.of }).collect()
            }
            Ty::Unknown | Ty::Number { .. } | Ty::Text | Ty::Bool | Ty::Atoms { .. } => {
                vec![Leaf { lists: 0, of: self.root(id) }]
            }
        }
    }

    /// Whether only agents know such a value: events and stimuli have no strings and lists.
    pub fn is_for_agents(&self, leaf: Leaf) -> bool {
        leaf.lists > 0 || *self.get(leaf.of) == Ty::Text
    }

    /// Whether values of the class are taken apart.
    pub fn is_compound(&self, id: TyId) -> bool {
        match self.get(id) {
            Ty::Struct(..) => true,
            Ty::List(of) => self.is_compound(*of),
            Ty::Unknown | Ty::Number { .. } | Ty::Text | Ty::Bool | Ty::Atoms { .. } => false,
        }
    }

    /// Decides what is still open of `.concat`: strings if one part is a string, otherwise lists.
    pub fn settle_concats(&mut self, finally: bool) -> Result<(), Clash> {
        for (args, result) in std::mem::take(&mut self.concats) {
            let any = |t: &Self, is: fn(&Ty) -> bool| args.iter().chain([&result]).any(|a| is(t.get(*a)));
            if any(self, |t| *t == Ty::Text) {
                let text = self.add(Ty::Text);
                self.unify(result, text)?;
            } else if finally || any(self, |t| matches!(t, Ty::List(_))) {
                let of = self.fresh();
                let list = self.add(Ty::List(of));
                args.iter().chain([&result]).try_for_each(|a| self.unify(*a, list))?;
            } else {
                self.concats.push((args, result));
            }
        }
        Ok(())
    }
}

/// A single value, or lists of lists of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Leaf {
    pub lists: usize,
    pub of: TyId,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_taken_back_never_was() {
        let mut types = Types::default();
        let place = types.belief(&("b".to_owned(), 1))[0];
        let int = types.number(false);
        types.unify(place, int).unwrap();
        let mark = types.mark();
        let float = types.number(true);
        types.unify(place, float).unwrap();
        types.belief(&("c".to_owned(), 2));
        assert_eq!(*types.get(int), Ty::Number { float: true });
        types.back(mark);
        assert_eq!((types.get(place), types.beliefs.len()), (&Ty::Number { float: false }, 1));
    }

    #[test]
    fn a_value_does_not_contain_itself() {
        let mut types = Types::default();
        let x = types.fresh();
        let list = types.add(Ty::List(x));
        assert!(types.unify(x, list).is_err());
    }

    #[test]
    fn a_list_of_structures_is_as_many_lists() {
        let mut types = Types::default();
        let (a, b) = (types.number(false), types.add(Ty::Text));
        let pair = types.add(Ty::Struct("pair".to_owned(), vec![a, b]));
        let list = types.add(Ty::List(pair));
        assert_eq!(types.leaves(list), [Leaf { lists: 1, of: a }, Leaf { lists: 1, of: b }]);
    }
}
