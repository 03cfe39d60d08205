//! Standard smooth fills and the completions continued from them, kept: another fairing or size of triangles makes
//! none of them anew. A fill that copies are trusted in is the same whatever the fairing; where they are doubted it
//! leans on the smooth fill, and the difference between that and the standard one is added.

use super::resized::resize;
use super::smooth::{Fill, Story, Surroundings};
use crate::error::Result;
use crate::fill::patch::Patch;
use crate::guidance::Guidance;
use crate::intersect::Bvh;
use crate::matching::source::Source;
use crate::mesh::neighbourhood::Neighbourhood;
use crate::mesh::normals::vertex_normals;
use crate::options::Method;
use glam::DVec3;
use std::sync::{Arc, Mutex, PoisonError};

/// Fills and completions kept, of each; the latter of a hole of a thousand vertices takes some 300 kilobytes.
const KEPT: usize = 64;

/// Standard fills of the last holes, by the rims and by what they are only joined at, in input vertices.
#[derive(Default)]
pub struct Standards(Mutex<Vec<([Vec<u32>; 2], Fill)>>);

impl Standards {
    /// The standard fill of a hole whose loops are given in neighbourhood vertices, made if it is not there.
    pub fn find(
        &self,
        near: &Neighbourhood,
        loops: &[Vec<u32>],
        make: impl FnOnce() -> Result<std::result::Result<Fill, String>>,
    ) -> Result<std::result::Result<Fill, String>> {
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let input = |v: &u32| near.vertices[*v as usize];
        let key =
            [loops.iter().flatten().map(input).collect(), near.loose.iter().map(input).collect()];
        let kept = lock().iter().find(|(own, _)| *own == key).map(|k| k.1.clone());
        if let Some(mut fill) = kept {
            // The neighbourhood may be another: that of more holes.
            fill.outline.vertices = loops.concat();
            return Ok(Ok(fill));
        }
        let made = make()?;
        if let Ok(fill) = &made {
            let mut all = lock();
            if all.len() == KEPT {
                all.remove(0);
            }
            all.push((key, fill.clone()));
        }
        Ok(made)
    }
}

/// What became of a hole.
#[derive(Clone)]
pub struct Finished {
    /// What was made of it, if anything serves. While it is kept, the story's ring is of input vertices.
    pub made: Option<(Patch, Story)>,
    /// How many candidates it had, if one was asked for.
    pub candidates: usize,
}

/// All that a completion depends on but the library.
struct Asked {
    fill: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    method: Method,
    guidance: Guidance,
}

/// The last completions of a library's holes.
#[derive(Default)]
pub struct Completions(Mutex<Vec<(Asked, Arc<Finished>)>>);

impl Completions {
    /// The completion of a hole from a fill, made if it is not there.
    pub fn find(
        &self,
        around: &Surroundings<'_>,
        fill: &Fill,
        (method, guidance): (Method, &Guidance),
        make: impl FnOnce() -> Result<Finished>,
    ) -> Result<Finished> {
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let same = |(asked, _): &&(Asked, Arc<Finished>)| {
            asked.fill == fill.patch.positions
                && asked.triangles == fill.patch.triangles
                && asked.method == method
                && asked.guidance == *guidance
        };
        let near = around.near;
        let kept = lock().iter().find(same).map(|k| k.1.clone());
        if let Some(kept) = kept {
            // As for the fills above.
            let mut found = Finished::clone(&kept);
            if let Some((_, story)) = &mut found.made {
                story.ring.retain_mut(|seam| match near.local(seam.vertex) {
                    Some(own) => {
                        seam.vertex = own;
                        true
                    }
                    None => false,
                });
            }
            return Ok(found);
        }
        let made = make()?;
        let mut kept = made.clone();
        if let Some((_, story)) = &mut kept.made {
            story
                .ring
                .iter_mut()
                .for_each(|seam| seam.vertex = near.vertices[seam.vertex as usize]);
        }
        let asked = Asked {
            fill: fill.patch.positions.clone(),
            triangles: fill.patch.triangles.clone(),
            method,
            guidance: guidance.clone(),
        };
        let mut all = lock();
        if all.len() == KEPT {
            all.remove(0);
        }
        all.push((asked, Arc::new(kept)));
        Ok(made)
    }
}

/// A completion as the caller wants it. `standard`: the fill it was continued from; `own`: one with the caller's
/// fairing, if that is another and has a say.
pub fn as_wanted(
    (patch, story): (Patch, Story),
    standard: &Fill,
    own: Option<&Fill>,
    around: &Surroundings<'_>,
    source: &Source,
    threads: usize,
    check: &dyn Fn() -> Result<()>,
) -> Result<Option<(Patch, Story)>> {
    let mut patch = patch;
    if let Some(own) = own {
        lean(&mut patch, &standard.patch, &own.patch, story.doubt);
    }
    if around.sizing == around.standard().sizing {
        return Ok(Some((patch, story)));
    }
    resize((&patch, &story), standard, around.sizing, source, threads, check)
}

/// Moves a completion by `share` of the way from one smooth fill, whose vertices it has, to another.
fn lean(patch: &mut Patch, standard: &Patch, own: &Patch, share: f64) {
    let tree = Bvh::new(&own.positions, &own.triangles);
    let normals = vertex_normals(&standard.positions, standard.triangles.iter().copied());
    let bounds = tree.bounds();
    let reach = 0.5 * bounds.lo.distance(bounds.hi);
    for v in patch.rim_count..patch.positions.len() {
        let (p, n) = (standard.positions[v], normals[v]);
        let facing = |_: u32, t: &[DVec3; 3]| (t[1] - t[0]).cross(t[2] - t[0]).dot(n) > 0.0;
        let there = match tree.meet_line(p, n, reach, facing) {
            Some((_, height)) => p + height * n,
            None => tree.closest_point(p, f64::INFINITY).map_or(p, |c| c.point),
        };
        patch.positions[v] += share * (there - p);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square with a vertex in the middle, that lifted.
    fn pyramid(height: f64) -> Patch {
        let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let rim = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        let positions = rim.into_iter().chain([DVec3::new(0.0, 0.0, height)]).collect();
        let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        Patch::of_triangles(positions, vec![1.0; 5], 4, triangles)
    }

    /// What a completion adds to the standard fill it adds to a part of the other one.
    #[test]
    fn a_doubted_completion_leans_on_the_callers_fill() {
        let (standard, own) = (pyramid(0.25), pyramid(0.75));
        for share in [0.0, 0.5, 1.0] {
            let mut made = pyramid(0.3);
            lean(&mut made, &standard, &own, share);
            assert_eq!(made.positions[..4], standard.positions[..4]);
            let wanted = DVec3::new(0.0, 0.0, 0.3 + 0.5 * share);
            assert!(made.positions[4].distance(wanted) < 1e-12, "{}", made.positions[4]);
        }
    }
}
