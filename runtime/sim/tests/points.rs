//! Points that are brought into a box.

#[path = "common/scene.rs"]
mod scene;

use hrdsl_ir::{
    Expr,
    world::{BodyRef, WorldAction, WorldPoint},
};
use scene::Scene;

const FLOOR: &str = "body floor: fixed box(20 m, 20 m, 10 cm) at (0 m, 0 m, -5 cm)";

fn dog() -> Scene {
    let members = format!(
        "{FLOOR}
        body dog: kinematic box(30 cm, 15 cm, 30 cm) at (0 m, 0 m, 15 cm)
        signal dog_x: length to robot = dog.x
        signal dog_y: length to robot = dog.y"
    );
    Scene::new(&members, &[])
}

fn set(scene: &mut Scene, to: WorldPoint) {
    let action = WorldAction::Move { body: scene.body("dog"), to, over: Expr::float(0.0) };
    scene.sim.act(&action, &|_| None).expect("kinematic");
}

fn point(x: f64, y: f64, z: f64) -> WorldPoint {
    WorldPoint::free(None, [x, y, z].map(Expr::float))
}

#[test]
fn a_point_is_brought_into_each_of_its_boxes() {
    let mut scene = dog();
    scene.go_on(0.1, |_| {});
    let near =
        |by: f64| WorldPoint::free(Some(BodyRef::Body(scene.body("dog"))), [by, by, 0.0].map(Expr::float));
    let mut to = point(5.0, 0.05, 1.0);
    to.within = vec![[near(-0.1), near(0.1)], [point(-1.0, 0.07, 0.15), point(0.08, 1.0, 0.15)]];
    set(&mut scene, to);
    scene.go_on(0.1, |_| {});
    assert!((scene.read("dog_x") - 0.08).abs() < 1e-6, "{}", scene.read("dog_x"));
    assert!((scene.read("dog_y") - 0.07).abs() < 1e-6, "{}", scene.read("dog_y"));
}
