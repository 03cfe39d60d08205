//! A missing part taken whole, with its own triangles, from where a transform lays an intact one over the
//! hole: a hand, a foot, a spout, whose rim is far from flat and which no smooth surface comes near to.
//!
//! Park, Guo, Shin and Qin (2006), Sec. 5.3 to 6.3, do so by hand: a curve is drawn around the part, which
//! is then moved, mirrored if need be, and warped to the rim by the Poisson equation. Differences from the
//! paper:
//! - The curve is found: a vertex of the source belongs to the part if, laid over the mesh, the nearest
//!   known place is on the rim, or if it is far from all that is known.
//! - The gap between part and rim is triangulated; the result is one mesh.

mod cut;
mod gap;

use super::check::Obstacles;
use super::initial::check_edges;
use super::library::Library;
use super::smooth::{Fill, Story, Surroundings};
use super::{guided, Completer};
use crate::error::Result;
use crate::fill::outline::Outline;
use crate::fill::patch::Patch;
use crate::fill::sheet::{Band, Incidence};
use crate::holes::Hole;
use crate::matching::icp::RingPoint;
use crate::matching::rigid::Rigid;
use crate::matching::search::{Loose, Target};
use crate::matching::similarity::{gap as gap_of, scale_of};
use crate::mesh::MeshView;
use crate::options::{Fairing, Method, Options};
use crate::result::{Origin, SourceReport};
use cut::{bend, cut_out, Cut};
use gap::{close_gap, Shore};
use glam::DVec3;
use std::collections::HashMap;
use std::slice::from_ref;

/// One hole and where its part is taken from.
pub struct Wanted<'a> {
    /// The whole mesh.
    pub mesh: MeshView<'a>,
    /// What is known and what may be copied from.
    pub library: &'a Library,
    /// Loops of the rim, in input vertices.
    pub rim: &'a [Vec<u32>],
    /// The same in vertices of the neighbourhood.
    pub local: &'a [Vec<u32>],
    /// Known points around it.
    pub ring: &'a [RingPoint],
    /// What is known around it.
    pub shore: &'a Shore,
    /// The source's faces by vertex.
    pub incidence: &'a Incidence,
}

/// Rings of known surface around the rim that a part is aligned with, at least and at most; between them half
/// as wide as the hole.
const RINGS: (f64, f64) = (4.0, 24.0);

/// Known points around a hole, whose loops are given in vertices of the neighbourhood.
pub fn ring_around(
    around: &Surroundings<'_>,
    library: &Library,
    loops: &[Vec<u32>],
) -> Vec<RingPoint> {
    let outline = Outline::new(around.near, &around.incidence.get(), loops);
    let rings = (0.5 * outline.radius() / outline.mean_size()).clamp(RINGS.0, RINGS.1);
    let band = Band::grow(around.near, &around.incidence.get(), &outline.vertices, rings as usize);
    let known = &library.known;
    let point = |&v: &u32| {
        let v = around.near.vertices[v as usize] as usize;
        (known.positions[v], known.normals[v], known.tint(v))
    };
    band.vertices.iter().map(point).filter(|p| p.1 != DVec3::ZERO).collect()
}

/// What places are searched for by. `rim`: positions of the rim.
pub fn target_of<'a>(ring: &'a [RingPoint], rim: &'a [DVec3]) -> Target<'a> {
    let centre = rim.iter().sum::<DVec3>() / rim.len().max(1) as f64;
    let radius = rim.iter().map(|p| p.distance(centre)).fold(0.0, f64::max);
    let normal = ring.iter().map(|p| p.1).sum::<DVec3>().normalize_or(DVec3::Z);
    Target { centre, normal, radius, fill: rim, ring, loose: Loose::default(), emphasis: 1.0 }
}

impl Completer<'_> {
    /// Fills a hole with a part that lies over it whole: the one that was placed, or the first of the places
    /// found (of a number, the one of that number) that keeps the contract.
    pub(super) fn fill_with_part(
        &self,
        around: &Surroundings<'_>,
        obstacles: &Obstacles<'_>,
        (hole, loops): (&Hole, &[Vec<u32>]),
        options: &Options,
        threads: usize,
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<std::result::Result<Fill, String>> {
        let library = self.library(options, &[], &|part| check(0.3 * part))?;
        let rim: Vec<Vec<u32>> =
            hole.loops.iter().map(|&l| self.holes.loops[l].vertices.clone()).collect();
        let ring = ring_around(around, &library, loops);
        let at = |&v: &u32| library.known.positions[v as usize];
        let positions: Vec<DVec3> = rim.iter().flatten().map(at).collect();
        let target = target_of(&ring, &positions);
        let guidance = &options.guidance;
        let late = |part: f64| check(0.3 + 0.4 * part);
        let found = guided::transforms(&library, guidance, from_ref(&target), threads, &late)?;
        let source = library.source();
        let wanted = Wanted {
            mesh: self.mesh,
            library: &library,
            rim: &rim,
            local: loops,
            ring: &ring,
            shore: &Shore::new(around, &self.reach(hole)),
            incidence: &Incidence::of(source.positions.len(), &source.faces),
        };
        let (mut first, mut good) = (None, 0);
        let places: Vec<&Rigid> = found.iter().flatten().collect();
        for (i, transform) in places.iter().enumerate() {
            let late = |part: f64| check(0.7 + 0.3 * (i as f64 + part) / places.len() as f64);
            let made = take_part(around, obstacles, &wanted, transform, &late)?;
            match made {
                Ok(fill) => {
                    good += 1;
                    if good >= guidance.candidate {
                        return Ok(Ok(Fill { candidates: good.min(guidance.candidate), ..fill }));
                    }
                }
                Err(why) => first = first.or(Some(why)),
            }
        }
        Ok(Err(match (first, good) {
            (Some(why), 0) => why,
            (None, 0) => "no place with surroundings like its own was found: give the part's \
                          transform"
                .into(),
            _ => format!("only {good} places have a part for it"),
        }))
    }
}

/// The hole filled with the part that a transform lays there. The inner error says why that cannot be.
pub fn take_part(
    around: &Surroundings<'_>,
    obstacles: &Obstacles<'_>,
    wanted: &Wanted<'_>,
    transform: &Rigid,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<std::result::Result<Fill, String>> {
    let mut cut = match cut_out(wanted, transform, &|| check(0.0))? {
        Ok(cut) => cut,
        Err(why) => return Ok(Err(why)),
    };
    check(0.3)?;
    if bend(&mut cut, wanted, transform).is_none() {
        return Ok(Err("its part cannot be bent to the rim".into()));
    }
    cut.positions.iter_mut().for_each(|p| *p = around.rounding.apply(*p));
    let late = |part: f64| check(0.5 + 0.3 * part);
    let (gap_vertices, gap_faces) = match close_gap(around, wanted, &cut, &late)? {
        Ok(found) => found,
        Err(why) => return Ok(Err(why)),
    };
    let outline = Outline::new(around.near, &around.incidence.get(), wanted.local);
    let input = wanted.mesh.vertices.len() as u32;
    let rim = outline.vertices.iter().map(|&v| around.near.vertices[v as usize]);
    let number: HashMap<u32, u32> = rim.enumerate().map(|(i, v)| (v, i as u32)).collect();
    let count = outline.vertices.len() as u32;
    let index = |v: u32| match v.checked_sub(input) {
        Some(new) => Some(count + new),
        None => number.get(&v).copied(),
    };
    let of_part = cut.faces.iter().map(|f| f.map(|v| v + input));
    let triangles: Option<Vec<[u32; 3]>> = (of_part.chain(gap_faces))
        .map(|f| Some([index(f[0])?, index(f[1])?, index(f[2])?]))
        .collect();
    let Some(triangles) = triangles else {
        return Ok(Err("its part does not end at the rim".into()));
    };
    if let Err(why) = check_edges(&triangles, &outline) {
        return Ok(Err(format!("its part {why}")));
    }
    let positions: Vec<DVec3> =
        outline.positions.iter().chain(&cut.positions).chain(&gap_vertices).copied().collect();
    let sizes = vec![outline.mean_size(); positions.len()];
    let patch = Patch::of_triangles(positions, sizes, outline.vertices.len(), triangles);
    let settled = obstacles.settle(around, patch, &|| check(0.9))?;
    let story = tell(wanted, &cut, &gap_vertices, transform);
    Ok(settled.map(|patch| Fill {
        outline,
        patch,
        fairing: Fairing::None,
        method: Method::Coherent,
        coherence_error: None,
        candidates: 0,
        story: Some(story),
    }))
}

/// Where each new vertex comes from.
fn tell(wanted: &Wanted<'_>, cut: &Cut, gap_vertices: &[DVec3], transform: &Rigid) -> Story {
    let source = wanted.library.source();
    let edge = wanted.library.known.edge;
    // The known ring says how far the part may be off, here in edges.
    let error = gap_of(source, wanted.ring, transform, edge / scale_of(&transform.inverse()));
    let confidence = 1.0 / (1.0 + (error / edge).powi(2));
    let mut corner = vec![(0u32, 0usize); cut.of.len()];
    let number: HashMap<u32, usize> = cut.of.iter().enumerate().map(|(i, &v)| (v, i)).collect();
    for &f in &cut.face_of {
        for (k, v) in source.faces[f as usize].iter().enumerate() {
            corner[number[v]] = (f, k);
        }
    }
    let origin = |face: u32, barycentric: [f64; 3]| Origin {
        face: source.face_ids[face as usize],
        barycentric,
        source: 0,
        confidence,
    };
    let of_part = corner.iter().map(|&(f, k)| {
        let mut at = [0.0; 3];
        at[k] = 1.0;
        origin(f, at)
    });
    let back = transform.inverse();
    let of_gap = gap_vertices.iter().map(|&p| {
        let hit = source.tree.closest_point(back.point(p), f64::INFINITY);
        hit.map_or(Origin::NOWHERE, |hit| origin(hit.face, source.barycentric(hit.face, hit.point)))
    });
    let origins: Vec<Origin> = of_part.chain(of_gap).collect();
    let first = cut.face_of.first().map_or(0, |&f| source.face_ids[f as usize]);
    let report = SourceReport {
        transform: source.as_given(transform, first),
        error,
        weight: 1.0,
        vertices: origins.len(),
        coloured: 0,
    };
    let (colours, seams, ring) = (Vec::new(), Vec::new(), Vec::new());
    let sources = vec![report];
    Story { origins, colours, sources, seams, ring, confidence, coherence_error: None, doubt: 0.0 }
}
