//! Normals of vertices.

use glam::DVec3;

/// Unit normals of vertices, faces counting by area; zero without faces that have one.
pub fn vertex_normals(
    positions: &[DVec3],
    faces: impl IntoIterator<Item = [u32; 3]>,
) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; positions.len()];
    for face in faces {
        let [a, b, c] = face.map(|v| positions[v as usize]);
        let normal = (b - a).cross(c - a);
        face.iter().for_each(|&v| normals[v as usize] += normal);
    }
    normals.iter_mut().for_each(|n| *n = n.normalize_or_zero());
    normals
}
