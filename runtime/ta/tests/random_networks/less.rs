//! Makes a network smaller as long as it shows the same.

use hrdsl_ir::Program;

/// Takes edges, updates, guards, invariants, selects and automata away, one at a time, while `shows` holds.
pub fn reduced(p: &Program, shows: &dyn Fn(&Program) -> bool) -> Program {
    let mut best = p.clone();
    loop {
        let better = smaller(&best).into_iter().find(shows);
        match better {
            Some(p) => best = p,
            None => return best,
        }
    }
}

fn smaller(p: &Program) -> Vec<Program> {
    let mut all = Vec::new();
    let mut with = |change: &dyn Fn(&mut Program)| {
        let mut q = p.clone();
        change(&mut q);
        all.push(q);
    };
    if p.networks[0].automata.len() > 2 {
        for at in 0..p.networks[0].automata.len() {
            with(&|q| q.networks[0].automata.retain(|a| *a != p.networks[0].automata[at]));
        }
    }
    for (a, automaton) in p.automata.iter().enumerate() {
        for (e, edge) in automaton.edges.iter().enumerate() {
            with(&|q| drop(q.automata[a].edges.remove(e)));
            for u in 0..edge.updates.len() {
                with(&|q| drop(q.automata[a].edges[e].updates.remove(u)));
            }
            for c in 0..edge.clock_guard.len() {
                with(&|q| drop(q.automata[a].edges[e].clock_guard.remove(c)));
            }
            if edge.guard.is_some() {
                with(&|q| q.automata[a].edges[e].guard = None);
            }
        }
        for (l, location) in automaton.locations.iter().enumerate() {
            for c in 0..location.invariant.len() {
                with(&|q| drop(q.automata[a].locations[l].invariant.remove(c)));
            }
            if location.holds.is_some() {
                with(&|q| q.automata[a].locations[l].holds = None);
            }
            if location.kind != hrdsl_ir::ta::LocationKind::Normal {
                with(&|q| q.automata[a].locations[l].kind = hrdsl_ir::ta::LocationKind::Normal);
            }
        }
    }
    for c in 0..p.channels.len() {
        if p.channels[c].urgent {
            with(&|q| q.channels[c].urgent = false);
        }
    }
    all
}
