//! Imperfect sensors: when their readings come, what is wrong with them, and that it is the same whoever reads them.

mod common;
use common::*;
use hrdsl_ir::{
    Expr, Nanos, Type, Unit, Value,
    device::DeviceBody,
    device_state::DeviceState,
    expr::BinaryOp,
    sensor::{ImperfectSensor, OdometryDrift, SensorNoise, SensorOutlier, SensorSource},
    world::*,
};
use hrdsl_sim::{MotorCommand, WorldSimulation};
use proptest::prelude::*;

const MS: Nanos = 1_000_000;
const X: SignalId = SignalId(0);
const BEYOND: SignalId = SignalId(1);

/// A ball that somebody moves about over a floor, a wall, and a platform that drives, with a laser.
fn hall(sensors: Vec<ImperfectSensor>) -> World {
    let mut world = table();
    world.bodies = vec![
        body("ball", BodyMotion::Kinematic, BodyShape::Sphere { radius: 0.1 }, [0.0, 5.0, 1.0], 1.0),
        body("wall", BodyMotion::Fixed, cuboid(0.2, 9.0, 2.0), [3.1, 0.0, 0.0], 1.0),
        body("platform", BodyMotion::Kinematic, cuboid(0.2, 0.2, 0.2), [0.0, 0.0, 0.1], 1.0),
    ];
    (world.joints, world.arms, world.grippers) = (Vec::new(), Vec::new(), Vec::new());
    world.currents = Vec::new();
    world.bases.push(Base {
        name: "wheels".into(),
        body: BodyId(2),
        max_speed: 1.0,
        max_sideways: 0.0,
        max_turn: 1.0,
        acceleration: 2.0,
        timeout: None,
    });
    world.lasers.push(Laser {
        name: "eye".into(),
        body: BodyId(2),
        at: [0.0, 0.0, 0.05],
        lo: -0.2,
        hi: 0.2,
        beams: 21,
        nearest: 0.1,
        farthest: 10.0,
    });
    world.sensors = sensors;
    world
}

fn signals() -> Vec<Signal> {
    let x = SignalTerm::Coordinate(BodyRef::Body(BodyId(0)), Axis::X);
    let value = Expr::binary(BinaryOp::Gt, Expr::Var(0), Expr::float(0.5));
    vec![number("x", x), signal("beyond", Type::Bool, vec![x], value)]
}

fn exact(name: &str, source: SensorSource) -> ImperfectSensor {
    let (every, late, noise, drift, dropout, flip) = (None, 0, Vec::new(), None, 0.0, 0.0);
    let outlier = None;
    ImperfectSensor { name: name.into(), source, every, late, noise, drift, dropout, flip, outlier }
}

fn of_x() -> ImperfectSensor {
    exact("x", SensorSource::Signal(X))
}

fn metres(deviation: f64) -> Vec<SensorNoise> {
    vec![SensorNoise { unit: Unit::Metre, deviation }]
}

fn running(sensors: Vec<ImperfectSensor>, seed: u64) -> WorldSimulation {
    WorldSimulation::new(&hall(sensors), &signals()).unwrap().seeded(seed).unwrap()
}

/// The ball goes 1 m along x in 2 s, from 300 ms on.
fn moving(sensors: Vec<ImperfectSensor>, seed: u64) -> WorldSimulation {
    let mut sim = running(sensors, seed);
    sim.advance(300 * MS + 3);
    let to = at(None, [1.0, 5.0, 1.0]);
    sim.act(&WorldAction::Move { body: BodyId(0), to, over: Expr::float(2.0) }, &none).unwrap();
    sim
}

fn reading(sim: &WorldSimulation, signal: SignalId) -> f64 {
    sim.reading(signal).as_f64().unwrap()
}

/// What is true at a time.
fn truth_at(time: Nanos) -> f64 {
    let mut sim = if time < 300 * MS + 3 { running(Vec::new(), 0) } else { moving(Vec::new(), 0) };
    sim.advance(time.max(0));
    float(&sim, 0)
}

#[test]
fn a_late_reading_is_what_was_to_the_nanosecond() {
    let late = 50 * MS + 1;
    let mut sim = moving(vec![ImperfectSensor { late, ..of_x() }], 1);
    for time in [300 * MS + 4, 350 * MS, 360 * MS + 3, 360 * MS + 4, 1_000 * MS, 2_360 * MS, 9_000 * MS] {
        sim.advance(time);
        assert_eq!(reading(&sim, X), truth_at(time - late), "at {time}");
    }
    // The physics steps 10 ms after the ball was set in motion: one nanosecond decides.
    let step = 600 * MS + 3;
    let mut sim = moving(vec![ImperfectSensor { late, ..of_x() }], 1);
    sim.advance(step + late - 1);
    let before = reading(&sim, X);
    sim.advance(step + late);
    assert!(before == truth_at(step - 1) && reading(&sim, X) == truth_at(step) && before != truth_at(step));
}

#[test]
fn a_sampled_reading_is_that_of_the_newest_sample_that_has_come() {
    let sensor = ImperfectSensor { every: Some(100 * MS), late: 20 * MS, ..of_x() };
    let mut sim = moving(vec![sensor], 1);
    for time in (310..2700).step_by(37).map(|ms| ms * MS) {
        sim.advance(time);
        let sample = (time - 20 * MS).div_euclid(100 * MS) * 100 * MS;
        assert_eq!(reading(&sim, X), truth_at(sample), "at {time}");
    }
    assert_eq!(reading(&running(vec![ImperfectSensor { late: MS, ..of_x() }], 1), X), 0.0, "as at the start");
}

#[test]
fn the_truth_stays_what_it_is() {
    let sensor = ImperfectSensor { noise: metres(0.5), dropout: 0.5, late: 70 * MS, ..of_x() };
    let mut sim = moving(vec![sensor], 4);
    for time in (310..2700).step_by(111).map(|ms| ms * MS) {
        sim.advance(time);
        assert_eq!(float(&sim, 0), truth_at(time));
    }
}

#[test]
fn noise_and_dropout_are_as_large_as_is_said() {
    let (n, period) = (20_000, 10 * MS);
    let of_beyond = exact("beyond", SensorSource::Signal(BEYOND));
    let noisy = ImperfectSensor { every: Some(period), noise: metres(0.02), dropout: 0.1, ..of_x() };
    let mut sim = running(vec![noisy, ImperfectSensor { every: Some(period), flip: 0.03, ..of_beyond }], 5);
    let mut seen: Vec<(f64, bool)> = Vec::new();
    for sample in 1..=n {
        sim.advance(sample * period);
        seen.push((reading(&sim, X), sim.reading(BEYOND) == Value::Bool(true)));
    }
    let count = n as f64;
    let mean = seen.iter().map(|(x, _)| x).sum::<f64>() / count;
    let deviation = (seen.iter().map(|(x, _)| (x - mean).powi(2)).sum::<f64>() / count).sqrt();
    // A sample that is lost shows the one before, to the bit.
    let lost = seen.windows(2).filter(|w| w[0].0 == w[1].0).count() as f64 / count;
    let flipped = seen.iter().filter(|(_, flipped)| *flipped).count() as f64 / count;
    assert!(mean.abs() < 0.001 && (deviation - 0.02).abs() < 0.001, "{mean} {deviation}");
    assert!((lost - 0.1).abs() < 0.01 && (flipped - 0.03).abs() < 0.005, "{lost} {flipped}");
}

#[test]
fn outliers_are_as_many_as_is_said_and_anywhere_in_their_range() {
    let (n, period) = (20_000, 10 * MS);
    let outlier = Some(SensorOutlier { probability: 0.02, lo: 1.0, hi: 5.0 });
    let noisy = ImperfectSensor { every: Some(period), noise: metres(0.02), outlier, ..of_x() };
    let mut sim = running(vec![noisy], 6);
    let mut far = Vec::new();
    for sample in 1..=n {
        sim.advance(sample * period);
        far.extend(Some(reading(&sim, X)).filter(|x| *x > 0.5));
    }
    let (count, all) = (far.len() as f64, n as f64);
    let mean = far.iter().sum::<f64>() / count;
    let deviation = (far.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count).sqrt();
    assert!((count / all - 0.02).abs() < 0.004, "{count}");
    assert!(far.iter().all(|x| (1.0..=5.0).contains(x)));
    // Evenly: around the middle, with a deviation of a twelfth of the square of the width.
    assert!((mean - 3.0).abs() < 0.2 && (deviation - 4.0 / 12f64.sqrt()).abs() < 0.1, "{mean} {deviation}");
}

#[test]
fn a_laser_sees_what_is_not_there_beam_by_beam() {
    let eye = DeviceBody::Laser(LaserId(0));
    let of_eye = exact("eye", SensorSource::Laser(LaserId(0)));
    let outlier = Some(SensorOutlier { probability: 0.03, lo: 0.1, hi: 10.0 });
    let sensor = ImperfectSensor { every: Some(100 * MS), outlier, ..of_eye };
    let mut sim = running(vec![sensor], 3);
    let truth = running(Vec::new(), 0).told(eye, DeviceState::BeamRanges).unwrap();
    let mut false_returns = Vec::new();
    for sample in 0..1000 {
        sim.advance(sample * 100 * MS);
        let seen = sim.told(eye, DeviceState::BeamRanges).unwrap();
        let wrong = seen.iter().zip(&truth).filter(|(a, b)| a != b).map(|(a, _)| *a);
        false_returns.extend(wrong);
    }
    let part = false_returns.len() as f64 / 21_000.0;
    let mean = false_returns.iter().sum::<f64>() / false_returns.len() as f64;
    assert!((part - 0.03).abs() < 0.004 && (mean - 5.05).abs() < 0.4, "{part} {mean}");
}

#[test]
fn the_nearest_is_the_least_of_a_scan_as_it_is_true() {
    let of_eye = exact("eye", SensorSource::Laser(LaserId(0)));
    let mut world = hall(vec![ImperfectSensor { noise: metres(0.1), ..of_eye }]);
    world.bodies[0].position = [1.5, 0.2, 0.15];
    let laser = world.lasers[0].clone();
    let noisy = WorldSimulation::new(&world, &[]).unwrap();
    world.sensors = Vec::new();
    let exact = WorldSimulation::new(&world, &[]).unwrap();
    let ranges = exact.told(DeviceBody::Laser(LaserId(0)), DeviceState::BeamRanges).unwrap();
    let mut found = Vec::new();
    for (from, to) in [(-0.2, 0.2), (-0.2, 0.0), (0.1, 0.16), (0.02, 0.02)] {
        let (first, last) = laser.beams_between(from, to).unwrap();
        let term = SignalTerm::Nearest { laser: LaserId(0), first, last };
        let least = ranges[usize::from(first)..=usize::from(last)].iter().copied().fold(9.0, f64::min);
        for sim in [&noisy, &exact] {
            assert_eq!(sim.measure(&term).as_f64(), Some(least), "{from} to {to}");
        }
        found.push((last - first, least));
    }
    // The ball ahead to the left, the wall behind it.
    assert!(found[0].1 == found[2].1 && (1.3..1.45).contains(&found[0].1), "{found:?}");
    assert!((found[1].1 - 3.0).abs() < 1e-6 && (found[3].1 - 3.000_600_1).abs() < 1e-6, "{found:?}");
    assert_eq!(found.iter().map(|f| f.0).collect::<Vec<_>>(), [20, 10, 3, 0]);
    assert_eq!(laser.beams_between(0.165, 0.175), None);
}

#[test]
fn who_loses_everything_shows_nothing() {
    let mut sim = moving(vec![ImperfectSensor { dropout: 1.0, ..of_x() }], 1);
    sim.advance(SECOND);
    assert!(reading(&sim, X).is_nan());
}

#[test]
fn readings_do_not_go_back_in_time() {
    let sensor = ImperfectSensor { every: Some(30 * MS), late: 40 * MS, dropout: 0.6, ..of_x() };
    let mut sim = moving(vec![sensor], 9);
    let mut last = 0.0;
    for time in (310..3000).map(|ms| ms * MS) {
        sim.advance(time);
        let now = reading(&sim, X);
        assert!(now >= last && now <= float(&sim, 0) + 1e-9, "{now} after {last} at {time}");
        last = now;
    }
    assert!((last - 1.0).abs() < 1e-6);
}

#[test]
fn a_scan_is_late_noisy_and_full_of_holes() {
    let eye = DeviceBody::Laser(LaserId(0));
    let of_eye = exact("eye", SensorSource::Laser(LaserId(0)));
    let sensor = ImperfectSensor {
        every: Some(100 * MS),
        late: 20 * MS,
        noise: metres(0.01),
        dropout: 0.05,
        ..of_eye
    };
    let mut sim = running(vec![sensor], 3);
    let truth = running(Vec::new(), 0).told(eye, DeviceState::BeamRanges).unwrap();
    let (mut errors, mut holes) = (Vec::new(), 0);
    for sample in 0..1000 {
        sim.advance(sample * 100 * MS + 20 * MS);
        let seen = sim.told(eye, DeviceState::BeamRanges).unwrap();
        assert_eq!(sim.sampled_at(eye), Some(sample * 100 * MS));
        holes += seen.iter().filter(|range| **range == f64::INFINITY).count();
        errors.extend(seen.iter().zip(&truth).map(|(a, b)| a - b).filter(|error| error.is_finite()));
    }
    let count = errors.len() as f64;
    let deviation = (errors.iter().map(|x| x * x).sum::<f64>() / count).sqrt();
    let lost = f64::from(u32::try_from(holes).unwrap()) / 21_000.0;
    assert!((deviation - 0.01).abs() < 0.0005 && (lost - 0.05).abs() < 0.005, "{deviation} {lost}");
    assert_eq!(sim.told(eye, DeviceState::BeamLimits), Some(vec![0.1, 10.0]), "what it is, is known");
}

#[test]
fn a_base_that_drifts_believes_to_be_elsewhere() {
    let drift = Some(OdometryDrift { way: 0.05, turn: 0.0 });
    let wheels = DeviceBody::Base(BaseId(0));
    let off = |seed: u64| {
        let sensor = ImperfectSensor { drift, ..exact("wheels", SensorSource::Base(BaseId(0))) };
        let mut sim = running(vec![sensor], seed);
        let drive = MotorCommand::DriveWheels { base: BaseId(0), forward: 0.5, sideways: 0.0, turn: 0.0 };
        sim.command(drive).unwrap();
        sim.advance(4 * SECOND);
        let told = sim.told(wheels, DeviceState::BasePose).unwrap()[0];
        let truth = sim.base_pose(BaseId(0)).unwrap()[0];
        (told - truth) / truth.sqrt()
    };
    let off: Vec<f64> = (0..200).map(off).collect();
    let deviation = (off.iter().map(|x| x * x).sum::<f64>() / 200.0).sqrt();
    assert!((deviation - 0.05).abs() < 0.008, "{deviation}");
}

#[test]
fn what_is_judged_of_a_reading_wakes_the_world_when_it_comes() {
    let late = 500 * MS + 7;
    let sensor = ImperfectSensor { late, ..of_x() };
    let mut all = signals();
    all.push(number("reading(x)", SignalTerm::Reading(X)));
    let mut sim = WorldSimulation::new(&hall(vec![sensor]), &all).unwrap();
    let to = at(None, [1.0, 5.0, 1.0]);
    sim.act(&WorldAction::Move { body: BodyId(0), to, over: Expr::float(0.1) }, &none).unwrap();
    let (mut changes, mut last) = (sim.changes(), float(&sim, 2));
    let mut end = 0;
    while let Some(next) = sim.next_wake() {
        sim.advance(next - 1);
        assert_eq!((sim.changes(), float(&sim, 2)), (changes, last), "nothing between wakes");
        sim.advance(next);
        (changes, last, end) = (sim.changes(), float(&sim, 2), next);
    }
    assert!((last - 1.0).abs() < 1e-6, "{last}");
    assert_eq!((end - 7) % (10 * MS), 0, "the last is what came last, at {end}");
}

#[test]
fn sensors_of_nothing_and_bad_measures_are_refused() {
    let said = |sensor| WorldSimulation::new(&hall(vec![sensor]), &signals()).err().map(|e| e.to_string());
    let gone = exact("gone", SensorSource::Laser(LaserId(7)));
    assert_eq!(said(gone).as_deref(), Some("a sensor refers to laser 7, which does not exist"));
    for bad in [
        ImperfectSensor { late: -1, ..of_x() },
        ImperfectSensor { every: Some(0), ..of_x() },
        ImperfectSensor { dropout: 1.5, ..of_x() },
        ImperfectSensor { flip: f64::NAN, ..of_x() },
        ImperfectSensor { outlier: Some(SensorOutlier { probability: 2.0, lo: 0.0, hi: 1.0 }), ..of_x() },
        ImperfectSensor { outlier: Some(SensorOutlier { probability: 0.1, lo: 2.0, hi: 1.0 }), ..of_x() },
        ImperfectSensor { noise: metres(-1.0), ..of_x() },
    ] {
        assert!(said(bad).is_some_and(|why| why.contains("signal `x`")));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// A reading depends neither on how often it was asked for, nor on other sensors.
    #[test]
    fn a_reading_is_the_same_whoever_asks(
        every in proptest::option::of(1i64..200), late in 0i64..200, dropout in 0.0..0.8, seed in 0u64..1000
    ) {
        let every = every.map(|ms| ms * MS);
        let sensor = ImperfectSensor { every, late: late * MS, noise: metres(0.1), dropout, ..of_x() };
        let of_beyond = exact("beyond", SensorSource::Signal(BEYOND));
        let other = ImperfectSensor { flip: 0.5, ..of_beyond };
        let mut often = moving(vec![other, sensor.clone()], seed);
        let mut seldom = moving(vec![sensor], seed);
        for time in (301..2500).step_by(7).map(|ms| ms * MS) {
            often.advance(time);
            let seen = reading(&often, X);
            if time % 5 == 0 {
                seldom.advance(time);
                prop_assert_eq!(reading(&seldom, X), seen, "at {}", time);
            }
        }
    }
}
