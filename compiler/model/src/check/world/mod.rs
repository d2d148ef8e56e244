//! The world: bodies, joints, devices, signals and rules.

mod arms;
pub(in crate::check) mod device;
pub(in crate::check) mod edge;
mod extent;
mod figure;
mod locate;
mod mobile;
pub(in crate::check) mod parts;
pub(in crate::check) mod phase;
mod placement;
mod posture;
pub(in crate::check) mod robot;
mod sensing;
pub(in crate::check) mod stimulus;

use hrdsl_ir::{sensor::SensorSource, world::RuleTrigger};
use hrdsl_source::Span;
use hrdsl_syntax::ast::{
    self, ItemSyntaxKind, NameSyntax, RuleTriggerSyntax as SyntaxRuleOn, WorldMember,
    WorldMemberKind as Member,
};

use crate::check::{
    state::{scope::ExprEnv, world::WorldNames},
    template::CheckerPhase,
    world::{
        parts::PlacedMember,
        phase::WorldPhase,
        placement::{angles, outright},
        sensing::SensedKind,
    },
};
use crate::{
    ActorId, BodyId, BodyMotion, BodyShape, CurrentBody, Dimension, GripperId, InferredType, SignalId,
    TypedWorldRule, Value,
    noun::Noun,
    report::{names, types, world::bad_world},
    world::{PartFrame, TypedBody, TypedSignal, TypedWorld},
};

const LENGTH: InferredType = InferredType::Float(Dimension::LENGTH);
const ANGLE: InferredType = InferredType::Float(Dimension::ANGLE);
const NUMBER: InferredType = InferredType::Float(Dimension::NUMBER);

type MemberPass<'c, 'a> = fn(&mut WorldPhase<'c, 'a>, &PlacedMember<'a>);

impl<'c, 'a> WorldPhase<'c, 'a> {
    pub(in crate::check) fn world(&mut self) {
        let mut found: Option<Span> = None;
        for (item, span) in self.each_item() {
            let ItemSyntaxKind::World(world) = item else { continue };
            if let Some(first) = found {
                self.report(names::twice("world", span, first));
                continue;
            }
            found = Some(span);
            self.build(&world.members, None, span);
        }
        self.unused_parts();
    }

    /// `alone` is the description of a part that is checked as if it stood alone in a world.
    fn build(&mut self, members: &'a [WorldMember], alone: Option<&'a WorldMember>, span: Span) {
        self.s.world = Some(TypedWorld {
            step: 0.01,
            sample: 0.05,
            gravity: [0.0, 0.0, -9.81],
            bodies: Vec::new(),
            joints: Vec::new(),
            arms: Vec::new(),
            grippers: Vec::new(),
            bases: Vec::new(),
            lasers: Vec::new(),
            limbs: Vec::new(),
            figures: Vec::new(),
            currents: Vec::new(),
            sensors: Vec::new(),
            signals: Vec::new(),
            rules: Vec::new(),
            parts: Vec::new(),
            span,
        });
        let mut placed = self.flatten(members, "", PartFrame::default(), None);
        if let Some(member) = alone {
            let given = self.templates.given.clone();
            placed.push(PlacedMember { given, ..PlacedMember::alone(member) });
        }
        self.robots.clear();
        // What is named first must exist first: by kind, not by place.
        let bodies: [MemberPass<'c, 'a>; 3] =
            [Self::described_bodies, Self::settings_and_bodies, Self::walls];
        for pass in bodies {
            self.pass(&placed, pass);
        }
        self.place_by_others(&mut placed);
        let passes: [MemberPass<'c, 'a>; 16] = [
            Self::of_descriptions,
            Self::described_joints,
            Self::joint,
            Self::mimic,
            Self::gripper,
            Self::arm,
            Self::described_postures,
            Self::posture,
            Self::base,
            Self::lasers,
            Self::limb,
            Self::figure,
            Self::settle,
            Self::current,
            Self::signals,
            Self::rules,
        ];
        for pass in passes {
            self.pass(&placed, pass);
        }
    }

    /// Checks all members for one of their kinds.
    fn pass(&mut self, placed: &[PlacedMember<'a>], check: MemberPass<'c, 'a>) {
        for p in placed {
            let outer = std::mem::replace(&mut self.templates.given, p.given.clone());
            let before = self.issues.list.len();
            check(self, p);
            self.templates.given = outer;
            if let Some((name, span)) = &p.instance {
                self.said_in(before, Some((name, *span)));
            }
        }
    }

    /// Parts of the scenario that the world does not use are checked as if they stood alone in a world.
    fn unused_parts(&mut self) {
        let own: Vec<&'a ast::PartSyntax> = self.source.items[self.source.from_modules..]
            .iter()
            .filter_map(|i| if let ItemSyntaxKind::Part(part) = &i.kind { Some(part) } else { None })
            .collect();
        for part in own {
            if self.s.names.is_used(part.name.span) {
                continue;
            }
            let kept_names = std::mem::take(&mut self.checker.world.names);
            // What is checked for itself counts, too.
            self.world.names.members = kept_names.members;
            let kept_world = self.s.world.take();
            let kept_robots = std::mem::take(&mut self.robots);
            let kept_flag = std::mem::replace(&mut self.world.exists, true);
            match &part.params {
                Some(params) => self.by_itself(params, |c| {
                    c.world.names = WorldNames::default();
                    c.build(&part.members, part.description.as_deref(), part.name.span);
                }),
                None => self.build(&part.members, part.description.as_deref(), part.name.span),
            }
            let members = self.world.names.members;
            self.world.names = kept_names;
            self.world.names.members = members;
            self.s.world = kept_world;
            self.robots = kept_robots;
            self.world.exists = kept_flag;
        }
    }

    pub(in crate::check) fn world_mut(&mut self) -> &mut TypedWorld {
        self.s.world.as_mut().expect("`build` has made it")
    }

    fn settings_and_bodies(&mut self, p: &PlacedMember<'a>) {
        let kind = &p.member.kind;
        if let Member::Body(body) = kind {
            self.body(p, body);
        }
        let of_the_world = matches!(kind, Member::Step(_) | Member::Sample(_) | Member::Gravity(_));
        if of_the_world && !p.prefix.is_empty() {
            let message = "a part has no step, sample or gravity of its own";
            self.report(bad_world(p.member.span, message, "write it in the `world`"));
            return;
        }
        if let Member::Step(e) = kind
            && let Some(t) = self.time(e, "the step", true)
        {
            self.world_mut().step = t;
        }
        if let Member::Sample(e) = kind
            && let Some(t) = self.time(e, "the sampling period", true)
        {
            self.world_mut().sample = t;
        }
        if let Member::Gravity(e) = kind
            && let Some(g) = self.vector(e, NUMBER)
        {
            self.world_mut().gravity = g;
        }
    }

    fn body(&mut self, p: &PlacedMember<'a>, body: &'a ast::BodySyntax) {
        let motion =
            match self.choice(Noun::Motion, &body.motion, &["fixed", "dynamic", "kinematic", "guided"]) {
                Some(1) => BodyMotion::Dynamic,
                Some(2) => BodyMotion::Kinematic,
                Some(3) => BodyMotion::Guided,
                Some(_) | None => BodyMotion::Fixed,
            };
        let shape = self.shape(body);
        let position = outright(&body.place).and_then(|at| self.vector(at, LENGTH)).unwrap_or_default();
        let rotation = angles(body.turn.as_ref()).and_then(|r| self.vector(r, ANGLE)).unwrap_or_default();
        let mass = body.mass.as_ref().and_then(|m| self.more_than_zero(m, Dimension::MASS, "a mass"));
        let stiffness =
            body.stiffness.as_ref().and_then(|k| self.more_than_zero(k, Dimension::STIFFNESS, "a stiffness"));
        let is_moved = matches!(motion, BodyMotion::Dynamic | BodyMotion::Guided);
        if is_moved && body.mass.is_none() {
            let message = format!("the {} body `{}` has no mass", body.motion.text, body.name.text);
            self.report(bad_world(body.name.span, message, "add `mass 1 kg`"));
        }
        let name = format!("{}{}", p.prefix, body.name.text);
        let (issues, table) = (&mut self.checker.issues, &mut self.checker.world.names.bodies);
        if issues.declare_as(table, Noun::Body, &name, body.name.span).is_some() {
            let body = TypedBody {
                name,
                motion,
                shape: shape.unwrap_or(BodyShape::Sphere { radius: 0.1 }),
                frame: p.frame,
                position,
                rotation,
                mass: mass.unwrap_or(0.0),
                stiffness,
                ghost: body.ghost,
                graspable: body.graspable,
                solid: None,
                own_name: None,
                span: p.member.span,
            };
            self.world_mut().bodies.push(body);
        }
    }

    fn shape(&mut self, body: &ast::BodySyntax) -> Option<BodyShape> {
        let shapes = ["box", "sphere", "capsule", "cylinder"];
        let usage = ["box(X, Y, Z)", "sphere(RADIUS)", "capsule(RADIUS, LENGTH)", "cylinder(RADIUS, LENGTH)"];
        let chosen = self.choice(Noun::Shape, &body.shape, &shapes)?;
        let want = [3, 1, 2, 2][chosen];
        if body.sizes.len() != want {
            let span = body.shape.span;
            let issue = types::counts(Noun::Shape, &body.shape.text, want, body.sizes.len(), span);
            self.report(issue.help(format!("write `{}`", usage[chosen])));
            return None;
        }
        let sizes: Vec<Option<f64>> =
            body.sizes.iter().map(|e| self.more_than_zero(e, Dimension::LENGTH, "a size")).collect();
        let size = |i: usize| sizes[i];
        Some(match chosen {
            0 => BodyShape::Box { size: [size(0)?, size(1)?, size(2)?] },
            1 => BodyShape::Sphere { radius: size(0)? },
            2 => BodyShape::Capsule { radius: size(0)?, length: size(1)? },
            _ => BodyShape::Cylinder { radius: size(0)?, length: size(1)? },
        })
    }

    pub(super) fn local_body(&mut self, name: &NameSyntax, prefix: &str) -> Option<BodyId> {
        self.world_name(Noun::Body, std::slice::from_ref(name), prefix).map(BodyId)
    }

    /// The two ends of a range of quantities, the lower first.
    pub(super) fn ends(
        &mut self,
        range: &ast::RangeSyntax,
        dim: Dimension,
        one: &str,
        help: &str,
    ) -> Option<(f64, f64)> {
        let lo = self.quantity_of(&range.lo, dim);
        let Some(hi) = &range.hi else {
            self.report(bad_world(range.span, one, help));
            return None;
        };
        let (lo, hi) = (lo?, self.quantity_of(hi, dim)?);
        if lo > hi {
            self.report(types::empty_range(Value::Float(lo), Value::Float(hi), range.span));
        }
        Some((lo, hi))
    }

    fn current(&mut self, p: &PlacedMember<'a>) {
        let Member::Current { name, of, by } = &p.member.kind else { return };
        let bodies = of.iter().filter_map(|path| self.world_name(Noun::Body, &path.names, &p.prefix));
        let of: Vec<BodyId> = bodies.map(BodyId).collect();
        let by = self.world_name(Noun::Gripper, &by.names, &p.prefix).map_or(GripperId(0), GripperId);
        let full = format!("{}{}", p.prefix, name.text);
        if let Some(id) = self.world.names.bodies.get(&full) {
            let first = self.world.names.bodies.span(id);
            self.report(names::duplicate(Noun::Body, &full, name.span, first));
        }
        let (issues, table) = (&mut self.checker.issues, &mut self.checker.world.names.currents);
        if issues.declare_as(table, Noun::Current, &full, name.span).is_some() {
            self.world_mut().currents.push(CurrentBody { name: full, of, by });
        }
    }

    /// An arm's joints follow each other from the base to the tip.
    fn signals(&mut self, p: &PlacedMember<'a>) {
        let Member::Signal { name, ty, to, value, sensing } = &p.member.kind else { return };
        self.check_free(&ExprEnv::constants(), Noun::Signal, name);
        let to: Vec<ActorId> = to.iter().filter_map(|a| self.actor(a)).collect();
        let ty = self.ty(ty).filter(|of| {
            self.plain(&crate::types::TypeLayout::Scalar(*of), &name.text, crate::resolution::type_span(ty))
        });
        let mut env = ExprEnv::measured(&p.prefix);
        let value = match ty {
            Some(ty) => self.expr_for(value, ty, &mut env),
            None => self.expr(value, &mut env),
        };
        self.senses_the_world(sensing, &value);
        let full = format!("{}{}", p.prefix, name.text);
        let (issues, table) = (&mut self.checker.issues, &mut self.checker.world.names.signals);
        if let Some(id) = issues.declare_as(table, Noun::Signal, &full, name.span) {
            if ty.is_none() {
                self.world.names.broken.insert(full.clone());
            }
            if let Some(ty) = ty {
                self.sensing(sensing, SensedKind::of(ty), (&full, SensorSource::Signal(SignalId(id))));
            }
            let ty = ty.unwrap_or(crate::Type::Bool);
            self.world_mut().signals.push(TypedSignal { name: full, ty, to, value, span: p.member.span });
        }
    }

    fn rules(&mut self, p: &PlacedMember<'a>) {
        let Member::Rule(rule) = &p.member.kind else { return };
        let on = match &rule.on {
            SyntaxRuleOn::Event(call) if self.is_edge(call) => self.edge_of(call, &p.prefix),
            SyntaxRuleOn::Event(call) if self.says_misspelt_edge(call) => None,
            SyntaxRuleOn::Event(call) => {
                let mut patterns = self.patterns(std::slice::from_ref(call)).into_iter();
                let first = patterns.next();
                if patterns.next().is_some() {
                    self.report(types::several_events(&call.name.text, call.span));
                }
                first.map(RuleTrigger::Event)
            }
            SyntaxRuleOn::Commanded { command, device } => self
                .commanded(command, device, &p.prefix)
                .map(|(body, command)| RuleTrigger::Commanded { device: self.device_id(body), command }),
        };
        let mut env = ExprEnv::measured(&p.prefix);
        let guard = rule.when.as_ref().map(|e| self.expr_of(e, InferredType::Bool, &mut env));
        let Some(event) = self.event(Noun::Event, &rule.emit.name, None) else { return };
        let fields = self.fields_of(event);
        let args = self.args(Noun::Event, &rule.emit, &fields, &mut env);
        if let Some(on) = on {
            let origin = p.member.span;
            self.world_mut().rules.push(TypedWorldRule {
                on,
                guard,
                event,
                args,
                signals: Vec::new(),
                origin,
            });
        }
    }
}
