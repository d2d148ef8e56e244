//! The walls of an occupancy map, as one fixed body of many boxes.

use hrdsl_ir::solid::{PlacedSolid, SharedData, SolidBody, SolidGeometry};
use hrdsl_syntax::ast::WorldMemberKind as Member;

use crate::check::world::parts::PlacedMember;
use crate::check::world::phase::WorldPhase;
use crate::{BodyMotion, BodyShape, Dimension, InferredType, noun::Noun, world::TypedBody};

impl<'a> WorldPhase<'_, 'a> {
    pub(in crate::check::world) fn walls(&mut self, p: &PlacedMember<'a>) {
        let Member::Walls(walls) = &p.member.kind else { return };
        let height = self.more_than_zero(&walls.height, Dimension::LENGTH, "the height of walls");
        let position = self.vector(&walls.at, InferredType::Float(Dimension::LENGTH)).unwrap_or_default();
        let angles = InferredType::Float(Dimension::ANGLE);
        let rotation = walls.rotated.as_ref().and_then(|r| self.vector(r, angles)).unwrap_or_default();
        let map = self.source.descriptions.and_then(|l| l.map(p.member.span.file, &walls.path.text));
        let height = height.unwrap_or(1.0);
        let shapes: Vec<PlacedSolid> = map
            .iter()
            .flat_map(|map| &map.walls)
            .map(|wall| {
                let ([x, y], [along, across]) = (wall.center, wall.size);
                let shape = BodyShape::Box { size: [along, across, height] };
                PlacedSolid {
                    position: [x, y, height / 2.0],
                    rotation: [0.0, 0.0, wall.yaw],
                    geometry: SolidGeometry::Plain(shape),
                }
            })
            .collect();
        let name = format!("{}{}", p.prefix, walls.name.text);
        let (issues, table) = (&mut self.checker.issues, &mut self.checker.world.names.bodies);
        if issues.declare_as(table, Noun::Body, &name, walls.name.span).is_none() {
            return;
        }
        let solid = SolidBody { shapes, mass: None, exempt: Vec::new(), origin: walls.path.span };
        let ghost = solid.is_frame();
        self.world_mut().bodies.push(TypedBody {
            name,
            motion: BodyMotion::Fixed,
            shape: BodyShape::Box { size: [height; 3] },
            frame: p.frame,
            position,
            rotation,
            mass: 0.0,
            ghost,
            stiffness: None,
            graspable: false,
            solid: Some(SharedData::new(solid)),
            own_name: None,
            span: p.member.span,
        });
    }
}
