//! In what a sensor is worse than the truth: the clauses of signals, lasers, bases and arms.

use hrdsl_ir::{
    sensor::{ImperfectSensor, OdometryDrift, SensorNoise, SensorOutlier, SensorSource},
    value::nanos,
};
use hrdsl_source::Span;
use hrdsl_syntax::ast::{ExprSyntax, SensorClause, SensorClauseKind as Clause};

use crate::check::state::scope::ExprEnv;
use crate::check::{template::CheckerPhase, world::phase::WorldPhase};
use crate::{
    Dimension, InferredType, Type, TypedExpr,
    report::{types, world::bad_world},
};

/// Samples any closer together say no more, and a test would take them for ever.
const LEAST_PERIOD: f64 = 1e-4;

/// What can be wrong with a reading depends on what is read.
#[derive(Clone, Copy)]
pub(super) enum SensedKind {
    Quantity(Dimension),
    Truth,
    /// A number that is counted, or the value of an enumeration.
    Choice,
    Arm,
    Base,
    Laser,
}

impl SensedKind {
    pub fn of(ty: Type) -> Self {
        match ty {
            Type::Bool => SensedKind::Truth,
            Type::Float(unit) => SensedKind::Quantity(Dimension::of(unit)),
            Type::Int { .. } | Type::Enum(_) | Type::Text | Type::List(_) => SensedKind::Choice,
        }
    }

    /// What noise can be of.
    fn noisy(self) -> Vec<Dimension> {
        match self {
            SensedKind::Quantity(dim) => vec![dim],
            SensedKind::Laser => vec![Dimension::LENGTH],
            SensedKind::Arm | SensedKind::Base => {
                vec![Dimension::LENGTH, Dimension::ANGLE, Dimension::SPEED, Dimension::ANGULAR_SPEED]
            }
            SensedKind::Truth | SensedKind::Choice => Vec::new(),
        }
    }

    fn with_article(self) -> String {
        match self {
            SensedKind::Quantity(dim) => dim.to_string(),
            SensedKind::Truth => "a truth".into(),
            SensedKind::Choice => "a value that is counted or named".into(),
            SensedKind::Arm => "an arm".into(),
            SensedKind::Base => "a base".into(),
            SensedKind::Laser => "a laser".into(),
        }
    }

    /// A clause of the kind that fits.
    fn suggestion(self) -> &'static str {
        match self {
            SensedKind::Truth => "write `flip 1 %`: how likely it is read as the other one",
            SensedKind::Quantity(_) => "write `noise`, with the standard deviation",
            SensedKind::Choice => "write `dropout 1 %`: how likely a sample is missing",
            SensedKind::Arm => "write `noise 0.1 deg, 1 deg/s`, with the standard deviations",
            SensedKind::Base => "write `drift 2 cm, 1 deg`: how far it is off after 1 m, and after 1 rad",
            SensedKind::Laser => "write `noise 1 cm`, with the standard deviation along each beam",
        }
    }
}

impl WorldPhase<'_, '_> {
    pub(super) fn sensing(
        &mut self,
        clauses: &[SensorClause],
        kind: SensedKind,
        (name, source): (&str, SensorSource),
    ) {
        if clauses.is_empty() {
            return;
        }
        let mut sensor = ImperfectSensor {
            name: name.to_owned(),
            source,
            every: None,
            late: 0,
            noise: Vec::new(),
            drift: None,
            dropout: 0.0,
            flip: 0.0,
            outlier: None,
        };
        for (at, clause) in clauses.iter().enumerate() {
            let word = clause.kind.word();
            if clauses.iter().take(at).any(|before| before.kind == clause.kind) {
                let message = format!("a sensor has one `{word}` at most");
                self.report(bad_world(clause.span, message, "join the two, or take one away"));
            }
            match clause.kind {
                Clause::Noise => self.noise(clause, kind, &mut sensor.noise),
                Clause::Drift => sensor.drift = self.drift(clause, kind),
                Clause::Outlier => sensor.outlier = self.outlier(clause, kind, source),
                Clause::Every | Clause::Late | Clause::Dropout | Clause::Flip => {
                    let Some(value) = self.only_value(clause) else { continue };
                    self.simple_clause(clause, value, kind, &mut sensor);
                }
            }
        }
        self.world_mut().sensors.push(sensor);
    }

    fn only_value<'c>(&mut self, clause: &'c SensorClause) -> Option<&'c ExprSyntax> {
        if let Some(second) = clause.values.get(1) {
            let message = format!("`{}` has one value", clause.kind.word());
            self.report(bad_world(second.span, message, "take the others away"));
        }
        clause.values.first()
    }

    fn simple_clause(
        &mut self,
        clause: &SensorClause,
        value: &ExprSyntax,
        kind: SensedKind,
        sensor: &mut ImperfectSensor,
    ) {
        match clause.kind {
            Clause::Every => {
                let period = self.time(value, "the time between two samples", true);
                if period.is_some_and(|t| t < LEAST_PERIOD) {
                    self.report(types::must_be(
                        "the time between two samples",
                        "at least 0.1 ms",
                        value.span,
                    ));
                } else {
                    sensor.every = period.map(nanos);
                }
            }
            Clause::Late => {
                sensor.late = self.time(value, "the delay of a reading", false).map_or(0, nanos);
            }
            Clause::Dropout => sensor.dropout = self.probability(value).unwrap_or(0.0),
            Clause::Flip => {
                let flip = self.probability(value).unwrap_or(0.0);
                match kind {
                    SensedKind::Truth => sensor.flip = flip,
                    SensedKind::Quantity(_)
                    | SensedKind::Choice
                    | SensedKind::Arm
                    | SensedKind::Base
                    | SensedKind::Laser => self.misplaced(clause, kind),
                }
            }
            Clause::Noise | Clause::Drift | Clause::Outlier => {}
        }
    }

    /// `outlier 1 % in 0 m .. 5 m`; of a laser anywhere in its range, if nothing else is said.
    fn outlier(
        &mut self,
        clause: &SensorClause,
        kind: SensedKind,
        source: SensorSource,
    ) -> Option<SensorOutlier> {
        let probability = clause.values.first().and_then(|value| self.probability(value));
        let (dim, all) = match kind {
            SensedKind::Quantity(dim) => (dim, None),
            SensedKind::Laser => (Dimension::LENGTH, self.scanned(source)),
            SensedKind::Truth | SensedKind::Choice | SensedKind::Arm | SensedKind::Base => {
                self.misplaced(clause, kind);
                return None;
            }
        };
        let range = match &clause.range {
            Some(range) => {
                let ends =
                    self.ends(range, dim, "outliers are in a range", "write `outlier 1 % in 0 m .. 5 m`")?;
                let within = all.is_none_or(|(lo, hi): (f64, f64)| lo <= ends.0 && ends.1 <= hi);
                if !within {
                    let rule = "within what the laser measures: its `range`";
                    self.report(types::must_be("the range of outliers", rule, range.span));
                }
                Some(ends)
            }
            None => all,
        };
        let Some((lo, hi)) = range else {
            if clause.range.is_none() && matches!(kind, SensedKind::Quantity(_)) {
                let message = "nothing says where the outliers of a quantity are";
                self.report(bad_world(clause.span, message, "write a range behind it: `in 0 m .. 5 m`"));
            }
            return None;
        };
        Some(SensorOutlier { probability: probability?, lo, hi })
    }

    /// Between which distances a laser measures; `None`: that is in error.
    fn scanned(&self, source: SensorSource) -> Option<(f64, f64)> {
        let laser = self.s.world.as_ref()?.lasers.get(source.index())?;
        Some((laser.nearest, laser.farthest))
    }

    /// A clause that says nothing of what is read.
    fn misplaced(&mut self, clause: &SensorClause, kind: SensedKind) {
        let message = format!("`{}` says nothing of {}", clause.kind.word(), kind.with_article());
        self.report(bad_world(clause.span, message, kind.suggestion()));
    }

    fn probability(&mut self, e: &ExprSyntax) -> Option<f64> {
        let p = self.quantity_of(e, Dimension::NUMBER)?;
        if !(0.0..=1.0).contains(&p) {
            self.report(types::must_be("a probability", "at least 0 % and at most 100 %", e.span));
            return None;
        }
        Some(p)
    }

    fn noise(&mut self, clause: &SensorClause, kind: SensedKind, all: &mut Vec<SensorNoise>) {
        let dims = kind.noisy();
        if dims.is_empty() {
            self.misplaced(clause, kind);
            return;
        }
        for e in &clause.values {
            let Some((deviation, dim)) = self.deviation(e, "noise", &dims) else { continue };
            let unit = dim.unit();
            if all.iter().any(|known| known.unit == unit) {
                self.second_of(dim, "noise", e.span);
            } else {
                all.push(SensorNoise { unit, deviation });
            }
        }
    }

    fn drift(&mut self, clause: &SensorClause, kind: SensedKind) -> Option<OdometryDrift> {
        match kind {
            SensedKind::Base => {}
            SensedKind::Quantity(_)
            | SensedKind::Truth
            | SensedKind::Choice
            | SensedKind::Arm
            | SensedKind::Laser => {
                self.misplaced(clause, kind);
                return None;
            }
        }
        let (mut way, mut turn) = (None, None);
        for e in &clause.values {
            let dims = [Dimension::LENGTH, Dimension::ANGLE];
            let Some((deviation, dim)) = self.deviation(e, "drift", &dims) else { continue };
            let known = if dim == Dimension::LENGTH { &mut way } else { &mut turn };
            if known.replace(deviation).is_some() {
                self.second_of(dim, "drift", e.span);
            }
        }
        Some(OdometryDrift { way: way.unwrap_or(0.0), turn: turn.unwrap_or(0.0) })
    }

    fn second_of(&mut self, dim: Dimension, what: &str, span: Span) {
        let message = format!("a {what} has one value that is {dim} at most");
        self.report(bad_world(span, message, "take one away"));
    }

    /// A standard deviation, which says by its dimension what it is of.
    fn deviation(&mut self, e: &ExprSyntax, what: &str, dims: &[Dimension]) -> Option<(f64, Dimension)> {
        let dim = match dims {
            [only] => *only,
            several => {
                let found = self.expr_of(e, InferredType::Unknown, &mut ExprEnv::constants());
                let InferredType::Float(dim) = found.ty else {
                    return self.no_deviation(&found, what, several);
                };
                if !several.contains(&dim) {
                    return self.no_deviation(&found, what, several);
                }
                dim
            }
        };
        let deviation = self.quantity_of(e, dim)?;
        if deviation < 0.0 {
            let rule = format!("at least 0 {}", dim.symbol().unwrap_or_default());
            self.report(types::must_be("a standard deviation", rule.trim(), e.span));
            return None;
        }
        Some((deviation, dim))
    }

    fn no_deviation<T>(&mut self, found: &TypedExpr, what: &str, dims: &[Dimension]) -> Option<T> {
        if found.ty != InferredType::Unknown {
            let names: Vec<String> = dims.iter().map(ToString::to_string).collect();
            let rule = names.join(" or ");
            self.report(types::must_be(&format!("each value of `{what}`"), &rule, found.span));
        }
        None
    }

    /// A sensor measures the world, not what other sensors say of it.
    pub(super) fn senses_the_world(&mut self, clauses: &[SensorClause], value: &TypedExpr) {
        if let Some(first) = clauses.first()
            && self.depends_on_a_reading(value)
        {
            let message = "a signal that is made of readings is as they are, and has no faults of its own";
            self.report(bad_world(
                first.span,
                message,
                "leave them out, or name the signal itself: the truth",
            ));
        }
    }
}
