//! Hulls that were found already: those of this process, and of a store that somebody hands in.

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, OnceLock, PoisonError},
};

use hrdsl_ir::{
    solid::{SolidGeometry, SolidMesh},
    world::World,
};
use rapier3d::prelude::*;

use super::{
    ConvexPiece, MeshHulls,
    decompose::{PARAMETERS, decompose},
};

/// Where hulls are kept from one process to the next. What it gives need not be trusted: it is looked at.
pub trait HullStore {
    /// What was kept under a key, which is a name that a file can have.
    fn load(&self, key: &str) -> Option<Vec<u8>>;

    /// Keeps it, or does not.
    fn save(&self, key: &str, bytes: &[u8]);
}

/// By digest. The value follows from the key, so that it does not matter who entered it.
static FOUND: OnceLock<Mutex<BTreeMap<String, Arc<MeshHulls>>>> = OnceLock::new();

fn found() -> &'static Mutex<BTreeMap<String, Arc<MeshHulls>>> {
    FOUND.get_or_init(Mutex::default)
}

fn known(digest: &str) -> Option<Arc<MeshHulls>> {
    found().lock().unwrap_or_else(PoisonError::into_inner).get(digest).cloned()
}

fn enter(digest: &str, hulls: MeshHulls) -> Arc<MeshHulls> {
    let hulls = Arc::new(hulls);
    found().lock().unwrap_or_else(PoisonError::into_inner).insert(digest.to_owned(), Arc::clone(&hulls));
    hulls
}

/// The hulls of a mesh.
pub(crate) fn hulls_of(mesh: &SolidMesh) -> Arc<MeshHulls> {
    known(&mesh.digest).unwrap_or_else(|| enter(&mesh.digest, decompose(mesh)))
}

/// Finds the hulls of all meshes of a world, in the store if it has them, so that worlds are then built without delay. Gives how
/// many meshes there are, how many hulls, and how far these may be within the meshes' own hulls, m.
pub fn warm_hulls(world: &World, store: &dyn HullStore) -> (usize, usize, f64) {
    let mut meshes: BTreeMap<&str, &SolidMesh> = BTreeMap::new();
    for shape in world.bodies.iter().filter_map(|body| body.solid.as_ref()).flat_map(|solid| &solid.shapes) {
        if let SolidGeometry::Mesh(mesh) = &shape.geometry {
            meshes.insert(&mesh.digest, mesh);
        }
    }
    let (mut count, mut error) = (0, 0.0f64);
    for mesh in meshes.values() {
        let hulls = known(&mesh.digest).unwrap_or_else(|| {
            let key = format!("{PARAMETERS}-{}", mesh.digest);
            let kept = store.load(&key).and_then(|bytes| read(&bytes));
            let hulls = kept.unwrap_or_else(|| {
                let hulls = decompose(mesh);
                store.save(&key, &written(&hulls));
                hulls
            });
            enter(&mesh.digest, hulls)
        });
        count += hulls.pieces.len();
        error = error.max(f64::from(hulls.error));
    }
    (meshes.len(), count, error)
}

/// The error and, for each piece, the number of its corners and these, in 4 bytes each; then their sum, which tells a file
/// that was cut off from one that is whole.
fn written(hulls: &MeshHulls) -> Vec<u8> {
    let mut bytes = hulls.error.to_le_bytes().to_vec();
    for piece in &hulls.pieces {
        let corners = u32::try_from(piece.corners.len()).unwrap_or(u32::MAX);
        bytes.extend(corners.to_le_bytes());
        for corner in &piece.corners {
            bytes.extend([corner.x, corner.y, corner.z].iter().flat_map(|x| x.to_le_bytes()));
        }
    }
    bytes.extend(sum(&bytes).to_le_bytes());
    bytes
}

/// The sum of FNV-1a.
fn sum(bytes: &[u8]) -> u32 {
    bytes.iter().fold(0x811c_9dc5, |sum: u32, byte| (sum ^ u32::from(*byte)).wrapping_mul(0x0100_0193))
}

fn read(bytes: &[u8]) -> Option<MeshHulls> {
    let (data, end) = bytes.split_at_checked(bytes.len().checked_sub(4)?)?;
    if end != sum(data).to_le_bytes() {
        return None;
    }
    let mut words = data.chunks_exact(4).map(|word| <[u8; 4]>::try_from(word).unwrap_or_default());
    let error = f32::from_le_bytes(words.next()?);
    let mut pieces = Vec::new();
    while let Some(count) = words.next() {
        let mut corners = Vec::new();
        for _ in 0..u32::from_le_bytes(count) {
            let mut number = || words.next().map(f32::from_le_bytes).filter(|x| x.is_finite());
            corners.push(Vector::new(number()?, number()?, number()?));
        }
        pieces.push(ConvexPiece::new(corners)?);
    }
    (!pieces.is_empty()).then_some(MeshHulls { pieces, error })
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use hrdsl_ir::solid::{PlacedSolid, SharedData, SolidBody};

    use super::*;
    use crate::samples::{body, cuboid, flat};
    use hrdsl_ir::world::BodyMotion;

    /// A ring of so many corners, not convex.
    fn ring(corners: u32) -> SolidMesh {
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for i in 0..corners {
            let angle = std::f32::consts::TAU * i as f32 / corners as f32;
            for (radius, z) in [(0.1, 0.0), (0.1, 0.04), (0.07, 0.04), (0.07, 0.0)] {
                points.push([radius * libm::cosf(angle), radius * libm::sinf(angle), z]);
            }
            let next = (i + 1) % corners;
            for (a, b) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
                triangles.push([4 * i + a, 4 * next + a, 4 * next + b]);
                triangles.push([4 * i + a, 4 * next + b, 4 * i + b]);
            }
        }
        SolidMesh { digest: format!("ring of {corners}"), points, triangles }
    }

    #[derive(Default)]
    struct InMemory(RefCell<BTreeMap<String, Vec<u8>>>);

    impl HullStore for InMemory {
        fn load(&self, key: &str) -> Option<Vec<u8>> {
            self.0.borrow().get(key).cloned()
        }

        fn save(&self, key: &str, bytes: &[u8]) {
            self.0.borrow_mut().insert(key.to_owned(), bytes.to_vec());
        }
    }

    #[test]
    fn what_a_store_gives_back_is_what_was_found() {
        let found = decompose(&ring(90));
        let bytes = written(&found);
        let back = read(&bytes).expect("hulls");
        assert_eq!(written(&back), bytes);
        assert!(read(&bytes[..bytes.len() - 12]).is_none() && read(&[]).is_none());
        let mut other = bytes.clone();
        other[9] ^= 1;
        assert!(read(&other).is_none());
    }

    #[test]
    fn a_ring_keeps_its_hole_and_a_ball_is_one_hull() {
        let hulls = decompose(&ring(48));
        assert!(hulls.pieces.len() > 3, "{}", hulls.pieces.len());
        let middle = Vector::new(0.0, 0.0, 0.02);
        let is_in = |piece: &ConvexPiece| piece.shape.contains_local_point(middle);
        assert!(!hulls.pieces.iter().any(is_in));
        let again = decompose(&ring(48));
        assert_eq!(written(&again), written(&hulls));
    }

    #[test]
    fn hulls_have_few_corners_and_say_what_that_costs() {
        let (points, triangles) = SharedShape::ball(0.1).as_ball().expect("a ball").to_trimesh(40, 40);
        let points = points.iter().map(|p| [p.x, p.y, p.z]).collect();
        let hulls = decompose(&SolidMesh { digest: "ball".into(), points, triangles });
        assert_eq!(hulls.pieces.len(), 1);
        assert!(hulls.pieces[0].corners.len() <= 64);
        assert!(hulls.error > 0.0 && hulls.error < 0.006, "{}", hulls.error);
    }

    #[test]
    fn a_flat_mesh_is_a_thin_box() {
        let points = vec![[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.2, 0.1, 0.0], [0.0, 0.1, 0.0]];
        let hulls =
            decompose(&SolidMesh { digest: "flat".into(), points, triangles: vec![[0, 1, 2], [0, 2, 3]] });
        let size = hulls.pieces[0].shape.compute_local_aabb().extents();
        assert!((size - Vector::new(0.2, 0.1, 1e-3)).length() < 1e-6, "{size}");
    }

    #[test]
    fn a_store_is_asked_once_for_each_mesh() {
        let geometry = SolidGeometry::Mesh(SharedData::new(ring(60)));
        let shape = PlacedSolid { position: [0.0; 3], rotation: [0.0; 3], geometry };
        let solid = SolidBody { shapes: vec![shape.clone(), shape], ..SolidBody::default() };
        let mut part = body("ring", BodyMotion::Fixed, cuboid(0.1, 0.1, 0.1), [0.0; 3]);
        part.solid = Some(SharedData::new(solid));
        let store = InMemory::default();
        let (meshes, hulls, _) = warm_hulls(&flat(vec![part]), &store);
        assert_eq!((meshes, store.0.borrow().len()), (1, 1));
        assert!(hulls > 1);
    }
}
