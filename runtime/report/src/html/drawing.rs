//! A state machine as a drawing: states in rows by how far they are from the first, transitions as arrows between them.

use std::collections::BTreeMap;

use hrdsl_results::MachineResult;
use serde::Serialize;

/// What has more states and outcomes cannot be taken in at a glance.
const NODES: usize = 60;
/// Room for a node, in pixels, and between its centre and those beside and below.
const WIDTH: usize = 130;
const HEIGHT: usize = 26;
const ACROSS: usize = 170;
const DOWN: usize = 72;
/// Room around the drawing; on the right for arrows that lead back.
const MARGIN: usize = 16;
const BACK: usize = 90;
/// Letters of a label that fit into a node.
const LETTERS: usize = 17;

#[derive(Serialize)]
pub struct MachineDrawing {
    width: usize,
    height: usize,
    nodes: Vec<DrawnNode>,
    arrows: Vec<DrawnArrow>,
}

#[derive(Serialize)]
struct DrawnNode {
    x: usize,
    y: usize,
    width: usize,
    height: usize,
    middle: usize,
    base: usize,
    label: String,
    title: String,
    is_outcome: bool,
    is_reached: bool,
}

#[derive(Serialize)]
struct DrawnArrow {
    path: String,
    title: String,
    is_taken: bool,
}

/// Where a node is: its row, and the place in it.
#[derive(Clone, Copy)]
struct NodePlace {
    row: usize,
    column: usize,
}

impl NodePlace {
    fn left(self) -> usize {
        MARGIN + self.column * ACROSS
    }

    fn middle(self) -> usize {
        self.left() + WIDTH / 2
    }

    fn right(self) -> usize {
        self.left() + WIDTH
    }

    fn top(self) -> usize {
        MARGIN + self.row * DOWN
    }

    fn bottom(self) -> usize {
        self.top() + HEIGHT
    }

    fn level(self) -> usize {
        self.top() + HEIGHT / 2
    }
}

/// `None`: there is nothing to draw, or too much.
pub fn drawing(machine: &MachineResult) -> Option<MachineDrawing> {
    let states: Vec<&str> = machine.states.iter().map(|s| s.state.as_str()).collect();
    let outcomes = machine.outcomes.iter().map(String::as_str).filter(|o| !states.contains(o));
    let outcomes: Vec<&str> = outcomes.filter(|o| machine.transitions.iter().any(|t| t.to == **o)).collect();
    if machine.transitions.is_empty() || states.len() + outcomes.len() > NODES {
        return None;
    }
    let places = places(machine, &states, &outcomes);
    let is_reached = |name: &str| {
        let entered = machine.states.iter().any(|s| s.state == name && s.hits.iter().any(|n| *n > 0));
        entered || machine.transitions.iter().any(|t| t.to == name && t.hits.iter().any(|n| *n > 0))
    };
    let node = |(name, place): (&&str, &NodePlace)| DrawnNode {
        x: place.left(),
        y: place.top(),
        width: WIDTH,
        height: HEIGHT,
        middle: place.middle(),
        base: place.level() + 4,
        label: crate::text::cut(name, LETTERS),
        title: (*name).to_owned(),
        is_outcome: outcomes.contains(name),
        is_reached: is_reached(name),
    };
    let arrow = |t: &hrdsl_results::MachineTransitionResult| {
        let (from, to) = (places.get(t.from.as_str())?, places.get(t.to.as_str())?);
        Some(DrawnArrow { path: arrow(*from, *to), title: t.name(), is_taken: t.hits.iter().any(|n| *n > 0) })
    };
    let rows = places.values().map(|p| p.row).max().unwrap_or(0) + 1;
    let columns = places.values().map(|p| p.column).max().unwrap_or(0) + 1;
    Some(MachineDrawing {
        width: 2 * MARGIN + columns * ACROSS + BACK,
        height: 2 * MARGIN + rows * DOWN,
        nodes: places.iter().map(node).collect(),
        arrows: machine.transitions.iter().filter_map(arrow).collect(),
    })
}

/// Each state in the row of its distance from the first one; those that no transition leads to are in the first row, too.
fn places<'m>(
    machine: &'m MachineResult,
    states: &[&'m str],
    outcomes: &[&'m str],
) -> BTreeMap<&'m str, NodePlace> {
    let mut rows: BTreeMap<&str, usize> = BTreeMap::new();
    let led_to = |state: &str| machine.transitions.iter().any(|t| t.to == state && t.from != state);
    let mut front: Vec<&str> =
        states.iter().enumerate().filter(|(i, s)| *i == 0 || !led_to(s)).map(|(_, s)| *s).collect();
    let mut row = 0;
    while !front.is_empty() {
        for state in &front {
            rows.entry(state).or_insert(row);
        }
        row += 1;
        let next = machine.transitions.iter().filter(|t| front.contains(&t.from.as_str()));
        let mut next: Vec<&str> = next.map(|t| t.to.as_str()).filter(|to| !rows.contains_key(to)).collect();
        next.retain(|to| states.contains(to));
        next.sort_unstable();
        next.dedup();
        front = next;
    }
    let mut used: BTreeMap<usize, usize> = BTreeMap::new();
    let mut places = BTreeMap::new();
    let last = rows.values().max().map_or(0, |row| row + 1);
    let nodes = states.iter().map(|s| (*s, rows.get(s).copied().unwrap_or(last)));
    for (name, row) in nodes.chain(outcomes.iter().map(|o| (*o, last + 1))) {
        let column = used.entry(row).or_default();
        places.insert(name, NodePlace { row, column: *column });
        *column += 1;
    }
    places
}

/// Down from the bottom to the top, sideways below the row, and back on the right; with its head.
fn arrow(from: NodePlace, to: NodePlace) -> String {
    let (x, y) = (to.middle(), to.top());
    if from.row < to.row {
        let (start, below) = (from.middle(), from.bottom());
        return format!(
            "M{start} {below}C{start} {} {x} {} {x} {y}M{} {}L{x} {y}L{} {}",
            below + 30,
            y - 30,
            x - 3,
            y - 6,
            x + 3,
            y - 6
        );
    }
    let (right, level) = (to.right(), to.level());
    let head = format!("M{} {}L{right} {level}L{} {}", right + 6, level - 3, right + 6, level + 3);
    if from.row == to.row && from.column != to.column {
        let (start, below) = (from.middle(), from.bottom());
        return format!(
            "M{start} {below}C{start} {} {x} {} {x} {below}M{} {}L{x} {below}L{} {}",
            below + 26,
            below + 26,
            x - 3,
            below + 6,
            x + 3,
            below + 6
        );
    }
    let (start, height) = (from.right(), from.level());
    if from.row == to.row {
        return format!("M{start} {}c30 -12 30 24 0 12{head}", level - 12);
    }
    let bulge = 20 + 10 * (from.row - to.row).min(6);
    let furthest = start.max(right) + bulge;
    format!("M{start} {height}C{furthest} {height} {furthest} {level} {right} {level}{head}")
}
