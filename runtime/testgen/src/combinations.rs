//! Goals over the values that several things of a network have at once.

use hrdsl_ir::{
    Expr, Value,
    expr::BinaryOp,
    suite::{CombinationKind, ValueCombinations},
    ta::QueryFormula,
};
use hrdsl_results::SuiteGoalId;
use hrdsl_ta::GoalKind;

use crate::{covers::WitnessedGoal, named::NamedGoal};

/// A goal for each combination, the values of the first term changing slowest.
pub fn combinations(all: &ValueCombinations) -> Vec<NamedGoal> {
    let chosen = all.chosen();
    chosen.iter().flat_map(|terms| tuples(all, terms).into_iter().map(|tuple| goal(all, &tuple))).collect()
}

/// Each choice of one value of each of these terms: the term's place, and the value.
fn tuples(all: &ValueCombinations, terms: &[usize]) -> Vec<Vec<(usize, Value)>> {
    let mut tuples: Vec<Vec<(usize, Value)>> = vec![Vec::new()];
    for term in terms {
        let values = &all.terms[*term].values;
        let extend = |tuple: &Vec<(usize, Value)>| {
            let tuple = tuple.clone();
            values
                .iter()
                .map(move |value| [tuple.as_slice(), &[(*term, *value)]].concat())
                .collect::<Vec<_>>()
        };
        tuples = tuples.iter().flat_map(extend).collect();
    }
    tuples
}

fn goal(all: &ValueCombinations, tuple: &[(usize, Value)]) -> NamedGoal {
    let is = |(term, value): &(usize, Value)| {
        let of = all.terms[*term].value.clone();
        QueryFormula::Data(Expr::binary(BinaryOp::Eq, of, Expr::Const(*value)))
    };
    let condition = all.when.iter().map(|when| when.formula.clone());
    let formula = QueryFormula::And(condition.chain(tuple.iter().map(is)).collect());
    let named: Vec<String> =
        tuple.iter().map(|(term, value)| format!("{} = {value}", all.terms[*term].text)).collect();
    let when = all.when.as_ref().map_or_else(String::new, |when| format!(" when {}", when.text));
    let name = format!("{}{when}", named.join(", "));
    let id = match all.how {
        CombinationKind::Value => SuiteGoalId::Value(name),
        CombinationKind::Pair | CombinationKind::All => SuiteGoalId::Combination(name),
    };
    let shown = WitnessedGoal::State(Box::new(formula.clone()));
    NamedGoal::one(id, GoalKind::Formula(formula), false, shown)
}

#[cfg(test)]
mod tests {
    use hrdsl_ir::suite::{CombinationCondition, CombinedTerm};

    use super::*;

    fn names(how: CombinationKind, when: Option<&str>) -> Vec<String> {
        let term = |text: &str, slot, values: Vec<Value>| CombinedTerm {
            text: text.into(),
            value: Expr::Var(slot),
            values,
        };
        let bools = || vec![Value::Bool(false), Value::Bool(true)];
        let terms = vec![
            term("n", 0, (0..3).map(Value::Int).collect()),
            term("a", 1, bools()),
            term("b", 2, bools()),
        ];
        let when = when
            .map(|text| CombinationCondition { text: text.into(), formula: QueryFormula::And(Vec::new()) });
        let all = ValueCombinations { how, terms, when };
        let goals = combinations(&all);
        assert_eq!(goals.len(), all.count());
        goals.into_iter().map(|goal| goal.id.to_string()).collect()
    }

    #[test]
    fn values_pairs_and_tuples_are_counted_out() {
        let values = names(CombinationKind::Value, None);
        assert_eq!(values.len(), 3 + 2 + 2);
        assert_eq!((values[0].as_str(), values[6].as_str()), ("value n = 0", "value b = true"));
        let pairs = names(CombinationKind::Pair, None);
        assert_eq!(pairs.len(), 3 * 2 + 3 * 2 + 2 * 2);
        assert_eq!(pairs[11], "combination n = 2, b = true");
        let all = names(CombinationKind::All, Some("A.there"));
        assert_eq!(all.len(), 12);
        assert_eq!(all[1], "combination n = 0, a = false, b = true when A.there");
    }
}
