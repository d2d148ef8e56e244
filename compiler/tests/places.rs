//! Points of stimuli in a box, and postures of arms that slide.

use hrdsl_compiler::{InputFile, compile};
use hrdsl_ir::{
    Expr, Program,
    event::StimulusStep,
    world::{BodyId, BodyRef, WorldAction},
};

fn program(members: &str) -> Program {
    let text = format!("scenario small\nactor dog : environment\nactor robot : system\n{members}");
    let compiled = compile(InputFile { name: "small.hri", text: &text }, &[]);
    let said: Vec<String> =
        compiled.diagnostics.iter().filter(|d| d.is_error()).map(|d| d.message.clone()).collect();
    compiled.program.unwrap_or_else(|| panic!("{said:?}"))
}

#[test]
fn points_are_brought_into_boxes() {
    let p = program(
        "stimulus s(d: length) by dog {\n\
           dog.move_to(clamp(clamp(cup, dog - (d, 1 m, 0 m), dog), (0 m, 0 m, 0 m), (1 m, 1 m, d)), 1 s)\n}\n\
         world {\n  body dog: kinematic sphere(5 cm) at (0 m, 0 m, 0 m)\n  body cup: fixed sphere(5 cm) at (1 m, 0 m, 0 m)\n}\n",
    );
    let steps = p.event(p.event_named("s").unwrap()).stimulus.clone().unwrap().steps;
    let StimulusStep::Act(WorldAction::Move { to, .. }) = &steps[0] else { panic!("{steps:?}") };
    let (dog, cup) = (BodyRef::Body(BodyId(0)), BodyRef::Body(BodyId(1)));
    assert_eq!(to.of, Some(cup));
    let [[near, far], [low, high]] = to.within.as_slice() else { panic!("{to:?}") };
    assert_eq!((near.of, far.of, low.of, high.of), (Some(dog), Some(dog), None, None));
    assert_eq!(near.offset[1], Expr::float(-1.0));
    assert_eq!(high.offset[2], Expr::Var(0));
}

#[test]
fn a_posture_gives_ways_of_sliders() {
    let p = program(
        "world {\n\
         body stand: fixed box(10 cm, 10 cm, 10 cm) at (0 m, 0 m, 0 m)\n\
         body lift: dynamic box(10 cm, 10 cm, 10 cm) at (0 m, 0 m, 20 cm) mass 1 kg\n\
         body beam: dynamic box(10 cm, 10 cm, 10 cm) at (30 cm, 0 m, 20 cm) mass 1 kg\n\
         joint rise: stand -> lift at (0 m, 0 m, 10 cm) axis (0, 0, 1) limits 0 cm .. 30 cm\n\
         joint turn: lift -> beam at (10 cm, 0 m, 20 cm) axis (0, 0, 1) limits -90 deg .. 90 deg\n\
         arm arm: rise, turn tip beam tool (0 m, 0 m, 0 m) speed 1 rad/s\n\
         posture up: arm at [25 cm, 0 deg]\n}\n",
    );
    assert_eq!(p.world.unwrap().arms[0].postures[0].angles, [0.25, 0.0]);
}
