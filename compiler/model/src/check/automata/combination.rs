//! `reach each value of …`, `each pair of …`, `each combination of …`: what of a network suites by search ask values of.

use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, ItemSyntaxKind, MethodSyntax, NameSyntax, SuiteMemberKind};

use super::query::QueryNetwork;
use crate::check::{automata::phase::AutomataPhase, state::phase::CheckPhase, template::CheckerPhase};
use crate::{
    CombinationKind, InferredType, NetworkId, Type, TypedCombinationCondition, TypedCombinations,
    TypedCombinedTerm, TypedExpr, TypedExprKind, Value, noun::Noun, report::coverage::bad_suite,
};

/// The most goals of one line. Each may become a test.
const MOST_COMBINATIONS: usize = 1_000;

/// `each value of`, `each pair of`, `each combination of`
const KINDS: [(&str, CombinationKind); 3] = [
    ("value", CombinationKind::Value),
    ("pair", CombinationKind::Pair),
    ("combination", CombinationKind::All),
];

impl AutomataPhase<'_, '_> {
    /// Checks what suites by search ask values of.
    pub(super) fn combinations(&mut self) {
        for (item, span) in self.each_item() {
            let ItemSyntaxKind::Suite(suite) = item else { continue };
            let MethodSyntax::Search(name) = &suite.method else { continue };
            if !self.source.looks_at(CheckPhase::Suites, span) {
                continue;
            }
            // A network that is not there has its diagnostic with the suite.
            let Some(network) = self.networks.table.get(&name.text).map(NetworkId) else { continue };
            for member in &suite.members {
                let SuiteMemberKind::ReachEachOf { what, terms, when } = &member.kind else { continue };
                let found = self.combination(network, (what, terms, when.as_ref()), member.span);
                self.networks.combinations.extend(found.map(|found| (member.span, found)));
            }
        }
    }

    fn combination(
        &mut self,
        network: NetworkId,
        (what, terms, when): (&NameSyntax, &[ast::ExprSyntax], Option<&ast::ExprSyntax>),
        span: Span,
    ) -> Option<TypedCombinations> {
        let how = self.choice(Noun::Combination, what, &KINDS.map(|k| k.0)).map(|i| KINDS[i].1);
        let mut net = self.net(network);
        let known: Vec<Option<TypedCombinedTerm>> =
            terms.iter().map(|term| self.combined_term(term, &mut net)).collect();
        let formula = when.map(|when| (self.formula(when, &mut net), when.span));
        if let Some((formula, at)) = &formula
            && formula.asks_deadlock()
        {
            let message = "`deadlock` is nothing that a test comes to";
            self.report(bad_suite(*at, message, "`hrdsl prove` answers it"));
            return None;
        }
        let when = formula.map(|(formula, text)| TypedCombinationCondition { text, formula });
        let all = TypedCombinations { how: how?, terms: known.into_iter().collect::<Option<_>>()?, when };
        self.few_enough(&all, what, span).then_some(all)
    }

    /// Whether there are two things to pair, and no more goals than a suite can have.
    fn few_enough(&mut self, all: &TypedCombinations, what: &NameSyntax, span: Span) -> bool {
        if all.how == CombinationKind::Pair && all.terms.len() < 2 {
            let message = "a pair is of the values of two things";
            self.report(bad_suite(span, message, "name another one, or write `reach each value of …`"));
            return false;
        }
        let count = all.count();
        if count > MOST_COMBINATIONS {
            let message = format!("these are {count} goals, and one line has at most {MOST_COMBINATIONS}");
            let help = match all.how {
                CombinationKind::All => "name fewer, or write `reach each pair of …`",
                CombinationKind::Value | CombinationKind::Pair => "name fewer, or something of fewer values",
            };
            self.report(bad_suite(span, message, help).label(what.span, "each of them may need a test"));
        }
        count <= MOST_COMBINATIONS
    }

    /// Something of a network that has few values, with these.
    fn combined_term(&mut self, term: &ast::ExprSyntax, net: &mut QueryNetwork) -> Option<TypedCombinedTerm> {
        if !self.data_names(term, net) {
            return None;
        }
        let value = self.expr_of(term, InferredType::Unknown, &mut net.values);
        let values = self.values_of(&value, net)?;
        Some(TypedCombinedTerm { text: term.span, value, values })
    }

    fn values_of(&mut self, value: &TypedExpr, net: &QueryNetwork) -> Option<Vec<Value>> {
        let whole = |lo: i64, hi: i64| {
            let few = hi.checked_sub(lo).is_some_and(|n| n < MOST_COMBINATIONS as i64);
            few.then(|| (lo..=hi).map(Value::Int).collect::<Vec<_>>()).ok_or((lo, hi))
        };
        let (message, help) = match value.ty {
            InferredType::Unknown => return None,
            InferredType::Bool => return Type::Bool.domain(),
            InferredType::Enum(e) => return Type::Enum(e).domain(),
            InferredType::Int => match range_of(value, net).map(|(lo, hi)| whole(lo, hi)) {
                Some(Ok(values)) => return Some(values),
                Some(Err((lo, hi))) => (
                    format!(
                        "it has the values {lo}..{hi}, and one line has at most {MOST_COMBINATIONS} goals"
                    ),
                    "ask what matters of it, as in `n > 3`, or give the variable a smaller type",
                ),
                None => (
                    "its values cannot be listed".to_owned(),
                    "name a variable, whose type says its values, or ask something that is true or false",
                ),
            },
            InferredType::Float(_) | InferredType::Text | InferredType::List(_) => (
                "its values cannot be listed".to_owned(),
                "ask something that is true or false, as in `x > 3`",
            ),
        };
        self.report(bad_suite(value.span, message, help));
        None
    }
}

/// The range of a variable, or of an element of an array of them.
fn range_of(value: &TypedExpr, net: &QueryNetwork) -> Option<(i64, i64)> {
    let leaf = match &value.kind {
        TypedExprKind::Leaf(leaf) => *leaf,
        TypedExprKind::Element(place) => place.slot,
        TypedExprKind::Const(_)
        | TypedExprKind::Term(_)
        | TypedExprKind::Unary(..)
        | TypedExprKind::Binary(..)
        | TypedExprKind::If(..)
        | TypedExprKind::Call(..)
        | TypedExprKind::List(..)
        | TypedExprKind::Apply(..)
        | TypedExprKind::Error => return None,
    };
    let scopes = [&net.values.own, &net.values.shared];
    let mut names = scopes.into_iter().flat_map(|scope| scope.names.values());
    names.find(|local| local.leaf == Some(leaf)).and_then(|local| local.range)
}
