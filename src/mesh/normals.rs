//! Normals of vertices.

use crate::error::Result;
use crate::progress::Pace;
use glam::DVec3;

/// Elementary steps that a face or a vertex counts for.
const STEPS: usize = 8;

/// Unit normals of vertices, faces counting by area; zero without faces that have one.
pub fn vertex_normals(
    positions: &[DVec3],
    faces: impl IntoIterator<Item = [u32; 3]>,
) -> Vec<DVec3> {
    match vertex_normals_checked(positions, faces, &|| Ok(())) {
        Ok(normals) => normals,
        Err(_) => unreachable!("nobody asked to stop"),
    }
}

/// The same; asks `check` now and then whether to go on.
pub fn vertex_normals_checked(
    positions: &[DVec3],
    faces: impl IntoIterator<Item = [u32; 3]>,
    check: &dyn Fn() -> Result<()>,
) -> Result<Vec<DVec3>> {
    let mut pace = Pace::new(check);
    let mut normals = vec![DVec3::ZERO; positions.len()];
    for face in faces {
        pace.work(STEPS)?;
        let [a, b, c] = face.map(|v| positions[v as usize]);
        let normal = (b - a).cross(c - a);
        face.iter().for_each(|&v| normals[v as usize] += normal);
    }
    for normal in &mut normals {
        pace.work(STEPS)?;
        *normal = normal.normalize_or_zero();
    }
    Ok(normals)
}
