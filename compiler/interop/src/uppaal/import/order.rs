//! Assignments within expressions (`list[len++] = e`): each becomes one of its own, before or after.
//!
//! A variable that is changed so may not be read elsewhere in the same statement: which value it has there would depend on an order
//! that UPPAAL leaves open.

use hrdsl_source::Span;

use super::{
    ast::{UppaalBinaryOperator, UppaalExpr, UppaalExprKind, UppaalPlace},
    fault::{UppaalFault, fault},
    scope::{ScenarioExprText, UppaalSymbol},
    translation::UppaalTranslation,
};

/// What was taken out of an expression.
#[derive(Default)]
struct PulledEffects {
    before: Vec<UppaalExpr>,
    after: Vec<UppaalExpr>,
    /// The places that are assigned to, and where.
    changed: Vec<(UppaalExpr, Span)>,
    /// How many conditions stand before: what is evaluated only sometimes cannot be taken out.
    sometimes: usize,
}

impl UppaalTranslation<'_> {
    /// A statement without assignments within: those before go to `out`, and those after are given back.
    pub fn in_order(
        &mut self,
        e: &UppaalExpr,
        out: &mut Vec<String>,
    ) -> Result<(UppaalExpr, Vec<String>), UppaalFault> {
        let mut pulled = PulledEffects::default();
        let kind = match &e.kind {
            UppaalExprKind::Assign(op, to, value) => {
                let to = pull(to, &mut pulled)?;
                UppaalExprKind::Assign(*op, Box::new(to), Box::new(pull(value, &mut pulled)?))
            }
            UppaalExprKind::Step { up, first, of } => {
                UppaalExprKind::Step { up: *up, first: *first, of: Box::new(pull(of, &mut pulled)?) }
            }
            // Each of its sides is a statement.
            UppaalExprKind::Choice(..) => e.kind.clone(),
            _ => pull(e, &mut pulled)?.kind,
        };
        self.ordered(UppaalExpr { kind, span: e.span }, pulled, out)
    }

    /// The same of an expression that has a value.
    pub fn value_in_order(
        &mut self,
        e: &UppaalExpr,
        out: &mut Vec<String>,
    ) -> Result<(ScenarioExprText, Vec<String>), UppaalFault> {
        let mut pulled = PulledEffects::default();
        let e = pull(e, &mut pulled)?;
        let (e, after) = self.ordered(e, pulled, out)?;
        Ok((self.expr(&e)?, after))
    }

    fn ordered(
        &mut self,
        e: UppaalExpr,
        pulled: PulledEffects,
        out: &mut Vec<String>,
    ) -> Result<(UppaalExpr, Vec<String>), UppaalFault> {
        for (place, span) in &pulled.changed {
            let Some(name) = place.root() else { continue };
            let (mut count, mut called) = (0, Vec::new());
            e.each(&mut |part| match &part.kind {
                UppaalExprKind::Name(n) if n == name => count += 1,
                // Another field of the record is another variable. Of a field of that field it has been said already.
                UppaalExprKind::Field(of, _)
                    if part.root() == Some(name) && apart(part, place) && !apart(of, place) =>
                {
                    count -= 1;
                }
                UppaalExprKind::Call(of, _) => called.extend(of.root().map(str::to_owned)),
                _ => {}
            });
            if count > 1 || called.iter().any(|f| self.reads(f, name, 0)) {
                let message = format!(
                    "`{name}` is changed within this statement and read elsewhere in it: write the change as an assignment of its own"
                );
                return fault(*span, message);
            }
        }
        pulled.before.iter().try_for_each(|e| self.effect(e, out))?;
        let mut after = Vec::new();
        pulled.after.iter().try_for_each(|e| self.effect(e, &mut after))?;
        Ok((e, after))
    }

    /// Whether a function, or one that it calls, has the name in it.
    fn reads(&self, function: &str, name: &str, depth: usize) -> bool {
        let Some(UppaalSymbol::Function(function)) = self.find(function) else { return false };
        let (mut found, mut called) = (depth > 20, Vec::new());
        function.decl.body.iter().for_each(|s| {
            s.each(&mut |part| match &part.kind {
                UppaalExprKind::Name(n) => found |= n == name,
                UppaalExprKind::Call(of, _) => called.extend(of.root().map(str::to_owned)),
                _ => {}
            });
        });
        found || called.iter().any(|f| self.reads(f, name, depth + 1))
    }
}

/// Whether two places of one record lie in different fields of it.
fn apart(a: &UppaalExpr, b: &UppaalExpr) -> bool {
    fields(a).iter().zip(fields(b)).any(|(f, g)| *f != g)
}

/// The names of the fields on the way to a place. Which of them is in an array is the same for all places of a record.
fn fields(place: &UppaalExpr) -> Vec<&str> {
    match place.as_place() {
        Some(UppaalPlace::Field(of, name)) => {
            let mut all = fields(of);
            all.push(name);
            all
        }
        Some(UppaalPlace::Index(of, _)) => fields(of),
        Some(UppaalPlace::Name(_)) | None => Vec::new(),
    }
}

fn pull(e: &UppaalExpr, out: &mut PulledEffects) -> Result<UppaalExpr, UppaalFault> {
    let one = |e: &UppaalExpr, out: &mut PulledEffects| pull(e, out).map(Box::new);
    let sometimes = |e: &UppaalExpr, out: &mut PulledEffects| {
        out.sometimes += 1;
        let pulled = pull(e, out);
        out.sometimes -= 1;
        pulled.map(Box::new)
    };
    let kind = match &e.kind {
        UppaalExprKind::Step { of, .. } | UppaalExprKind::Assign(_, of, _) => {
            if out.sometimes > 0 {
                return fault(
                    e.span,
                    "an assignment in a part that is not always evaluated is not supported: write it as a statement of its own",
                );
            }
            out.changed.push(((**of).clone(), e.span));
            let is_after = matches!(e.kind, UppaalExprKind::Step { first: false, .. });
            if is_after {
                out.after.push(e.clone())
            } else {
                out.before.push(e.clone())
            }
            return Ok((**of).clone());
        }
        UppaalExprKind::Int(_)
        | UppaalExprKind::Bool(_)
        | UppaalExprKind::Name(_)
        | UppaalExprKind::Deadlock => e.kind.clone(),
        UppaalExprKind::Neg(of) => UppaalExprKind::Neg(one(of, out)?),
        UppaalExprKind::Not(of) => UppaalExprKind::Not(one(of, out)?),
        UppaalExprKind::Rate(of) => UppaalExprKind::Rate(one(of, out)?),
        UppaalExprKind::Field(of, name) => UppaalExprKind::Field(one(of, out)?, name.clone()),
        UppaalExprKind::Index(of, index) => UppaalExprKind::Index(one(of, out)?, one(index, out)?),
        UppaalExprKind::Binary(op, a, b) => {
            let a = one(a, out)?;
            let b = match op {
                UppaalBinaryOperator::And | UppaalBinaryOperator::Or | UppaalBinaryOperator::Imply => {
                    sometimes(b, out)?
                }
                _ => one(b, out)?,
            };
            UppaalExprKind::Binary(*op, a, b)
        }
        UppaalExprKind::Choice(c, a, b) => {
            UppaalExprKind::Choice(one(c, out)?, sometimes(a, out)?, sometimes(b, out)?)
        }
        UppaalExprKind::Quantified(q, name, ty, of) => {
            UppaalExprKind::Quantified(*q, name.clone(), ty.clone(), sometimes(of, out)?)
        }
        UppaalExprKind::Call(of, args) => {
            let args = args.iter().map(|a| pull(a, out)).collect::<Result<_, _>>()?;
            UppaalExprKind::Call(of.clone(), args)
        }
    };
    Ok(UppaalExpr { kind, span: e.span })
}
