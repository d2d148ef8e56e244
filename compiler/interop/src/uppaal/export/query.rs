//! Queries: formulas over the processes of the network.

use hrdsl_ir::ta::{Query, QueryFormula, QueryKind, QueryMeasure};

use super::{
    UppaalExporter,
    expr::{UppaalExprContext, UppaalExprText, UppaalPrecedence, UppaalTextResult},
    slots::UppaalSlotTable,
};
use crate::exchange::obstacle::ExportObstacle;

impl UppaalExporter<'_> {
    /// Each query's formula and comment; and those that UPPAAL cannot ask.
    pub fn queries(&self, queries: &[&Query]) -> (Vec<(String, String)>, Vec<ExportObstacle>) {
        let context = self.network_context();
        let (mut asked, mut left_out) = (Vec::new(), Vec::new());
        for query in queries {
            match self.ask(&query.ask, &context) {
                Ok(formula) => {
                    let comment = if query.title.is_empty() { &query.name } else { &query.title };
                    asked.push((formula, comment.clone()));
                }
                Err(why) => {
                    let message = format!("the query `{}`: UPPAAL cannot say {why}", query.name);
                    left_out.push(ExportObstacle { origin: query.origin, message });
                }
            }
        }
        (asked, left_out)
    }

    /// Variables and clocks as formulas number them: shared ones, then those of each automaton.
    fn network_context(&self) -> UppaalExprContext {
        let mut all = self.global.clone();
        for (context, process) in self.contexts.iter().zip(&self.processes) {
            let prefix = format!("{process}.");
            let shared = self.global.slots.slots.len();
            let mut own = UppaalSlotTable {
                slots: context.slots.slots[shared..].to_vec(),
                groups: context.slots.groups.iter().filter(|g| g.first >= shared).cloned().collect(),
            };
            own.groups.iter_mut().for_each(|g| g.first -= shared);
            all.slots.append(own.prefixed(&prefix));
            let clocks = context.clocks.iter().skip(self.global.clocks.len());
            all.clocks.extend(clocks.map(|c| prefix.clone() + c));
        }
        let named =
            |(process, of): (&String, &Vec<String>)| of.iter().map(|l| format!("{process}.{l}")).collect();
        all.locations = self.processes.iter().zip(&self.locations).map(named).collect();
        all
    }

    fn ask(&self, ask: &QueryKind, context: &UppaalExprContext) -> UppaalTextResult<String> {
        let formula = |f: &QueryFormula| self.formula(f, context);
        Ok(match ask {
            QueryKind::Possibly(f) => format!("E<> {}", formula(f)?.text),
            QueryKind::Invariantly(f) => format!("A[] {}", formula(f)?.text),
            QueryKind::PotentiallyAlways(f) => format!("E[] {}", formula(f)?.text),
            QueryKind::Eventually(f) => format!("A<> {}", formula(f)?.text),
            QueryKind::LeadsTo(f, g) => format!("{} --> {}", formula(f)?.text, formula(g)?.text),
            QueryKind::Sup { of, when } => self.bound("sup", of, when, context)?,
            QueryKind::Inf { of, when } => self.bound("inf", of, when, context)?,
        })
    }

    fn bound(
        &self,
        word: &str,
        of: &[QueryMeasure],
        when: &QueryFormula,
        context: &UppaalExprContext,
    ) -> UppaalTextResult<String> {
        let when = if when.is_always() {
            String::new()
        } else {
            format!("{{{}}}", self.formula(when, context)?.text)
        };
        let measure = |m: &QueryMeasure| match m {
            QueryMeasure::Clock(id) => context
                .clocks
                .get(usize::from(id.0))
                .cloned()
                .ok_or("a clock that is not known here".to_owned()),
            QueryMeasure::Data(e) => context.expr(e, None).map(|t| t.text),
        };
        Ok(format!(
            "{word}{when}: {}",
            of.iter().map(measure).collect::<UppaalTextResult<Vec<_>>>()?.join(", ")
        ))
    }

    fn formula(
        &self,
        formula: &QueryFormula,
        context: &UppaalExprContext,
    ) -> UppaalTextResult<UppaalExprText> {
        let joined = |all: &[QueryFormula], sign: &str, level: UppaalPrecedence, none: &str| {
            let parts = all.iter().map(|f| self.formula(f, context).map(|t| t.at(level)));
            let parts = parts.collect::<UppaalTextResult<Vec<_>>>()?;
            Ok(match parts.as_slice() {
                [] => UppaalExprText::new(none, UppaalPrecedence::Atom),
                [_] => self.formula(&all[0], context)?,
                _ => UppaalExprText::new(parts.join(sign), level),
            })
        };
        match formula {
            QueryFormula::At { automaton, location } => {
                let at = usize::from(*automaton);
                let name = self.locations.get(at).and_then(|l| l.get(usize::from(location.0)));
                let name = name.ok_or("a location that is not known here")?;
                Ok(UppaalExprText::new(format!("{}.{name}", self.processes[at]), UppaalPrecedence::Atom))
            }
            QueryFormula::Data(e) => context.expr(e, None),
            QueryFormula::Clock(c) => {
                Ok(UppaalExprText::new(context.constraint(c)?, UppaalPrecedence::Order))
            }
            QueryFormula::Deadlock => Ok(UppaalExprText::new("deadlock", UppaalPrecedence::Atom)),
            QueryFormula::Not(f) => Ok(UppaalExprText::new(
                format!("!{}", self.formula(f, context)?.at(UppaalPrecedence::Unary)),
                UppaalPrecedence::Unary,
            )),
            QueryFormula::And(all) => joined(all, " && ", UppaalPrecedence::And, "true"),
            QueryFormula::Or(all) => joined(all, " || ", UppaalPrecedence::Or, "false"),
        }
    }
}
