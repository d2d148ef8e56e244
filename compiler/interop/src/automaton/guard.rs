//! Guards as few and short alternatives.

use super::data::GuardTest;

/// The same alternatives with fewer tests: two that differ in one answer only are one without it.
pub(super) fn shortened(mut guard: Vec<Vec<GuardTest>>) -> Vec<Vec<GuardTest>> {
    guard.iter_mut().for_each(|tests| tests.sort_unstable());
    loop {
        guard.sort_unstable();
        guard.dedup();
        let Some((first, second, merged)) = mergeable(&guard) else { return guard };
        guard.remove(second);
        guard.remove(first);
        guard.push(merged);
    }
}

fn mergeable(guard: &[Vec<GuardTest>]) -> Option<(usize, usize, Vec<GuardTest>)> {
    guard.iter().enumerate().find_map(|(i, a)| {
        let rest = guard.iter().enumerate().skip(i + 1);
        rest.into_iter().find_map(|(j, b)| Some((i, j, merged(a, b)?)))
    })
}

fn merged(a: &[GuardTest], b: &[GuardTest]) -> Option<Vec<GuardTest>> {
    if a.len() != b.len() {
        return None;
    }
    let mut differing = a.iter().zip(b).enumerate().filter(|(_, (a, b))| a != b);
    let (place, (x, y)) = differing.next()?;
    if differing.next().is_some() || x.of != y.of {
        return None;
    }
    let kept = a.iter().enumerate().filter(|(i, _)| *i != place);
    Some(kept.map(|(_, test)| *test).collect())
}
