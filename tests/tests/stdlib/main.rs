//! The standard library is executed: every module is checked by itself, every example compiles without a warning, every
//! template has an instance, every requirement is run on traces that keep and break it, and every world stands.

mod library;
mod page;
mod requirements;

use std::{fs, path::Path};

use hrdsl_compiler::{CompilationResult, InputFile, compile};
use hrdsl_ir::{
    Expr, Program, Value,
    world::{BodyRef, SignalId, WorldAction, WorldPoint},
};
use hrdsl_sim::{MotorCommand, WorldSimulation};
use library::{Sorted, blocks, instantiated, modules};

/// Everything that was said, by place.
fn listed(c: &CompilationResult) -> Vec<String> {
    c.diagnostics.iter().map(|d| format!("{} {} {}", c.files.place(d.span()), d.code, d.message)).collect()
}

/// The module's example with this number, compiled.
fn program(module: &str, at: usize) -> Program {
    let all = modules();
    let module = all.iter().find(|m| m.path == module).unwrap();
    let text = module.examples().swap_remove(at);
    compile(InputFile { name: "example.hri", text: &text }, &[]).program.unwrap()
}

#[test]
fn every_module_is_checked_by_itself() {
    for module in modules() {
        assert!(module.compilation.is_module(), "{} is a module", module.path);
        assert_eq!(listed(&module.compilation), [""; 0], "{}", module.path);
    }
}

#[test]
fn every_example_compiles_and_every_template_has_an_instance() {
    let mut executed = 0;
    for module in modules() {
        let mut made = Vec::new();
        for text in module.examples() {
            executed += 1;
            let c = compile(InputFile { name: "example.hri", text: &text }, &[]);
            let said = listed(&c);
            assert!(said.is_empty(), "an example of {}:\n{}\n{text}", module.path, said.join("\n"));
            assert!(c.program.is_some());
            made.extend(instantiated(&c));
        }
        for d in &module.declarations {
            let is_made = |sort: Sorted| made.iter().any(|(s, of)| *s == sort && *of == d.name);
            assert!(d.sort.is_none_or(is_made), "{}: no example uses `{}`", module.path, d.name);
        }
    }
    assert!(executed >= hrdsl_stdlib::MODULES.len(), "only {executed} examples were found");
}

#[test]
fn every_declaration_is_documented_with_an_example_of_its_own() {
    for module in modules() {
        assert!(!module.about.is_empty(), "{} has a comment at its head", module.path);
        assert!(!module.declarations.is_empty());
        for d in &module.declarations {
            let examples = blocks(&d.doc);
            let prose = d.doc.split("```").next().unwrap_or_default();
            assert!(!prose.trim().is_empty(), "{}: `{}` has no words", module.path, d.name);
            let word = |c: char| !(c.is_alphanumeric() || c == '_');
            let shown = examples.iter().any(|e| e.split(word).any(|w| w == d.name));
            assert!(shown, "{}: no example of `{}` in its doc comment", module.path, d.name);
        }
    }
}

#[test]
fn the_page_is_made_from_the_comments() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../spec/stdlib.md");
    let page = page::page(&modules());
    if std::env::var_os("HRDSL_UPDATE").is_some() {
        fs::write(&path, &page).unwrap();
    }
    let there = fs::read_to_string(&path).unwrap_or_default();
    assert!(there == page, "spec/stdlib.md is old: HRDSL_UPDATE=1 cargo test -p hrdsl-tests --test stdlib");
}

#[test]
fn every_world_stands() {
    for module in modules() {
        for at in 0..module.examples().len() {
            let program = program(module.path, at);
            let world = program.world.as_ref().unwrap();
            let mut sim = WorldSimulation::new(world, &program.signals)
                .unwrap_or_else(|e| panic!("{}: {e}", module.path));
            sim.advance(2_000_000_000);
            for body in &world.bodies {
                let (at, _) = sim.pose(sim.body_named(&body.name).unwrap()).unwrap();
                let moved = (0..3).map(|i| (at[i] - body.position[i]).powi(2)).sum::<f64>().sqrt();
                assert!(moved < 0.01, "{}: `{}` moved {moved} m by itself", module.path, body.name);
            }
        }
    }
}

/// The arms of the library reach in front of themselves and come to rest.
#[test]
fn arms_reach_what_is_in_front_of_them() {
    for (module, places) in [
        ("std.robots.bert2", [[0.48, -0.05, 0.75], [0.4, -0.35, 0.6]]),
        ("std.robots.tiago", [[0.6, -0.1, 0.7], [0.7, 0.1, 0.9]]),
    ] {
        let program = program(module, 0);
        let mut sim = WorldSimulation::new(program.world.as_ref().unwrap(), &program.signals).unwrap();
        let arm = sim.arm_named("robot.arm").unwrap();
        for target in places {
            let id = sim.command(MotorCommand::ReachPoint { arm, target, max_speed: None }).unwrap();
            let end = sim.now() + 20_000_000_000;
            let mut finished = Vec::new();
            while finished.is_empty() && sim.now() < end {
                sim.advance(sim.now() + 100_000_000);
                finished = sim.finished();
            }
            assert_eq!(finished, [(id, Ok(()))], "{module}: to {target:?}");
            let tool = sim.tool(arm).unwrap();
            let off = (0..3).map(|i| (tool[i] - target[i]).powi(2)).sum::<f64>().sqrt();
            assert!(off <= 0.005, "{module}: {off} m from {target:?}");
        }
    }
}

/// The sensors of the example say what is so, before and after somebody reaches for the leg and holds it.
#[test]
fn sensors_say_what_is_so() {
    let program = program("std.sensors", 0);
    let mut sim = WorldSimulation::new(program.world.as_ref().unwrap(), &program.signals).unwrap();
    let read = |sim: &WorldSimulation, name: &str| {
        let at = program.signals.iter().position(|s| s.name == name).unwrap_or_else(|| panic!("no `{name}`"));
        sim.read(SignalId(u16::try_from(at).unwrap()))
    };
    let send = |sim: &mut WorldSimulation, body: &str, to: [f64; 3]| {
        let body = sim.body_named(body).unwrap();
        let to = WorldPoint::free(None, to.map(Expr::float));
        sim.act(&WorldAction::Move { body, to, over: Expr::float(1.0) }, &|_| None).unwrap();
        sim.advance(sim.now() + 2_000_000_000);
    };
    let (yes, no) = (Value::Bool(true), Value::Bool(false));
    let near = |value: Value, want: f64| {
        let Value::Float(x) = value else { panic!("{value:?} is no number") };
        assert!((x - want).abs() < 0.02, "{x} m, not {want} m");
    };
    assert_eq!((read(&sim, "location.inside"), read(&sim, "zone.occupied")), (no, yes));
    assert_eq!((read(&sim, "gaze.seen"), read(&sim, "bumper.near")), (no, no));
    // From the chest's corner (0.09, 0.15, 1.12) to the head at (1.25, 0.17, 1.35).
    near(read(&sim, "laser.distance"), 1.08);

    send(&mut sim, "person.hand", [0.3, -0.3, 0.3]);
    assert_eq!((read(&sim, "location.inside"), read(&sim, "pressure.both")), (yes, no));
    send(&mut sim, "person.hand", [0.38, -0.22, 0.85]);
    assert_eq!((read(&sim, "bumper.near"), read(&sim, "zone.occupied")), (yes, yes));
    send(&mut sim, "person.hand", [1.5, 0.0, 0.5]);
    assert_eq!((read(&sim, "bumper.near"), read(&sim, "zone.occupied")), (no, no));

    let head = sim.body_named("person.head").unwrap();
    let leg = BodyRef::Body(sim.body_named("leg").unwrap());
    let (offset, angle) = (Expr::float(0.1), Expr::float(0.3));
    let look = WorldAction::Look { body: head, at: leg, offset, distance: Expr::float(0.5), angle };
    sim.act(&look, &|_| None).unwrap();
    sim.advance(sim.now() + 2_000_000_000);
    assert_eq!(read(&sim, "gaze.seen"), yes);
    near(read(&sim, "palm_speed.value"), 0.0);
}
