//! The boundary edges of a triangle mesh, in two linear passes and eight bytes a vertex.
//!
//! A vertex inside a consistently oriented manifold has the same vertices after it as before it,
//! face by face. So each face adds a hash of the next vertex and takes off that of the previous
//! one, and only where the sum is not zero can there be a boundary (or worse). The edges between
//! such vertices, few even in a large mesh, are then matched exactly. No half-edge structure of
//! the whole mesh is built: it would cost more than the fill.

use super::MeshView;
use crate::error::{Error, Result};
use crate::progress::Monitor;

/// Faces handled between two checks for cancelling.
const CHUNK: usize = 1 << 16;

/// A boundary edge, in the direction in which a filling face runs it: against its own face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BoundaryEdge {
    /// First vertex.
    pub from: u32,
    /// Second vertex.
    pub to: u32,
    /// The one face at this edge.
    pub face: u32,
}

/// What the scan found.
#[derive(Debug, Default)]
pub struct Boundary {
    /// All boundary edges, sorted by `from`, then `to`.
    pub edges: Vec<BoundaryEdge>,
    /// Edges with more than two faces, where the scan met them.
    pub non_manifold_edges: Vec<[u32; 2]>,
    /// Edges with two faces that run the same way.
    pub inconsistent_edges: Vec<[u32; 2]>,
    /// Faces that name a vertex twice.
    pub degenerate_faces: Vec<u32>,
}

/// Checks the arrays (finite positions, indices in range) and finds the boundary.
pub fn find_boundary(mesh: MeshView<'_>, monitor: &Monitor) -> Result<Boundary> {
    check_sizes(mesh)?;
    check_finite(mesh, monitor)?;
    let (balance, degenerate_faces) = balance(mesh, monitor)?;
    let mut half_edges = open_half_edges(mesh, &balance, monitor)?;
    let mut found = Boundary { degenerate_faces, ..Boundary::default() };
    match_half_edges(&mut half_edges, &mut found);
    Ok(found)
}

fn check_sizes(mesh: MeshView<'_>) -> Result<()> {
    // The last index is kept free as "none".
    let limit = u32::MAX as usize - 1;
    for (what, count) in [("vertices", mesh.vertices.len()), ("faces", mesh.faces.len())] {
        if count > limit {
            return Err(Error::TooLarge { what, count, limit });
        }
    }
    if mesh.faces.is_empty() {
        return Err(Error::Empty);
    }
    Ok(())
}

fn check_finite(mesh: MeshView<'_>, monitor: &Monitor) -> Result<()> {
    let n = mesh.vertices.len();
    for start in (0..n).step_by(CHUNK) {
        monitor.check()?;
        for vertex in start..n.min(start + CHUNK) {
            let [x, y, z] = mesh.vertices.get(vertex);
            // A sum of squares is finite only if all are; overflow counts as too large to handle.
            if !(x * x + y * y + z * z).is_finite() {
                return Err(Error::NonFinite { vertex });
            }
        }
    }
    Ok(())
}

/// Spreads an index over 64 bits (a multiply-xor-multiply finaliser): sums of such values vanish
/// only term by term, but for a chance of about 2⁻⁶⁴.
#[inline]
fn spread(v: u32) -> u64 {
    let x = (u64::from(v) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (x ^ (x >> 32)).wrapping_mul(0xd6e8_feb8_6659_fd93)
}

fn is_degenerate([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}

fn balance(mesh: MeshView<'_>, monitor: &Monitor) -> Result<(Vec<u64>, Vec<u32>)> {
    let vertex_count = mesh.vertices.len();
    let mut sum = vec![0u64; vertex_count];
    let mut degenerate = Vec::new();
    let n = mesh.faces.len();
    for start in (0..n).step_by(CHUNK) {
        monitor.check()?;
        for f in start..n.min(start + CHUNK) {
            let face = mesh.faces.get(f);
            let [a, b, c] = face.map(|v| v as usize);
            if a >= vertex_count || b >= vertex_count || c >= vertex_count {
                let index = [a, b, c].into_iter().find(|&v| v >= vertex_count).unwrap_or(a);
                return Err(Error::IndexOutOfRange { face: f, index, vertex_count });
            }
            if is_degenerate(face) {
                degenerate.push(f as u32);
                continue;
            }
            let [ha, hb, hc] = face.map(spread);
            sum[a] = sum[a].wrapping_add(hb.wrapping_sub(hc));
            sum[b] = sum[b].wrapping_add(hc.wrapping_sub(ha));
            sum[c] = sum[c].wrapping_add(ha.wrapping_sub(hb));
        }
    }
    Ok((sum, degenerate))
}

/// A half-edge between two vertices out of balance: (smaller, larger, runs upward, face).
type HalfEdge = (u32, u32, bool, u32);

fn open_half_edges(
    mesh: MeshView<'_>,
    balance: &[u64],
    monitor: &Monitor,
) -> Result<Vec<HalfEdge>> {
    let mut open = Vec::new();
    let n = mesh.faces.len();
    for start in (0..n).step_by(CHUNK) {
        monitor.check()?;
        for f in start..n.min(start + CHUNK) {
            let face = mesh.faces.get(f);
            let out = face.map(|v| balance[v as usize] != 0);
            if u8::from(out[0]) + u8::from(out[1]) + u8::from(out[2]) < 2 || is_degenerate(face) {
                continue;
            }
            for k in 0..3 {
                let (a, b) = (face[k], face[(k + 1) % 3]);
                if out[k] && out[(k + 1) % 3] {
                    open.push((a.min(b), a.max(b), a < b, f as u32));
                }
            }
        }
    }
    Ok(open)
}

fn match_half_edges(half_edges: &mut [HalfEdge], found: &mut Boundary) {
    half_edges.sort_unstable();
    for same in half_edges.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)) {
        let (a, b, upward, face) = same[0];
        match same.len() {
            // The fill runs against the face.
            1 if upward => found.edges.push(BoundaryEdge { from: b, to: a, face }),
            1 => found.edges.push(BoundaryEdge { from: a, to: b, face }),
            2 if upward == same[1].2 => found.inconsistent_edges.push([a, b]),
            2 => {}
            _ => found.non_manifold_edges.push([a, b]),
        }
    }
    found.edges.sort_unstable_by_key(|e| (e.from, e.to));
}
