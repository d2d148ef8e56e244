//! Figures: people, whose bodies go where one of them is sent, walk, reach, bow, give way and fall.
//!
//! Each step makes of what a figure does a posture, and of that where each of its bodies is to be: `walk` moves its feet, `build` knows
//! its measures, `balance` what pushes do to it. The bodies themselves are led there by springs (`physics/guide`), so that what holds
//! one back holds it back, and its neighbours follow.

mod balance;
mod build;
mod moment;
mod walk;

use hrdsl_ir::Nanos;
use hrdsl_ir::value::{nanos, seconds};
use hrdsl_ir::world::{BodyId, BodyMotion, Figure, World};

use crate::{
    error::SimulationError,
    math::{BodyFrame, SpaceVector, about, v3, wrap},
    mover::KinematicPath,
    physics::{PhysicsAdapter, bad, index},
};
use balance::{Balance, BalanceOutcome};
use build::{FigureBuild, FigurePosture};
use moment::FigureMoment;
use walk::WalkPlan;

/// From here on a figure that cannot follow waits, and here it waits for good, m.
const LAGS: f64 = 0.05;
const WAITS: f64 = 0.1;
/// How long it takes to lower the hands, and to rise, when one walks off, s.
const GATHERS: f64 = 0.5;
/// Whoever looks farther aside turns round, rad.
const NECK: f64 = 1.2;
/// No hand and no head is faster on the average, m/s.
const SWIFT: f64 = 2.0;
/// How much faster than on the average a smooth way is in its middle.
const PEAK: f64 = 1.875;

/// Where somebody stands, how turned, and how fast turning: m, m, rad, rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlanarStance {
    pub x: f64,
    pub y: f64,
    pub heading: f64,
    pub spin: f64,
}

/// Where a head or a hand is to be: on a way in the world, or in one of the figure's own frame.
#[derive(Clone, Copy, Debug)]
struct PartAim {
    in_world: bool,
    path: KinematicPath,
}

pub(crate) struct FigureControl {
    build: FigureBuild,
    stance: PlanarStance,
    ground: f64,
    /// How fast it walks and turns at most, m/s and rad/s.
    speed: f64,
    turn: f64,
    mass: f64,
    walk: Option<WalkPlan>,
    /// Its pelvis was sent somewhere, and all of it goes along.
    carried: Option<KinematicPath>,
    head: PartAim,
    /// It has walked up to something, and faces it.
    reaching: bool,
    /// By limb; of legs none.
    hands: Vec<Option<PartAim>>,
    balance: Balance,
    /// How far recovery steps have carried it off from where it was sent, m.
    pushed: SpaceVector,
    /// Its own time, which waits when it is held up.
    clock: Nanos,
    /// As it was in the last step, if its bodies had come to where they were to be then.
    settled: Option<FigureMoment>,
    has_fallen: bool,
}

impl FigureControl {
    pub fn new(
        figure: &Figure,
        world: &World,
        physics: &PhysicsAdapter,
    ) -> Result<FigureControl, SimulationError> {
        let what = || format!("figure `{}`", figure.name);
        let limbs = figure.limbs.iter().flat_map(|l| [l.of, l.upper, l.lower].into_iter().chain(l.end));
        for body in [figure.pelvis, figure.trunk, figure.head].into_iter().chain(limbs) {
            let Some(data) = world.bodies.get(index(body)) else {
                return Err(bad(what(), "body", index(body)));
            };
            if data.motion != BodyMotion::Guided {
                return Err(SimulationError::NotGuided { body: data.name.clone() });
            }
        }
        let positive = [figure.speed, figure.turn, figure.mass];
        let places = figure.limbs.iter().flat_map(|l| l.pivots.into_iter().flatten()).chain(figure.hip);
        if positive.iter().any(|x| !(x.is_finite() && *x > 0.0)) || !places.into_iter().all(f64::is_finite) {
            return Err(SimulationError::BadNumber { what: format!("a measure of {}", what()) });
        }
        let straight = |l: &hrdsl_ir::world::Limb| (v3(l.pivots[0]) - v3(l.pivots[1])).norm() > 1e-3;
        if !figure.limbs.iter().all(straight) {
            return Err(SimulationError::BadNumber { what: format!("the length of a limb of {}", what()) });
        }
        let (build, at) = FigureBuild::new(figure, physics);
        let ahead = at.x_axis();
        let heading = libm::atan2(ahead.y, ahead.x);
        let stance = PlanarStance { x: at.at.x, y: at.at.y, heading, spin: 0.0 };
        let here =
            |place: BodyFrame| PartAim { in_world: false, path: KinematicPath::new(place, place, 0, 0.0) };
        let hand = |limb: &build::LimbBuild| {
            limb.is_arm.then(|| here(BodyFrame::new(limb.rest, about(SpaceVector::z(), 0.0))))
        };
        let hands = build.limbs.iter().map(hand).collect();
        let gravity = v3(world.gravity).norm().max(1e-3);
        Ok(FigureControl {
            stance,
            ground: at.at.z,
            speed: figure.speed,
            turn: figure.turn,
            mass: figure.mass,
            walk: None,
            carried: None,
            head: here(build.head_at_rest()),
            reaching: false,
            hands,
            balance: Balance::new(figure.mass, build.hip, gravity),
            pushed: SpaceVector::zeros(),
            clock: 0,
            settled: None,
            has_fallen: false,
            build,
        })
    }

    /// Whether a body is one of its own.
    pub fn has(&self, body: BodyId) -> bool {
        self.bodies().any(|own| own == body)
    }

    fn bodies(&self) -> impl Iterator<Item = BodyId> + '_ {
        let limbs = self.build.limbs.iter().flat_map(|l| [l.upper, l.lower].into_iter().chain(l.end));
        [self.build.pelvis, self.build.trunk, self.build.head].into_iter().chain(limbs)
    }

    pub fn is_busy(&self) -> bool {
        let under_way = |aim: &PartAim| !aim.path.is_over(self.clock);
        !self.has_fallen
            && (self.walk.is_some()
                || self.carried.is_some()
                || under_way(&self.head)
                || self.hands.iter().flatten().any(under_way)
                || !self.balance.is_still())
    }

    // ── What it is told ──

    /// One of its bodies goes to a pose in so many seconds: the head, a hand, or the pelvis, which stands for all of it.
    ///
    /// # Errors
    /// That it is another of its bodies, which goes where the others take it.
    pub fn send(
        &mut self,
        body: BodyId,
        to: BodyFrame,
        over: f64,
        physics: &PhysicsAdapter,
    ) -> Result<(), SimulationError> {
        let (from, to) = (self.unpushed(physics.aim(body)), self.unpushed(to));
        if body == self.build.head {
            let far = level(to.at - from.at).norm();
            (self.walk, self.carried, self.reaching) = (None, None, false);
            let over = over.max(far * PEAK / self.speed);
            self.head = PartAim { in_world: true, path: KinematicPath::new(from, to, self.clock, over) };
        } else if body == self.build.pelvis || body == self.build.trunk {
            self.gather();
            let (here, there) = (self.feet(), level(to.at) + SpaceVector::z() * self.ground);
            let (from, to) = (BodyFrame::new(here, from.turn), BodyFrame::new(there, from.turn));
            let over = over.max(level(to.at - from.at).norm() * PEAK / self.speed);
            self.carried = Some(KinematicPath::new(from, to, self.clock, over));
        } else {
            let hand = self.build.limbs.iter().position(|limb| limb.is_arm && limb.end == Some(body));
            let Some(slot) = hand.and_then(|at| self.hands[at].as_mut()) else {
                return Err(SimulationError::GoesAlong { body: physics.name(body).to_owned() });
            };
            let over = over.max((to.at - from.at).norm() * PEAK / SWIFT);
            *slot = PartAim { in_world: true, path: KinematicPath::new(from, to, self.clock, over) };
            if let Some(at) = hand {
                self.step_up(at, to.at, physics);
            }
        }
        Ok(())
    }

    /// Whoever reaches for what is too far off, and looks at nothing meanwhile, walks up to it and bows.
    fn step_up(&mut self, hand: usize, place: SpaceVector, physics: &PhysicsAdapter) {
        let own = self.stance_frame();
        let limb = &self.build.limbs[hand];
        let upright = self.build.reaches(limb, (self.build.hip, 0.0), own.inverse().point(place));
        if upright && self.reaching {
            // What is near again is taken standing.
            self.reaching = false;
            gather_part(&mut self.head, &own, self.build.head_at_rest(), self.clock);
        }
        if upright || (self.head.in_world && !self.reaching) {
            return;
        }
        let way = level(place - own.at);
        if way.norm() < 1e-6 {
            return;
        }
        let (hip, lean, ahead, aside) = self.build.step_up(limb, place.z - self.ground);
        // The shoulder is to come up to the place on the way from here: so the feet pass beside it.
        let (far, off) = (way.norm(), aside.clamp(-way.norm(), way.norm()));
        let heading = libm::atan2(way.y, way.x) - libm::asin(off / far);
        let turn = about(SpaceVector::z(), heading);
        let feet = level(place) - turn * SpaceVector::new(ahead, aside, 0.0) + SpaceVector::z() * self.ground;
        let there = BodyFrame::new(feet + turn * self.build.head_at(hip, lean), turn);
        let from = self.unpushed(physics.aim(self.build.head));
        let over = level(there.at - from.at).norm() * PEAK / self.speed;
        (self.walk, self.carried, self.reaching) = (None, None, true);
        self.head =
            PartAim { in_world: true, path: KinematicPath::new(from, there, self.clock, over.max(GATHERS)) };
    }

    /// Walks along points, m.
    pub fn walk_along(&mut self, points: &[[f64; 2]], speed: f64) {
        self.gather();
        let pushed = self.pushed;
        let points: Vec<[f64; 2]> = points.iter().map(|p| [p[0] - pushed.x, p[1] - pushed.y]).collect();
        self.walk = Some(WalkPlan::along(&points, speed.min(self.speed)));
    }

    /// Turns on the spot until it faces a point, m.
    pub fn turn_to(&mut self, point: [f64; 2]) {
        self.gather();
        let (dx, dy) = (point[0] - self.pushed.x - self.stance.x, point[1] - self.pushed.y - self.stance.y);
        if dx != 0.0 || dy != 0.0 {
            self.walk = Some(WalkPlan::turn_to(libm::atan2(dy, dx)));
        }
    }

    /// Head and hands go along again, as they are when it stands.
    fn gather(&mut self) {
        (self.walk, self.carried, self.reaching) = (None, None, false);
        let frame = self.stance_frame();
        let rest = self.build.head_at_rest();
        gather_part(&mut self.head, &frame, rest, self.clock);
        for (aim, limb) in self.hands.iter_mut().zip(&self.build.limbs) {
            if let Some(aim) = aim {
                let rest = BodyFrame::new(limb.rest, about(SpaceVector::z(), 0.0));
                gather_part(aim, &frame, rest, self.clock);
            }
        }
    }

    // ── What it does ──

    /// Leads its bodies through the step from `now` to `next`.
    pub fn drive(&mut self, now: Nanos, next: Nanos, physics: &mut PhysicsAdapter) {
        if self.has_fallen {
            return;
        }
        let h = seconds(next - now);
        let push = self.push(h, physics);
        match self.balance.go_on(push, h) {
            BalanceOutcome::Stands(moved) => self.pushed += moved,
            BalanceOutcome::Falls => return self.fall(physics),
        }
        let passed = h * self.rate(physics);
        self.clock += nanos(passed);
        self.move_feet(passed);
        self.lead(h, physics);
    }

    /// What pushed it over the last step, N·s, level, less what it leans against.
    fn push(&self, h: f64, physics: &PhysicsAdapter) -> SpaceVector {
        let push: SpaceVector = self.bodies().map(|body| physics.level_impulse(body)).sum();
        let size = push.norm();
        if size == 0.0 {
            return push;
        }
        let leaned: SpaceVector = self.bodies().map(|body| level(physics.borne_by_rigid(body))).sum();
        let against = (-leaned.dot(&push) * h / size).clamp(0.0, size);
        push * (1.0 - against / size)
    }

    /// How much of its pace it keeps: less if its trunk or pelvis cannot follow.
    fn rate(&self, physics: &PhysicsAdapter) -> f64 {
        let behind = [self.build.pelvis, self.build.trunk].map(|body| level(physics.strayed(body)).norm());
        ((WAITS - behind[0].max(behind[1])) / (WAITS - LAGS)).clamp(0.0, 1.0)
    }

    fn move_feet(&mut self, passed: f64) {
        let head = self.head.in_world.then(|| self.head.path.at(self.clock));
        let facing = match (&self.walk, head) {
            (Some(walk), _) => walk.facing(&self.stance),
            (None, Some(head)) => Some(self.stance.heading + self.turned_from(&head)),
            (None, None) => None,
        };
        let turn = self.turn.min(SWIFT / self.swung().max(1e-3));
        self.stance.turn(facing, turn, passed);
        if let Some(walk) = &mut self.walk {
            walk.go_on(&mut self.stance, passed);
            if walk.is_over() {
                self.walk = None;
            }
        }
        if let Some(path) = self.carried {
            let at = path.at(self.clock).at;
            (self.stance.x, self.stance.y) = (at.x, at.y);
            if path.is_over(self.clock) {
                self.carried = None;
            }
        }
        if let Some(head) = head {
            let (_, _, ahead, _) = self.build.bow(self.head_height(&head));
            let aim = about(SpaceVector::z(), self.stance.heading) * SpaceVector::x() * -ahead + head.at;
            let (dx, dy) = (aim.x - self.stance.x, aim.y - self.stance.y);
            // Whoever turns with the head low goes round it: no faster than on any other way.
            let part = (self.speed * passed / libm::hypot(dx, dy).max(1e-9)).min(1.0);
            self.stance.x += dx * part;
            self.stance.y += dy * part;
        }
    }

    /// How far it has to turn yet to look as its head does, rad.
    fn turned_from(&self, head: &BodyFrame) -> f64 {
        let looks = head.x_axis();
        let aside = wrap(libm::atan2(looks.y, looks.x) - self.stance.heading);
        let neck = if self.reaching { 0.0 } else { NECK };
        (aside.abs() - neck).max(0.0).copysign(aside)
    }

    /// How high its head is to be above the ground, m: it bows to where it is turned, and no lower before.
    fn head_height(&self, head: &BodyFrame) -> f64 {
        let (height, upright) = (head.at.z - self.ground, self.build.head_at_rest().at.z);
        if !self.head.in_world || height >= upright {
            return height;
        }
        upright + (height - upright) * libm::cos(self.turned_from(head)).max(0.0)
    }

    /// How far from its axis it has a hand, if that turns with it, m.
    fn swung(&self) -> f64 {
        let own = self.stance_frame();
        let turning = self.hands.iter().flatten().filter(|hand| !hand.in_world);
        turning.map(|hand| level(hand.place(&own, self.clock).at - own.at).norm()).fold(0.0, f64::max)
    }

    /// Tells each body where it is to be at the end of the step, of `h` seconds.
    fn lead(&mut self, h: f64, physics: &mut PhysicsAdapter) {
        let now = self.moment(physics);
        if self.settled.as_ref().is_some_and(|settled| settled.is_same(&now)) {
            return;
        }
        let (own, (_, head), moved) = (now.own, now.head, now.strayed);
        let (hip, lean, ..) = self.build.bow(self.head_height(&head));
        let stance = BodyFrame::new(own.at + self.pushed, own.turn);
        let posture = FigurePosture { stance, sway: now.sway, hip, lean };
        let frames = self.build.frames(&posture);
        let mut aims: Vec<(BodyId, BodyFrame)> = Vec::with_capacity(3 + 3 * self.build.limbs.len());
        for (body, frame) in self.build.torso(&stance, &frames) {
            let is_head = body == self.build.head;
            aims.push((body, if is_head { BodyFrame::new(frame.at + moved, head.turn) } else { frame }));
        }
        for (limb, (aim, held_back)) in self.build.limbs.iter().zip(&now.limbs) {
            // A foot stays on the ground.
            let end = match aim {
                Some((true, place)) => place.at + self.pushed,
                Some((false, place)) => place.at + self.pushed + posture.sway,
                None => stance.point(limb.rest),
            };
            let led = |end: SpaceVector| self.build.limb(limb, &stance, &frames, end, moved);
            // A hand is drawn to where it should be; if something holds it back, its arm goes along with it, wherever it is.
            let [upper, lower, _] = led(end + held_back);
            aims.extend([upper, lower]);
            aims.extend(limb.end.map(|hand| (hand, led(end)[2].1)));
        }
        // Where a hand passes its own shoulder, or an elbow turns over, a posture would leap: limbs are no faster than hands beside the
        // trunk, and that no faster than they.
        let trunk = physics.aim(self.build.trunk).at;
        let mut carried = SpaceVector::zeros();
        for (body, frame) in aims {
            let from = physics.aim(body).at;
            let way = frame.at - from - carried;
            let part = (SWIFT * h / way.norm().max(1e-9)).min(1.0);
            let to = if part < 1.0 { from + carried + way * part } else { frame.at };
            physics.lead(body, &BodyFrame::new(to, frame.turn));
            if body == self.build.head {
                carried = physics.aimed(self.build.trunk).at - trunk;
            }
        }
        let is_there = |body: BodyId| physics.aim(body).is_same(&physics.aimed(body));
        let is_settled = self.bodies().all(is_there);
        self.settled = is_settled.then_some(now);
    }

    fn moment(&self, physics: &PhysicsAdapter) -> FigureMoment {
        let own = self.stance_frame();
        let place = |aim: &PartAim| (aim.in_world, aim.place(&own, self.clock));
        let limb = |(limb, aim): (&build::LimbBuild, &Option<PartAim>)| {
            let held_back = limb.end.map_or_else(SpaceVector::zeros, |hand| physics.strayed(hand));
            (aim.as_ref().map(place), held_back)
        };
        FigureMoment {
            own,
            pushed: self.pushed,
            sway: self.balance.sway(),
            strayed: physics.strayed(self.build.trunk),
            head: place(&self.head),
            limbs: self.build.limbs.iter().zip(&self.hands).map(limb).collect(),
        }
    }

    /// Falls for good: its bodies hang together at their joints, and nothing draws them.
    fn fall(&mut self, physics: &mut PhysicsAdapter) {
        self.has_fallen = true;
        let bodies: Vec<BodyId> = self.bodies().collect();
        let volumes: Vec<f64> = bodies.iter().map(|body| physics.volume(*body)).collect();
        let all: f64 = volumes.iter().sum();
        let masses: Vec<(BodyId, f64)> =
            bodies.iter().zip(&volumes).map(|(body, volume)| (*body, self.mass * volume / all)).collect();
        physics.let_fall(&masses);
        for (first, point, second) in self.build.pivots(physics) {
            physics.join_at(first, point, second);
        }
    }

    // ── Frames ──

    /// Its frame, without what pushes have done to it.
    fn stance_frame(&self) -> BodyFrame {
        BodyFrame::new(self.feet(), about(SpaceVector::z(), self.stance.heading))
    }

    fn feet(&self) -> SpaceVector {
        SpaceVector::new(self.stance.x, self.stance.y, self.ground)
    }

    fn unpushed(&self, frame: BodyFrame) -> BodyFrame {
        BodyFrame::new(frame.at - self.pushed, frame.turn)
    }
}

impl PartAim {
    fn place(&self, own: &BodyFrame, clock: Nanos) -> BodyFrame {
        let at = self.path.at(clock);
        if self.in_world { at } else { own.then(&at) }
    }
}

/// A part that was sent somewhere comes back to where it is at rest, on a way in the figure's frame.
fn gather_part(aim: &mut PartAim, own: &BodyFrame, rest: BodyFrame, clock: Nanos) {
    let now = own.inverse().then(&aim.place(own, clock));
    let over = if now == rest { 0.0 } else { GATHERS.max((rest.at - now.at).norm() * PEAK / SWIFT) };
    *aim = PartAim { in_world: false, path: KinematicPath::new(now, rest, clock, over) };
}

fn level(v: SpaceVector) -> SpaceVector {
    SpaceVector::new(v.x, v.y, 0.0)
}
