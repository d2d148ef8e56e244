//! Requirements that are formulas as pictures: automata, where they are; else the operators that execute them, each with its window, from the atoms up to what is
//! asked of the run, and what keeps them from being one.

use std::fmt::Write;

use hrdsl_ir::{
    Nanos, Program,
    formula::{FormulaAtomKind, MetricFormula, MetricGoal, MonitorFormula},
    monitor::MonitorOutcome,
};

use super::{lines, quoted};
use crate::{
    automaton::{FormulaAutomaton, automaton_of},
    exchange::time::seconds,
};

/// The inside of a formula's cluster: its automaton, or a node for each operator and atom, and arrows from what it reads.
pub(super) fn formula_dot(program: &Program, cluster: usize, formula: &MonitorFormula) -> String {
    let obstacle = match automaton_of(formula) {
        Ok(automaton) => return automaton_dot(cluster, &automaton),
        Err(obstacle) => obstacle,
    };
    let mut picture = FormulaPicture { program, cluster, formula, out: String::new(), nodes: 0 };
    picture.goal(&formula.goal);
    picture.note(obstacle);
    picture.out
}

/// States with what a run comes to that ends in them; those that leave the run open have a second border.
fn automaton_dot(cluster: usize, automaton: &FormulaAutomaton) -> String {
    let mut out = format!("    n{cluster}_start [shape = point]\n");
    for (number, state) in automaton.states.iter().enumerate() {
        let label = lines(vec![state.name.clone(), format!("({})", state.outcome)]);
        let is_open = state.outcome == MonitorOutcome::Inconclusive;
        let double = if is_open { ", peripheries = 2" } else { "" };
        let _ = writeln!(out, "    n{cluster}_{number} [label = {label}{double}]");
    }
    let _ = writeln!(out, "    n{cluster}_start -> n{cluster}_0");
    for edge in &automaton.edges {
        let clock = |clock: &usize| automaton.clocks.get(*clock).map(|name| format!("{name} = 0"));
        let resets: Vec<String> = edge.resets.iter().filter_map(clock).collect();
        let resets = (!resets.is_empty()).then(|| resets.join("; "));
        let label = lines(std::iter::once(edge.text.clone()).chain(resets).collect());
        let _ = writeln!(out, "    n{cluster}_{} -> n{cluster}_{} [label = {label}]", edge.from, edge.to);
    }
    out
}

struct FormulaPicture<'a> {
    program: &'a Program,
    cluster: usize,
    formula: &'a MonitorFormula,
    out: String,
    nodes: usize,
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
    fn note(&mut self, obstacle: String) {
        let horizon: Nanos = self.formula.goal.horizon();
        let delay = if horizon > 0 {
            format!("What it says of a moment is known {} later.", seconds(horizon))
        } else {
            "What it says of a moment is known at that moment.".to_owned()
        };
        let why = format!("No automaton. {obstacle}");
        let label = lines(vec![why, delay]);
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
