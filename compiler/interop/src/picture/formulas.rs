//! Requirements that are formulas as pictures: the operators that execute them, each with its window, from the atoms up to what is asked of the run.

use std::fmt::Write;

use hrdsl_ir::{
    Nanos, Program,
    formula::{FormulaAtomKind, MetricFormula, MetricGoal, MonitorFormula},
};

use super::{lines, quoted};
use crate::exchange::time::seconds;

/// The inside of a formula's cluster: a node for each operator and atom, and arrows from what it reads.
pub(super) fn formula_dot(program: &Program, cluster: usize, formula: &MonitorFormula) -> String {
    let mut picture =
        FormulaPicture { program, cluster, formula, out: String::new(), nodes: 0, has_windows: false };
    picture.goal(&formula.goal);
    picture.note();
    picture.out
}

struct FormulaPicture<'a> {
    program: &'a Program,
    cluster: usize,
    formula: &'a MonitorFormula,
    out: String,
    nodes: usize,
    has_windows: bool,
}

impl FormulaPicture<'_> {
    fn goal(&mut self, goal: &MetricGoal) -> usize {
        let (word, of) = match goal {
            MetricGoal::And(a, b) | MetricGoal::Or(a, b) => {
                let word = if matches!(goal, MetricGoal::And(..)) { "and" } else { "or" };
                let parts = [self.goal(a), self.goal(b)];
                return self.node(vec![word.to_owned()], ", peripheries = 2", &parts);
            }
            MetricGoal::Now(a) => ("at the first moment", vec![a]),
            MetricGoal::Always(a) => ("at every moment", vec![a]),
            MetricGoal::Eventually(a) => ("at some moment", vec![a]),
            MetricGoal::Until(a, b) => ("the first at every moment before the second", vec![a, b]),
            MetricGoal::Release(a, b) => ("the second up to the first, or always", vec![a, b]),
        };
        let parts: Vec<usize> = of.into_iter().map(|f| self.formula(f)).collect();
        self.node(vec![word.to_owned()], ", peripheries = 2", &parts)
    }

    fn formula(&mut self, formula: &MetricFormula) -> usize {
        let word = match formula {
            MetricFormula::Constant(truth) => truth.to_string(),
            MetricFormula::Atom(atom) => self.atom(*atom),
            MetricFormula::Not(_) => "not".to_owned(),
            MetricFormula::And(..) => "and".to_owned(),
            MetricFormula::Or(..) => "or".to_owned(),
            MetricFormula::Implies(..) => "implies".to_owned(),
            MetricFormula::Once(w, _) => format!("once{}", w.text()),
            MetricFormula::Historically(w, _) => format!("historically{}", w.text()),
            MetricFormula::Since(w, ..) => format!("since{}", w.text()),
            MetricFormula::Eventually(w, _) => format!("eventually{}", w.text()),
            MetricFormula::Always(w, _) => format!("always{}", w.text()),
            MetricFormula::Until(w, ..) => format!("until{}", w.text()),
        };
        self.has_windows |= matches!(
            formula,
            MetricFormula::Once(..)
                | MetricFormula::Historically(..)
                | MetricFormula::Since(..)
                | MetricFormula::Eventually(..)
                | MetricFormula::Always(..)
                | MetricFormula::Until(..)
        );
        let parts: Vec<usize> = formula.operands().into_iter().map(|f| self.formula(f)).collect();
        let later = formula.horizon();
        let known = (later > 0).then(|| format!("known {} later", seconds(later)));
        self.node(std::iter::once(word).chain(known).collect(), "", &parts)
    }

    fn atom(&self, atom: usize) -> String {
        self.formula.atoms.get(atom).map_or_else(String::new, |atom| match &atom.what {
            FormulaAtomKind::Happens(pattern) => self.program.pattern_text(pattern),
            FormulaAtomKind::Less { .. } | FormulaAtomKind::Equal { .. } | FormulaAtomKind::Holds(_) => {
                atom.text.clone()
            }
        })
    }

    /// What there is to say of how it is executed, and why it is no automaton as the others are.
    fn note(&mut self) {
        let horizon: Nanos = self.formula.goal.horizon();
        let delay = if horizon > 0 {
            format!("What it says of a moment is known {} later.", seconds(horizon))
        } else {
            "What it says of a moment is known at that moment.".to_owned()
        };
        let why = if self.has_windows {
            "No automaton with one clock: each window keeps the changes inside it."
        } else {
            "Its operators are what executes it, and not an automaton."
        };
        let label = lines(vec![why.to_owned(), delay]);
        let _ = writeln!(self.out, "    n{}_note [shape = note, label = {label}]", self.cluster);
    }

    fn node(&mut self, label: Vec<String>, more: &str, parts: &[usize]) -> usize {
        let (cluster, node) = (self.cluster, self.nodes);
        self.nodes += 1;
        let label = if let [only] = label.as_slice() { quoted(only) } else { lines(label) };
        let _ = writeln!(self.out, "    n{cluster}_{node} [label = {label}{more}]");
        for part in parts {
            let _ = writeln!(self.out, "    n{cluster}_{part} -> n{cluster}_{node}");
        }
        node
    }
}
