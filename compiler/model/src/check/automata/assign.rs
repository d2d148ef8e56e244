//! Assignments of edges: what may be assigned, and clocks.

use hrdsl_syntax::ast::{self, Access, Name};

use crate::check::{
    automata::{automaton::Scope, clock::is_clock},
    checker::Checker,
    state::scope::{Env, Local},
};
use crate::{BinaryOp, Expr, Leaf, Place, Type, Update, noun::Noun, report::automata, types::Layout};

impl Checker<'_> {
    /// `target = value`: one update for each single value.
    pub(in crate::check) fn update(
        &mut self,
        scope: &Scope,
        (target, access): (&Name, &[Access]),
        op: Option<BinaryOp>,
        value: &ast::Expr,
        env: &mut Env,
        updates: &mut Vec<Update>,
    ) {
        if is_clock(target, env) {
            return updates.extend(self.set_clock((target, access), op, value, scope, env));
        }
        self.refer(target, env.place_of(&target.text));
        let slot = env.find(&target.text).map(|l| l.leaf);
        if env.layout(&target.text) == Some(&Layout::Unknown) {
            return;
        }
        let layout = match slot {
            Some(Some(leaf @ (Leaf::Own(_) | Leaf::Shared(_)))) => Layout::Scalar(self.type_of(scope, leaf)),
            Some(Some(Leaf::Local(_) | Leaf::Signal(_)) | None) => {
                return self.report(automata::bound_by_edge(&target.text, target.span));
            }
            None => match env.layout(&target.text) {
                Some(layout) if self.bound_by_edge(&target.text, layout, env) => {
                    return self.report(automata::bound_by_edge(&target.text, target.span));
                }
                Some(layout) => layout.clone(),
                None => {
                    let vars = env.all().filter(|l| !matches!(l.leaf, Some(Leaf::Local(_))));
                    let single = vars.map(|l| l.name.clone()).filter(|n| !n.contains(['.', '[']));
                    let all: Vec<String> = single.chain(env.layout_names().map(str::to_owned)).collect();
                    self.unknown(Noun::Variable, target, &all, None);
                    self.item(value, env);
                    return;
                }
            },
        };
        env.effects = true;
        let assigned = self.assigned(target, (layout, access), op, value, env);
        env.effects = false;
        updates.extend(assigned.into_iter().filter_map(set));
    }

    /// Whether the parts of a name are not those of a variable.
    fn bound_by_edge(&self, name: &str, layout: &Layout, env: &Env) -> bool {
        let mut leaves = Vec::new();
        self.leaves(name, layout, &mut leaves);
        let own = |l: &Local| matches!(l.leaf, Some(Leaf::Own(_) | Leaf::Shared(_)));
        !leaves.iter().all(|(name, _)| env.find(name).is_some_and(own))
    }

    fn type_of(&self, scope: &Scope, leaf: Leaf) -> Type {
        match leaf {
            Leaf::Own(i) => self.s.automata[scope.index].vars[usize::from(i)].ty(),
            Leaf::Shared(i) => self.s.shared[usize::from(i)].ty(),
            Leaf::Local(_) | Leaf::Signal(_) => Type::Bool,
        }
    }
}

fn set((place, value): (Place, Expr)) -> Option<Update> {
    match place.slot {
        Leaf::Local(_) | Leaf::Signal(_) => None,
        Leaf::Own(_) | Leaf::Shared(_) => Some(Update::Assign { place, value }),
    }
}
