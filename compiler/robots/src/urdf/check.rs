//! Whether links and joints are one tree, and mimicking comes to an end.

use super::model::{UrdfJoint, UrdfJointId, UrdfJointKind, UrdfLink, UrdfLinkId};
use crate::fault::{RobotFault, RobotFaultKind, say};

/// The root, and the joints from there outwards; `None`, and faults, if they are no tree.
pub(crate) fn tree_of(
    links: &[UrdfLink],
    joints: &[UrdfJoint],
    faults: &mut Vec<RobotFault>,
) -> Option<(UrdfLinkId, Vec<UrdfJointId>)> {
    let before = faults.len();
    let above = joints_above(links, joints, faults);
    loops(joints, &above, faults);
    mimic_loops(joints, faults);
    if faults.len() > before {
        return None;
    }
    let mut roots = links.iter().zip(&above).enumerate().filter(|(_, (_, above))| above.is_none());
    let (root, (base, _)) = roots.next()?;
    for (_, (other, _)) in roots {
        let kind = RobotFaultKind::SeveralRoots(base.name.clone(), other.name.clone());
        let help = format!(
            "join it to the others: `<joint …><parent link=\"…\"/><child link=\"{}\"/></joint>`",
            other.name
        );
        say(faults, kind.at(other.place, help).clashes(base.place.span));
    }
    let root = UrdfLinkId(root);
    for joint in joints {
        let kind = match joint.kind {
            UrdfJointKind::Floating => "floating",
            UrdfJointKind::Planar => "planar",
            UrdfJointKind::Fixed
            | UrdfJointKind::Revolute
            | UrdfJointKind::Continuous
            | UrdfJointKind::Prismatic => continue,
        };
        if joint.parent != root {
            let kind = RobotFaultKind::FreeJoint { joint: joint.name.clone(), kind };
            let help =
                "write revolute or prismatic joints one after the other; only a robot as a whole is free";
            say(faults, kind.at(joint.place, help));
        }
    }
    if faults.len() > before {
        return None;
    }
    Some((root, outwards(root, links.len(), joints)))
}

/// Of each link the number of the joint above it.
fn joints_above(
    links: &[UrdfLink],
    joints: &[UrdfJoint],
    faults: &mut Vec<RobotFault>,
) -> Vec<Option<usize>> {
    let mut above: Vec<Option<usize>> = vec![None; links.len()];
    for (at, joint) in joints.iter().enumerate() {
        let Some(slot) = above.get_mut(joint.child.0) else { continue };
        match slot.and_then(|first| joints.get(first)) {
            Some(first) => {
                let name = links.get(joint.child.0).map(|link| link.name.clone()).unwrap_or_default();
                let help = format!("`{}` has it as its child already: a link hangs on one joint", first.name);
                let kind = RobotFaultKind::TwoParents(name);
                say(faults, kind.at(joint.place, help).clashes(first.place.span));
            }
            None => *slot = Some(at),
        }
    }
    above
}

/// Says of each circle of joints the first in the text.
fn loops(joints: &[UrdfJoint], above: &[Option<usize>], faults: &mut Vec<RobotFault>) {
    let up = |at: usize| {
        let parent = joints.get(at)?.parent.0;
        above.get(parent).copied().flatten()
    };
    for (at, joint) in circles(joints.len(), up).into_iter().filter_map(|at| Some((at, joints.get(at)?))) {
        let around = std::iter::successors(up(at), |next| up(*next)).take_while(|next| *next != at);
        let names: Vec<&str> = around.filter_map(|next| joints.get(next)).map(|j| j.name.as_str()).collect();
        let with = if names.is_empty() {
            "its parent is its child".to_owned()
        } else {
            format!("it goes by {}", names.join(", "))
        };
        let kind = RobotFaultKind::LinkLoop(joint.name.clone());
        say(faults, kind.at(joint.place, format!("{with}; take one joint out: links are a tree")));
    }
}

fn mimic_loops(joints: &[UrdfJoint], faults: &mut Vec<RobotFault>) {
    let followed = |at: usize| joints.get(at)?.mimic.as_ref().map(|mimic| mimic.joint.0);
    for joint in circles(joints.len(), followed).into_iter().filter_map(|at| joints.get(at)) {
        let place = joint.mimic.as_ref().map_or(joint.place, |mimic| mimic.place);
        let help = "let one of the joints move by itself: take its `<mimic>` out";
        say(faults, RobotFaultKind::MimicLoop(joint.name.clone()).at(place, help));
    }
}

/// The smallest member of each circle, where each has at most one successor.
fn circles(count: usize, next: impl Fn(usize) -> Option<usize>) -> Vec<usize> {
    // 0: not seen; otherwise the number of the walk that saw it first.
    let mut seen = vec![0_usize; count];
    let mut found = Vec::new();
    for start in 0..count {
        let walk = start + 1;
        let mut at = Some(start);
        while let Some(here) = at {
            match seen.get_mut(here) {
                Some(mark) if *mark == 0 => {
                    *mark = walk;
                    at = next(here);
                }
                Some(mark) if *mark == walk => {
                    let around = std::iter::successors(next(here), |n| next(*n)).take_while(|n| *n != here);
                    found.push(around.chain([here]).min().unwrap_or(here));
                    break;
                }
                Some(_) | None => break,
            }
        }
    }
    found.sort_unstable();
    found
}

/// All joints of a tree, each after that above it; those of one link in the order of the text.
fn outwards(root: UrdfLinkId, links: usize, joints: &[UrdfJoint]) -> Vec<UrdfJointId> {
    let mut below: Vec<Vec<usize>> = vec![Vec::new(); links];
    for (at, joint) in joints.iter().enumerate() {
        if let Some(of) = below.get_mut(joint.parent.0) {
            of.push(at);
        }
    }
    let mut order = Vec::new();
    let mut waiting = vec![root.0];
    while let Some(link) = waiting.pop() {
        let here = below.get(link).map(Vec::as_slice).unwrap_or_default();
        order.extend(here.iter().map(|at| UrdfJointId(*at)));
        // The last is taken first.
        waiting.extend(here.iter().rev().filter_map(|at| joints.get(*at)).map(|joint| joint.child.0));
    }
    order
}
