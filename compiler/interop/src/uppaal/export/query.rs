//! Queries: formulas over the processes of the network.

use hrdsl_ir::ta::{Ask, Formula, Measure, Query};

use super::{
    Exporter,
    expr::{Context, Level, Said, Text},
    slots::Slots,
};
use crate::exchange::obstacle::Obstacle;

impl Exporter<'_> {
    /// Each query's formula and comment; and those that UPPAAL cannot ask.
    pub fn queries(&self, queries: &[&Query]) -> (Vec<(String, String)>, Vec<Obstacle>) {
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
                    left_out.push(Obstacle { origin: query.origin, message });
                }
            }
        }
        (asked, left_out)
    }

    /// Variables and clocks as formulas number them: shared ones, then those of each automaton.
    fn network_context(&self) -> Context {
        let mut all = self.global.clone();
        for (context, process) in self.contexts.iter().zip(&self.processes) {
            let prefix = format!("{process}.");
            let shared = self.global.slots.slots.len();
            let mut own = Slots {
                slots: context.slots.slots[shared..].to_vec(),
                groups: context.slots.groups.iter().filter(|g| g.first >= shared).cloned().collect(),
            };
            own.groups.iter_mut().for_each(|g| g.first -= shared);
            all.slots.append(own.prefixed(&prefix));
            let clocks = context.clocks.iter().skip(self.global.clocks.len());
            all.clocks.extend(clocks.map(|c| prefix.clone() + c));
        }
        all
    }

    fn ask(&self, ask: &Ask, context: &Context) -> Said<String> {
        let formula = |f: &Formula| self.formula(f, context);
        Ok(match ask {
            Ask::Possibly(f) => format!("E<> {}", formula(f)?.text),
            Ask::Invariantly(f) => format!("A[] {}", formula(f)?.text),
            Ask::PotentiallyAlways(f) => format!("E[] {}", formula(f)?.text),
            Ask::Eventually(f) => format!("A<> {}", formula(f)?.text),
            Ask::LeadsTo(f, g) => format!("{} --> {}", formula(f)?.text, formula(g)?.text),
            Ask::Sup { of, when } => self.bound("sup", of, when, context)?,
            Ask::Inf { of, when } => self.bound("inf", of, when, context)?,
        })
    }

    fn bound(&self, word: &str, of: &[Measure], when: &Formula, context: &Context) -> Said<String> {
        let when = match when {
            Formula::And(all) if all.is_empty() => String::new(),
            Formula::Data(hrdsl_ir::Expr::Const(hrdsl_ir::Value::Bool(true))) => String::new(),
            Formula::At { .. }
            | Formula::Data(_)
            | Formula::Clock(_)
            | Formula::Deadlock
            | Formula::Not(_)
            | Formula::And(_)
            | Formula::Or(_) => format!("{{{}}}", self.formula(when, context)?.text),
        };
        let measure = |m: &Measure| match m {
            Measure::Clock(id) => context
                .clocks
                .get(usize::from(id.0))
                .cloned()
                .ok_or("a clock that is not known here".to_owned()),
            Measure::Data(e) => context.expr(e, None).map(|t| t.text),
        };
        Ok(format!("{word}{when}: {}", of.iter().map(measure).collect::<Said<Vec<_>>>()?.join(", ")))
    }

    fn formula(&self, formula: &Formula, context: &Context) -> Said<Text> {
        let joined = |all: &[Formula], sign: &str, level: Level, none: &str| {
            let parts = all.iter().map(|f| self.formula(f, context).map(|t| t.at(level)));
            let parts = parts.collect::<Said<Vec<_>>>()?;
            Ok(match parts.as_slice() {
                [] => Text::new(none, Level::Atom),
                [_] => self.formula(&all[0], context)?,
                _ => Text::new(parts.join(sign), level),
            })
        };
        match formula {
            Formula::At { automaton, location } => {
                let at = usize::from(*automaton);
                let name = self.locations.get(at).and_then(|l| l.get(usize::from(location.0)));
                let name = name.ok_or("a location that is not known here")?;
                Ok(Text::new(format!("{}.{name}", self.processes[at]), Level::Atom))
            }
            Formula::Data(e) => context.expr(e, None),
            Formula::Clock(c) => Ok(Text::new(context.constraint(c)?, Level::Order)),
            Formula::Deadlock => Ok(Text::new("deadlock", Level::Atom)),
            Formula::Not(f) => {
                Ok(Text::new(format!("!{}", self.formula(f, context)?.at(Level::Unary)), Level::Unary))
            }
            Formula::And(all) => joined(all, " && ", Level::And, "true"),
            Formula::Or(all) => joined(all, " || ", Level::Or, "false"),
        }
    }
}
