//! The bodies of stimuli: samples, emitted events, and what is done to the world.

use hrdsl_ir::Unit;
use hrdsl_source::Span;
use hrdsl_syntax::ast::{self, ExprSyntaxKind as Syntax, NameSyntax, SampleRange, StimulusStepKind as Step};

use crate::check::state::phase::CheckPhase;
use crate::check::{checker::NOBODY, state::scope::ExprEnv, value::measure::text};
use crate::check::{template::CheckerPhase, world::phase::WorldPhase};
use crate::{
    ActorId, BinaryOp, BodyMotion, BodyRef, Dimension, EventId, FigureId, GripperId, InferredType, Type,
    TypedExpr, TypedPoint, TypedSample, TypedStimulus, TypedStimulusStep, TypedWorldAction, Value,
    noun::Noun,
    report::{names, roles, types, world},
    types::TypeLayout,
};

const ACTIONS: [&str; 6] = ["move_to", "look_at", "grasp", "let_go", "walk_to", "turn_to"];

impl WorldPhase<'_, '_> {
    pub(super) fn stimuli(&mut self, stimuli: &[Option<&ast::StimulusSyntax>]) {
        for (index, body) in stimuli.iter().enumerate() {
            if let Some(body) = body
                && self.source.looks_at(CheckPhase::Stimuli, body.name.span)
            {
                let resolved = self.stimulus(index, body);
                self.s.events[index].stimulus = Some(resolved);
            }
        }
    }

    fn stimulus(&mut self, index: usize, stimulus: &ast::StimulusSyntax) -> TypedStimulus {
        let mut env = ExprEnv { noun: Some(Noun::Parameter), ..ExprEnv::default() };
        let fields = self.events.fields[index].clone();
        for (syntax, (_, layout)) in stimulus.params.iter().zip(fields.iter()) {
            self.add_local(&mut env, &syntax.name, Noun::Parameter, layout);
        }
        let by = self.s.events[index].from;
        let mut samples = Vec::new();
        let steps = self.steps(&stimulus.body, by, &mut samples, &mut env, true);
        TypedStimulus { samples, steps }
    }

    fn steps(
        &mut self,
        steps: &[ast::StimulusStepSyntax],
        by: ActorId,
        samples: &mut Vec<TypedSample>,
        env: &mut ExprEnv,
        top: bool,
    ) -> Vec<TypedStimulusStep> {
        let mut resolved = Vec::new();
        for step in steps {
            match &step.kind {
                Step::Sample { name, range } => {
                    if !top {
                        let issue = types::no_value("a `sample` in one branch only", step.span);
                        self.report(issue.help("draw it before the `if`; its range can be conditional"));
                    }
                    self.sample(name, range, samples, env);
                }
                Step::Emit(call) => resolved.extend(self.emit(call, by, env)),
                Step::Hold(time) => {
                    let seconds = self.expr_of(time, InferredType::Float(Dimension::TIME), env);
                    resolved.push(TypedStimulusStep::Hold { seconds });
                }
                Step::Act { path, args } => {
                    resolved.extend(self.act(path, args, step.span, env).map(TypedStimulusStep::Act));
                }
                Step::If { condition, then, otherwise } => {
                    let condition = self.expr_of(condition, InferredType::Bool, env);
                    let then = self.steps(then, by, samples, env, false);
                    let otherwise = self.steps(otherwise, by, samples, env, false);
                    resolved.push(TypedStimulusStep::If { condition, then, otherwise });
                }
                Step::Error => {}
            }
        }
        resolved
    }

    fn sample(
        &mut self,
        name: &NameSyntax,
        range: &SampleRange,
        samples: &mut Vec<TypedSample>,
        env: &mut ExprEnv,
    ) {
        let mut bounds = Vec::new();
        let (lo, hi) = self.sample_range(range, env, &mut bounds);
        let ty = match lo.ty {
            InferredType::Int => {
                let ints = |b: &Value| if let Value::Int(n) = b { Some(*n) } else { None };
                let numbers: Vec<i64> = bounds.iter().filter_map(ints).collect();
                let (lo, hi) = (numbers.iter().min().copied(), numbers.iter().max().copied());
                Type::Int { lo: lo.unwrap_or(0), hi: hi.unwrap_or(0) }
            }
            InferredType::Float(dim) => Type::Float(dim.unit()),
            InferredType::Bool
            | InferredType::Enum(_)
            | InferredType::Text
            | InferredType::List(_)
            | InferredType::Unknown => Type::Float(Unit::None),
        };
        if lo.ty == InferredType::Unknown {
            // Its range has a diagnostic; nothing follows from its type.
            self.check_free(env, Noun::Sample, name);
            env.push_local(&name.text, name.span, Noun::Sample, InferredType::Unknown);
        } else {
            self.add_local(env, name, Noun::Sample, &TypeLayout::Scalar(ty));
            // Its dimension may have no unit of its own.
            if let Some(local) = env.locals.last_mut() {
                local.ty = lo.ty;
            }
        }
        self.s.names.infer(name.span, lo.ty.to_string());
        samples.push(TypedSample { name: name.text.clone(), ty, lo, hi });
    }

    /// The two ends, each perhaps conditional; `bounds` collects the constant ends.
    fn sample_range(
        &mut self,
        range: &SampleRange,
        env: &mut ExprEnv,
        bounds: &mut Vec<Value>,
    ) -> (TypedExpr, TypedExpr) {
        match range {
            SampleRange::Plain(range) => {
                let lo = self.expr(&range.lo, env);
                let Some(hi) = &range.hi else {
                    self.report(
                        types::no_value("a range without an upper end", range.span).help("write `lo .. hi`"),
                    );
                    return (TypedExpr::error(range.span), TypedExpr::error(range.span));
                };
                let hi = self.expr_of(
                    hi,
                    if lo.ty == InferredType::Int { InferredType::Unknown } else { lo.ty },
                    env,
                );
                let lo =
                    self.fit(lo, if hi.ty == InferredType::Int { InferredType::Unknown } else { hi.ty }, env);
                for end in [&lo, &hi] {
                    if !end.ty.is_number() {
                        let want = InferredType::Float(Dimension::NUMBER);
                        self.report(types::mismatch(want, end.ty, None, end.span));
                    }
                }
                self.ordered(&lo, &hi, range.span);
                if lo.ty == InferredType::Int && (lo.constant().is_none() || hi.constant().is_none()) {
                    self.report(types::not_constant(range.span));
                }
                bounds.extend(lo.constant().into_iter().chain(hi.constant()));
                (lo, hi)
            }
            SampleRange::If { condition, then, otherwise } => {
                let condition = self.expr_of(condition, InferredType::Bool, env);
                let then = self.sample_range(then, env, bounds);
                let otherwise = self.sample_range(otherwise, env, bounds);
                let lo = self.conditional(condition.clone(), then.0, otherwise.0, condition.span, env);
                let known = self.issues.list.len();
                let hi = self.conditional(condition.clone(), then.1, otherwise.1, condition.span, env);
                if lo.ty == InferredType::Unknown {
                    // The same clash of the upper ends need not be said again.
                    self.issues.list.truncate(known);
                }
                (lo, hi)
            }
        }
    }

    fn emit(&mut self, call: &ast::CallSyntax, by: ActorId, env: &mut ExprEnv) -> Option<TypedStimulusStep> {
        let event: EventId = self.event(Noun::Event, &call.name, None)?;
        let from = self.s.events[usize::from(event.0)].from;
        if from != by && from != NOBODY && by != NOBODY {
            let (owner, actor) = (self.actor_name(from), self.actor_name(by));
            let issue = roles::emits_for_other(&call.name.text, owner, actor, call.name.span);
            let own: Vec<&str> = self
                .s
                .events
                .iter()
                .filter(|e| e.from == by && e.stimulus.is_none())
                .map(|e| e.name.as_str())
                .collect();
            let issue = names::with_nearest(issue, Noun::Event, &call.name.text, own);
            self.report(issue);
        }
        let fields = self.fields_of(event);
        Some(TypedStimulusStep::Emit { event, args: self.args(Noun::Event, call, &fields, env) })
    }

    fn act(
        &mut self,
        path: &ast::PathSyntax,
        args: &[ast::ExprSyntax],
        span: Span,
        env: &mut ExprEnv,
    ) -> Option<TypedWorldAction> {
        let (action, of) = path.names.split_last()?;
        let chosen = self.choice(Noun::Action, action, &ACTIONS)?;
        if of.is_empty() {
            let help = format!("write `BODY.{}(…)`", action.text);
            self.report(names::missing(action.span, "an action needs something that acts", help));
            return None;
        }
        let want = [2, 4, 0, 0, 2, 1][chosen];
        // A walk can go on to more points.
        let is_walk = chosen == 4 && args.len() > want;
        if args.len() != want && !is_walk {
            let issue = types::counts(Noun::Action, &action.text, want, args.len(), span);
            let usage =
                ["POINT, TIME", "BODY, OFFSET, DISTANCE, ANGLE", "", "", "POINT, SPEED", "POINT"][chosen];
            self.report(issue.help(format!("write `{}.{}({usage})`", text(of), action.text)));
            return None;
        }
        match chosen {
            0 => {
                let body = self.movable(of);
                let to = self.point(&args[0], env);
                let over = self.expr_of(&args[1], InferredType::Float(Dimension::TIME), env);
                Some(TypedWorldAction::Move { body: body?, to: to?, over })
            }
            1 => {
                let body = self.movable(of);
                let at = self.body_arg(&args[0], "");
                let offset = self.expr_of(&args[1], InferredType::Float(Dimension::LENGTH), env);
                let distance = self.expr_of(&args[2], InferredType::Float(Dimension::LENGTH), env);
                let angle = self.expr_of(&args[3], InferredType::Float(Dimension::ANGLE), env);
                Some(TypedWorldAction::Look { body: body?, at: at?, offset, distance, angle })
            }
            2 => self
                .world_name(Noun::Gripper, of, "")
                .map(|g| TypedWorldAction::Grasp { gripper: GripperId(g) }),
            3 => self
                .world_name(Noun::Gripper, of, "")
                .map(|g| TypedWorldAction::LetGo { gripper: GripperId(g) }),
            4 => {
                let figure = self.figure_named(of);
                let (speed, points) = args.split_last()?;
                let along: Vec<Option<TypedPoint>> = points.iter().map(|p| self.point(p, env)).collect();
                let speed = self.expr_of(speed, InferredType::Float(Dimension::SPEED), env);
                let along = along.into_iter().collect::<Option<_>>();
                Some(TypedWorldAction::Walk { figure: figure?, along: along?, speed })
            }
            _ => {
                let (figure, to) = (self.figure_named(of), self.point(&args[0], env));
                Some(TypedWorldAction::Turn { figure: figure?, to: to? })
            }
        }
    }

    /// A figure by its name, or by that of a part that has one: `guest` for `guest.self`.
    fn figure_named(&mut self, of: &[NameSyntax]) -> Option<FigureId> {
        let prefix = format!("{}.", text(of));
        let own = self.world.names.below(Noun::Figure, &prefix);
        if let [one] = own.as_slice()
            && self.world.names.is_instance(&text(of))
        {
            let full = format!("{prefix}{one}");
            if let Some(last) = of.last() {
                self.refer(last, self.world.names.instances.span_of(&text(of)));
            }
            return self.world.names.figures.get(&full).map(FigureId);
        }
        // Whoever mistypes the name of a part that has a figure means the part.
        if let [part] = of
            && self.world.names.kind_of(&part.text).is_none()
        {
            let figures = self.world.names.figures.names();
            let names: Vec<String> =
                figures.map(|name| name.rsplit_once('.').map_or(name, |(part, _)| part).to_owned()).collect();
            self.unknown(Noun::Figure, part, &names, None);
            return None;
        }
        self.world_name(Noun::Figure, of, "").map(FigureId)
    }

    /// A kinematic or guided body.
    fn movable(&mut self, names: &[NameSyntax]) -> Option<crate::BodyId> {
        let id = match self.body_ref(names, "")? {
            BodyRef::Body(id) => Some(id),
            BodyRef::Current(_) => None,
        };
        let body = id.and_then(|id| self.s.world.as_ref()?.bodies.get(usize::from(id.0)));
        match body {
            Some(body) if is_moved(body.motion) => id,
            Some(_) | None => {
                let span = names[0].span.to(names[names.len() - 1].span);
                let message =
                    format!("`{}` is neither kinematic nor guided: actions cannot move it", text(names));
                let world = self.s.world.as_ref();
                let moved = world.iter().flat_map(|w| &w.bodies).filter(|b| is_moved(b.motion));
                let near: Vec<&str> = moved.map(|b| b.name.as_str()).collect();
                let help = match near.as_slice() {
                    [] => "declare the body as `kinematic`, or as `guided` if it is somebody's".to_owned(),
                    _ => format!("actions move: `{}`", near.join("`, `")),
                };
                self.report(world::bad_world(span, message, help));
                None
            }
        }
    }

    /// A vector of three lengths, a body, a body plus such a vector, or a point that is brought into a box.
    fn point(&mut self, e: &ast::ExprSyntax, env: &mut ExprEnv) -> Option<TypedPoint> {
        match &e.kind {
            Syntax::Binary { op: op @ (BinaryOp::Add | BinaryOp::Sub), left, right }
                if self.is_body(left, env) =>
            {
                let of = self.body_arg(left, "");
                let offset = self.offset(right, *op == BinaryOp::Sub, env);
                Some(TypedPoint::free(Some(of?), offset?))
            }
            Syntax::Path(path) if self.is_body(e, env) => {
                let zero =
                    || TypedExpr::value(Value::Float(0.0), InferredType::Float(Dimension::LENGTH), path.span);
                Some(TypedPoint::free(Some(self.body_ref(&path.names, "")?), [zero(), zero(), zero()]))
            }
            Syntax::Tuple(_)
            | Syntax::Path(_)
            | Syntax::Index { .. }
            | Syntax::Field { .. }
            | Syntax::Binary { .. }
            | Syntax::Unary { .. }
            | Syntax::If { .. } => Some(TypedPoint::free(None, self.offset(e, false, env)?)),
            Syntax::Call { callee, args } if callee.names.len() == 1 && callee.names[0].text == CLAMP => {
                self.clamped(args, e.span, env)
            }
            Syntax::Error => None,
            Syntax::Bool(_)
            | Syntax::Int(_)
            | Syntax::Float(_)
            | Syntax::Quantity { .. }
            | Syntax::Text(_)
            | Syntax::List { .. }
            | Syntax::Strong(_)
            | Syntax::Annotated { .. }
            | Syntax::Internal(_)
            | Syntax::Unify { .. }
            | Syntax::Any
            | Syntax::Call { .. } => {
                self.report(not_a_point(e.span));
                None
            }
        }
    }

    /// `clamp(POINT, LOW, HIGH)`
    fn clamped(&mut self, args: &[ast::ExprSyntax], span: Span, env: &mut ExprEnv) -> Option<TypedPoint> {
        let [point, low, high] = args else {
            let issue = types::counts(Noun::Function, CLAMP, 3, args.len(), span);
            self.report(issue.help("write `clamp(POINT, LOW, HIGH)`, with two corners of a box"));
            return None;
        };
        let (point, low, high) = (self.point(point, env), self.point(low, env), self.point(high, env));
        let mut point = point?;
        point.within.push([low?, high?]);
        Some(point)
    }

    /// Whether a name means a body: it stands for no value.
    fn is_body(&self, e: &ast::ExprSyntax, env: &ExprEnv) -> bool {
        let Syntax::Path(path) = &e.kind else { return false };
        let first = &path.names[0].text;
        env.find(first).is_none() && env.layout(first).is_none() && !self.consts.contains_key(first.as_str())
    }

    fn offset(&mut self, e: &ast::ExprSyntax, negative: bool, env: &mut ExprEnv) -> Option<[TypedExpr; 3]> {
        let known = self.issues.list.len();
        let lengths = TypeLayout::Array(Box::new(TypeLayout::Scalar(Type::Float(Unit::Metre))), 3);
        let mut parts = Vec::new();
        self.item_for(e, &lengths, env).flatten(&mut parts);
        if negative {
            for part in &mut parts {
                let zero = TypedExpr::value(Value::Float(0.0), part.ty, part.span);
                let old = std::mem::replace(part, zero.clone());
                *part = self.operate(BinaryOp::Sub, zero, old, e.span, env);
            }
        }
        if let Some(issue) = self.issues.list.get_mut(known)
            && issue.help.is_none()
        {
            issue.help = not_a_point(e.span).help;
        }
        <[TypedExpr; 3]>::try_from(parts).ok()
    }
}

/// Brings a point into a box.
const CLAMP: &str = "clamp";

fn is_moved(motion: BodyMotion) -> bool {
    match motion {
        BodyMotion::Kinematic | BodyMotion::Guided => true,
        BodyMotion::Fixed | BodyMotion::Dynamic => false,
    }
}

fn not_a_point(span: Span) -> hrdsl_source::Diagnostic {
    types::no_value("this", span)
        .help("a point is `(1 m, 0 m, 0 m)`, a body, or a body plus such a vector: `leg + (5 cm, 0 m, 0 m)`")
}
