//! A large scenario that looks like those that people write: many stations like that of `examples/handover`, each with its own
//! vocabulary, agents, automata, requirements and coverage, in one world. The same text every time.

use std::fmt::Write;

/// One station; `@` is its number, `#` the number of its parts.
const STATION: &str = include_str!("station.hri");

/// The station's members of the world.
const PLACE: &str = "
  body table_@: fixed box(60 cm, 40 cm, 70 cm) at (X m, 0 m, 35 cm)
  body piece_@: dynamic box(4 cm, 4 cm, 20 cm) at (X m, -10 cm, 80 cm) mass 400 g graspable
  body hand_@: kinematic sphere(5 cm) at (X m, 50 cm, 90 cm) ghost
  signal near_@: bool to robot_@ = distance(hand_@, piece_@) < 30 cm && abs(hand_@.z - piece_@.z) < 20 cm
  signal still_@: bool to robot_@ = speed(piece_@) < 0.05 m/s
  on sense_@ when range(hand_@, table_@) < 2 m emit sensed_@(near_@, still_@)
";

/// A scenario of at least this many lines, without errors and warnings.
pub fn scenario(lines: usize) -> String {
    let mut text =
        String::from("/// Stations along a line, each with a person and a robot.\nscenario line\n\n");
    text.push_str("const REACH = 80 cm\nconst PATIENCE = 12 s\nenum Order { feed, clean, hold_still }\n\n");
    let mut world = String::from("world {\n  step 10 ms\n  sample 50 ms\n");
    let of_each = STATION.lines().count() + PLACE.lines().count();
    for station in 0..lines.div_ceil(of_each) {
        let number = station.to_string();
        text.push_str(&STATION.replace('@', &number).replace('#', &(2 + station % 5).to_string()));
        world.push_str(&PLACE.replace('@', &number).replace('X', &(2 * station).to_string()));
    }
    let _ = write!(text, "\n{world}  body floor: fixed box(8 m, 8 m, 10 cm) at (0 m, 0 m, -5 cm)\n}}\n");
    text
}
