//! Groups of the semantics of a description: the joints of an arm, and the fingers of a hand.

use hrdsl_robots::{UrdfJointId, UrdfLinkId};
use hrdsl_syntax::ast::{JointListSyntax, NameSyntax, TextSyntax};

use crate::check::{template::CheckerPhase, world::phase::WorldPhase};
use crate::{
    BodyId, JointId,
    noun::Noun,
    report::{names, world::bad_world},
};

impl WorldPhase<'_, '_> {
    /// Joints by their names, or those of a group that move by themselves, in the order of the tree; each with where it is
    /// named. `None`: something is wrong with one.
    pub(in crate::check::world) fn joint_list(
        &mut self,
        list: &JointListSyntax,
        prefix: &str,
    ) -> Option<Vec<(JointId, NameSyntax)>> {
        match list {
            JointListSyntax::Names(names) => {
                let mut found = Vec::new();
                for name in names {
                    let id = self.world_name(Noun::Joint, std::slice::from_ref(name), prefix);
                    found.extend(id.map(|id| (JointId(id), name.clone())));
                }
                (found.len() == names.len()).then_some(found)
            }
            JointListSyntax::Group(group) => self.group(group, prefix),
        }
    }

    fn group(&mut self, group: &TextSyntax, prefix: &str) -> Option<Vec<(JointId, NameSyntax)>> {
        if self.world.names.broken.contains(prefix.trim_end_matches('.')) {
            return None;
        }
        let found = self.robot_at(prefix).and_then(|placed| {
            let semantics = placed.reading.semantics.as_ref()?;
            let robot = placed.robot()?;
            let known: Vec<String> = semantics.groups.iter().map(|g| g.name.clone()).collect();
            semantics
                .group(&group.text)
                .ok_or(known)
                .map(|_| {
                    let moves = |id: &UrdfJointId| {
                        robot.joint(*id).is_some_and(|j| j.kind.has_one_value() && j.mimic.is_none())
                    };
                    let joints = semantics.joints_of(robot, &group.text).into_iter().filter(moves);
                    joints.filter_map(|id| placed.joint_id(id)).collect::<Vec<JointId>>()
                })
                .map_or_else(|known| Some(Err(known)), |joints| Some(Ok(joints)))
        });
        match found {
            None => {
                let message = "groups are in the semantics of a description, and none are named";
                let help =
                    "write `semantics \"robot.srdf\"` in a part from a description, or the names of joints";
                self.report(bad_world(group.span, message, help));
                None
            }
            Some(Err(known)) => {
                let near = known.iter().map(String::as_str);
                self.report(names::unknown(Noun::Group, &group.text, group.span, near));
                None
            }
            Some(Ok(joints)) if joints.is_empty() => {
                let message = format!("no joint of the group `{}` moves", group.text);
                self.report(bad_world(group.span, message, "name another group, or joints"));
                None
            }
            Some(Ok(joints)) => {
                let named = |id: JointId| (id, NameSyntax { text: self.joint_name(id), span: group.span });
                Some(joints.into_iter().map(named).collect())
            }
        }
    }

    /// The end of its name.
    fn joint_name(&self, id: JointId) -> String {
        let joint = self.s.world.as_ref().and_then(|world| world.joints.get(usize::from(id.0)));
        joint.map_or_else(String::new, |j| j.name.rsplit('.').next().unwrap_or_default().to_owned())
    }

    /// The body that this one is rigidly one with: the topmost over joints that cannot move.
    pub(in crate::check::world) fn rigid_root(&self, body: BodyId) -> BodyId {
        let Some(world) = &self.s.world else { return body };
        if let Some(placed) = self.robots.iter().find(|robot| robot.link_of(body).is_some())
            && let (Some(link), Some(robot)) = (placed.link_of(body), placed.robot())
        {
            let top: Option<UrdfLinkId> = robot.rigid_groups().get(link.0).copied();
            return top.and_then(|top| placed.bodies.get(top.0)).copied().unwrap_or(body);
        }
        let mut at = body;
        for _ in 0..world.joints.len() {
            let above = world.joints.iter().find(|j| j.child == at && j.lo == 0.0 && j.hi == 0.0);
            match above {
                Some(joint) => at = joint.parent,
                None => break,
            }
        }
        at
    }

    /// Whether it is a joint that cannot move.
    pub(in crate::check::world) fn is_fixed_joint(&self, id: JointId) -> bool {
        let joint = self.s.world.as_ref().and_then(|world| world.joints.get(usize::from(id.0)));
        joint.is_some_and(|joint| joint.lo == 0.0 && joint.hi == 0.0)
    }
}
