//! Assignments of edges: what may be assigned, and clocks.

use hrdsl_syntax::ast::{self, AccessSyntax, NameSyntax};

use crate::check::{
    automata::{automaton::EdgeScope, clock::is_clock, phase::AutomataPhase},
    state::scope::{ExprEnv, LocalName},
    template::CheckerPhase,
};
use crate::{
    BinaryOp, Type, TypedExpr, TypedLvalue, TypedUpdate, VariableRef, noun::Noun, report::automata,
    types::TypeLayout,
};

impl AutomataPhase<'_, '_> {
    /// `target = value`: one update for each single value.
    pub(in crate::check) fn update(
        &mut self,
        scope: &EdgeScope,
        (target, access): (&NameSyntax, &[AccessSyntax]),
        op: Option<BinaryOp>,
        value: &ast::ExprSyntax,
        env: &mut ExprEnv,
        updates: &mut Vec<TypedUpdate>,
    ) {
        if is_clock(target, env) {
            return updates.extend(self.set_clock((target, access), op, value, scope, env));
        }
        self.refer(target, env.place_of(&target.text));
        let slot = env.find(&target.text).map(|l| l.leaf);
        if env.layout(&target.text) == Some(&TypeLayout::Unknown) {
            return;
        }
        let layout = match slot {
            Some(Some(leaf @ (VariableRef::Own(_) | VariableRef::Shared(_)))) => {
                TypeLayout::Scalar(self.type_of(scope, leaf))
            }
            Some(Some(VariableRef::Local(_) | VariableRef::Signal(_)) | None) => {
                return self.report(automata::bound_by_edge(&target.text, target.span));
            }
            None => match env.layout(&target.text) {
                Some(layout) if self.bound_by_edge(&target.text, layout, env) => {
                    return self.report(automata::bound_by_edge(&target.text, target.span));
                }
                Some(layout) => layout.clone(),
                None => {
                    let vars = env.all().filter(|l| !matches!(l.leaf, Some(VariableRef::Local(_))));
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
    fn bound_by_edge(&self, name: &str, layout: &TypeLayout, env: &ExprEnv) -> bool {
        let mut leaves = Vec::new();
        self.leaves(name, layout, &mut leaves);
        let own = |l: &LocalName| matches!(l.leaf, Some(VariableRef::Own(_) | VariableRef::Shared(_)));
        !leaves.iter().all(|(name, _)| env.find(name).is_some_and(own))
    }

    fn type_of(&self, scope: &EdgeScope, leaf: VariableRef) -> Type {
        match leaf {
            VariableRef::Own(i) => self.s.automata[scope.index].vars[usize::from(i)].ty(),
            VariableRef::Shared(i) => self.s.shared[usize::from(i)].ty(),
            VariableRef::Local(_) | VariableRef::Signal(_) => Type::Bool,
        }
    }
}

fn set((place, value): (TypedLvalue, TypedExpr)) -> Option<TypedUpdate> {
    match place.slot {
        VariableRef::Local(_) | VariableRef::Signal(_) => None,
        VariableRef::Own(_) | VariableRef::Shared(_) => Some(TypedUpdate::Assign { place, value }),
    }
}
