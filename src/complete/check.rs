//! The contract's last word: a fill is rounded as the caller will see it, then tested exactly
//! against itself, the mesh and the other fills, and repaired where it meets them.

use super::smooth::Surroundings;
use crate::error::Result;
use crate::fill::patch::Patch;
use crate::intersect::Soup;
use crate::mesh::neighbourhood::{Bounds, Grid, Neighbourhood};
use crate::mesh::MeshView;
use crate::progress::Monitor;
use glam::DVec3;
use std::borrow::Cow;

/// Rounds of smoothing around the faces that meet others; most need one or two, and what eight
/// do not mend is wrong at a larger scale.
const REPAIRS: usize = 8;

/// Repair is for local trouble: with more than a fiftieth of the faces (and 60 more, for small fills)
/// involved, another surface is tried at once.
const LOCAL: usize = 50;

/// The precision in which the caller gets the new vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rounding {
    /// f32.
    Single,
    /// f64: nothing to do.
    Double,
}

impl Rounding {
    /// The nearest position the caller can have.
    pub fn apply(self, p: DVec3) -> DVec3 {
        match self {
            Rounding::Single => p.as_vec3().as_dvec3(),
            Rounding::Double => p,
        }
    }
}

/// What a fill must not meet, beside the mesh near its hole.
pub struct Obstacles<'a> {
    /// The whole mesh, for fills that leave the neighbourhood.
    pub mesh: MeshView<'a>,
    /// The boxes that the neighbourhood covers.
    pub covered: &'a [Bounds],
    /// Triangles of other fills.
    pub others: &'a [[DVec3; 3]],
}

impl Obstacles<'_> {
    /// Rounds a patch, tests it, repairs it; says why when that fails. Asks `check` between rounds.
    pub fn settle(
        &self,
        around: &Surroundings<'_>,
        mut patch: Patch,
        check: &dyn Fn() -> Result<()>,
    ) -> Result<std::result::Result<Patch, String>> {
        let rim = patch.rim_count;
        let round_off = |patch: &mut Patch| {
            patch.positions[rim..].iter_mut().for_each(|p| *p = around.rounding.apply(*p));
        };
        round_off(&mut patch);
        // Repair averages, so it never leaves the box of the first test.
        let known = match self.triangles_near(around, &patch) {
            Ok(known) => known,
            Err(why) => return Ok(Err(why)),
        };
        for round in 0..=REPAIRS {
            check()?;
            let local = patch.triangles.len() / LOCAL + 60;
            let bad = bad_faces(&known, &patch, local);
            if bad.is_empty() {
                return Ok(Ok(patch));
            }
            let hopeless = bad.len() > local;
            if round == REPAIRS || hopeless || patch.positions.len() == rim {
                let [a, b, c] = patch.triangles[bad[0] as usize].map(|v| patch.p(v));
                let at = (a + b + c) / 3.0;
                let (x, y, z) = (at.x, at.y, at.z);
                let (faces, meet) =
                    if bad.len() == 1 { ("face", "meets") } else { ("faces", "meet") };
                return Ok(Err(format!(
                    "{}{} {faces} of its fill {meet} others, one near ({x:.6}, {y:.6}, {z:.6})",
                    if hopeless { "at least " } else { "" },
                    bad.len()
                )));
            }
            smooth_around(&mut patch, &bad, 2 + round / 4);
            round_off(&mut patch);
        }
        Ok(Err("its fill could not be repaired".into()))
    }

    /// Whether a settled patch meets the other fills.
    pub fn meets(&self, around: &Surroundings<'_>, patch: &Patch) -> bool {
        self.triangles_near(around, patch)
            .map_or(true, |known| !bad_faces(&known, patch, 0).is_empty())
    }

    /// Triangles of the mesh and of the other fills whose box meets that of the patch.
    fn triangles_near<'a>(
        &'a self,
        around: &'a Surroundings<'_>,
        patch: &Patch,
    ) -> std::result::Result<Known<'a>, String> {
        let query = Bounds::of(patch.positions.iter().copied());
        let (near, faces) = if self.covered.iter().any(|b| b.contains(&query)) {
            (Cow::Borrowed(around.near), around.places.meeting(around.near, &query))
        } else {
            let fresh = Neighbourhood::gather(self.mesh, &[query], &Monitor::silent())
                .map_err(|e| e.to_string())?;
            let all = (0..fresh.faces.len() as u32).collect();
            (Cow::Owned(fresh), all)
        };
        let meets = |t: &&[DVec3; 3]| Bounds::of_triangle(**t).overlaps(&query);
        Ok(Known { near, faces, others: self.others.iter().filter(meets).copied().collect() })
    }
}

/// What a fill must not meet. Faces by their numbers: a fill around an object has most of the mesh in
/// its box.
struct Known<'a> {
    near: Cow<'a, Neighbourhood>,
    faces: Vec<u32>,
    others: Vec<[DVec3; 3]>,
}

impl Known<'_> {
    fn len(&self) -> usize {
        self.faces.len() + self.others.len()
    }

    fn triangle(&self, i: usize) -> [DVec3; 3] {
        match self.faces.get(i) {
            Some(&f) => self.near.corners(f),
            None => self.others[i - self.faces.len()],
        }
    }
}

/// Faces of the patch that have no area or meet one another or a known triangle. Shared vertices
/// are told by their positions, so the known triangles need no common numbering. With more than `most`
/// only some of them are named.
fn bad_faces(known: &Known<'_>, patch: &Patch, most: usize) -> Vec<u32> {
    let triangle = |t: &[u32; 3]| t.map(|v| patch.p(v));
    // The box of a fill holds much that comes nowhere near it.
    let cells = Grid::new(patch.triangles.iter().map(|t| Bounds::of_triangle(triangle(t))));
    let is_near = |i: &u32| cells.meets(&Bounds::of_triangle(known.triangle(*i as usize)));
    let near: Vec<u32> = (0..known.len() as u32).filter(is_near).collect();
    let fill_start = near.len();
    let soup = Soup {
        count: fill_start + patch.triangles.len(),
        corners: |f: usize| match near.get(f) {
            Some(&i) => known.triangle(i as usize),
            None => triangle(&patch.triangles[f - fill_start]),
        },
    };
    let mut bad = soup.degenerate_faces(fill_start);
    bad.extend(soup.faces_that_meet(fill_start, most));
    bad.iter_mut().for_each(|f| *f -= fill_start as u32);
    bad.sort_unstable();
    bad.dedup();
    bad
}

/// Moves the new vertices within `rings` of the faces given to the average of their neighbours.
fn smooth_around(patch: &mut Patch, faces: &[u32], rings: usize) {
    let mut chosen = vec![false; patch.positions.len()];
    faces.iter().flat_map(|&f| patch.triangles[f as usize]).for_each(|v| chosen[v as usize] = true);
    for _ in 0..rings {
        let before = chosen.clone();
        for tri in &patch.triangles {
            if tri.iter().any(|&v| before[v as usize]) {
                tri.iter().for_each(|&v| chosen[v as usize] = true);
            }
        }
    }
    let mut fan = Vec::new();
    for _ in 0..3 {
        for v in patch.rim_count..patch.positions.len() {
            if !chosen[v] {
                continue;
            }
            patch.fan(v as u32, &mut fan);
            let sum: DVec3 =
                fan.iter().map(|&(t, k)| patch.p(patch.triangles[t as usize][(k + 1) % 3])).sum();
            patch.positions[v] = 0.5 * (patch.positions[v] + sum / fan.len() as f64);
        }
    }
}
