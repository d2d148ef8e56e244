//! Knots: what imports each other, in one or several steps.

use std::collections::{BTreeMap, BTreeSet};

/// From each to those that it imports.
pub type Graph = BTreeMap<String, BTreeSet<String>>;

/// Everything that can be reached by one arrow and more.
pub fn reached(graph: &Graph, from: &str) -> BTreeSet<String> {
    let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(at) = open.pop() {
        for next in graph.get(at).into_iter().flatten() {
            if seen.insert(next.clone()) {
                open.push(next);
            }
        }
    }
    seen
}

/// The strongly connected components of two members and more.
pub fn knots(graph: &Graph) -> Vec<BTreeSet<String>> {
    let below: BTreeMap<&String, BTreeSet<String>> = graph.keys().map(|f| (f, reached(graph, f))).collect();
    let mut found: Vec<BTreeSet<String>> = Vec::new();
    for (file, all) in &below {
        let back = |other: &&String| below.get(other).is_some_and(|b| b.contains(*file));
        let knot: BTreeSet<String> = all.iter().filter(back).cloned().chain([(*file).clone()]).collect();
        if knot.len() > 1 && !found.contains(&knot) {
            found.push(knot);
        }
    }
    found
}

/// The height of each above what imports nothing; all members of a knot are on one floor.
pub fn floors(graph: &Graph) -> BTreeMap<String, usize> {
    let knots = knots(graph);
    let together = |one: &str, other: &str| knots.iter().any(|k| k.contains(one) && k.contains(other));
    let mut floors: BTreeMap<String, usize> = graph.keys().map(|n| (n.clone(), 0)).collect();
    // A longest way has fewer steps than there are members.
    for _ in graph {
        for (from, to) in graph {
            for to in to.iter().filter(|to| *to != from) {
                let least = floors[to] + usize::from(!together(from, to));
                if floors[from] < least {
                    floors.insert(from.clone(), least);
                }
            }
        }
    }
    floors
}

/// The arrows that no way over others replaces; arrows inside of a knot all stay.
pub fn without_shortcuts(graph: &Graph) -> Graph {
    let below: BTreeMap<&str, BTreeSet<String>> =
        graph.keys().map(|name| (name.as_str(), reached(graph, name))).collect();
    let needed = |from: &String, to: &String| {
        let others = graph[from].iter().filter(|other| *other != to && *other != from);
        let goes = |one: &str, other: &str| below.get(one).is_some_and(|b| b.contains(other));
        !others.into_iter().any(|other| goes(other, to) && !goes(other, from) && !goes(to, other))
    };
    let keep = |(from, to): (&String, &BTreeSet<String>)| {
        (from.clone(), to.iter().filter(|to| *to != from && needed(from, to)).cloned().collect())
    };
    graph.iter().map(keep).collect()
}
