//! The initial completion projected onto an aligned source, exactly: where each vertex's line meets
//! the source's triangles.

use super::domain::Domain;
use crate::matching::paint::squared_difference;
use crate::matching::rigid::Rigid;
use crate::matching::similarity::size_change;
use crate::matching::source::Source;
use glam::DVec3;

/// Farthest a vertex may move, in hole radii.
const REACH: f64 = 0.8;
/// Least cosine between a vertex's line and the source's face.
const FACING: f64 = 0.1;
/// Share of the fill that a source must cover; fewer kills the hole's own place, too.
const COVER: f64 = 0.97;
/// Share of the ring.
const RING_COVER: f64 = 0.85;

/// A place on the source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Index into [`SourceMesh::faces`](crate::matching::source::SourceMesh::faces).
    pub face: u32,
    /// Barycentric coordinates on it.
    pub barycentric: [f64; 3],
}

/// One source seen from the domain.
#[derive(Clone)]
pub struct Copy {
    /// From source to target.
    pub transform: Rigid,
    /// Height at each domain vertex, in mesh units.
    pub heights: Vec<f64>,
    /// Unit normal of the aligned source there.
    pub normals: Vec<DVec3>,
    /// Where on the source; `None` where the height was filled in.
    pub places: Vec<Option<Place>>,
    /// Mean roughness of the source over the fill, see [`SourceMesh::roughness`](crate::matching::source::SourceMesh::roughness).
    pub roughness: f64,
    /// Its colours by domain vertex, row after row; empty without colours.
    pub rows: Vec<f64>,
    /// Squared difference from the known colour, by domain vertex; empty without colours.
    pub stain: Vec<f64>,
}

/// Projects the whole domain; `None` if the source covers too little of it.
pub fn project(domain: &Domain, source: &Source, transform: &Rigid) -> Option<Copy> {
    let back = transform.inverse();
    let n = domain.sheet.positions.len();
    let mut copy = Copy {
        transform: *transform,
        heights: vec![f64::NAN; n],
        normals: vec![DVec3::ZERO; n],
        places: vec![None; n],
        roughness: 0.0,
        rows: Vec::new(),
        stain: Vec::new(),
    };
    let mut missing = 0;
    let allowed = ((1.0 - COVER) * domain.fill.len() as f64) as usize;
    for v in domain.fill.clone() {
        if !meet(domain, source, &back, v, &mut copy) {
            missing += 1;
            if missing > allowed {
                return None;
            }
        }
    }
    let mut missing = 0;
    for &v in &domain.ring {
        missing += usize::from(!meet(domain, source, &back, v, &mut copy));
    }
    if missing as f64 > (1.0 - RING_COVER) * domain.ring.len() as f64 {
        return None;
    }
    fill_in(domain, &mut copy);
    let (mut rough, mut count) = (0.0, 0.0);
    for place in domain.fill.clone().filter_map(|v| copy.places[v]) {
        let corners = source.faces[place.face as usize].map(|v| source.roughness[v as usize]);
        rough += (0..3).map(|k| place.barycentric[k] * corners[k]).sum::<f64>();
        count += 1.0;
    }
    copy.roughness = rough / f64::max(count, 1.0);
    paint(domain, source, &mut copy);
    Some(copy)
}

/// Where a vertex's line meets the source, and how far from it, in mesh units. `back`: from the target to the
/// source.
pub fn place_of(domain: &Domain, source: &Source, back: &Rigid, v: usize) -> Option<(Place, f64)> {
    let (origin, direction) = (domain.sheet.positions[v], domain.directions[v]);
    meet_source(source, back, (origin, direction), REACH * domain.radius)
}

/// The same of any line, from its origin along a unit vector to both sides.
pub fn meet_source(
    source: &Source,
    back: &Rigid,
    (origin, direction): (DVec3, DVec3),
    reach: f64,
) -> Option<(Place, f64)> {
    let (origin, direction) = (back.point(origin), back.direction(direction));
    // A reflection turns the corners' order around, not the outward normal.
    let facing = FACING * size_change(back);
    let accept = |face: u32, t: &[DVec3; 3]| {
        let n = (t[1] - t[0]).cross(t[2] - t[0]);
        n.dot(direction) > facing * n.length() && !source.is_own(face)
    };
    let (face, height) = source.tree.meet_line(origin, direction, reach, accept)?;
    let barycentric = source.barycentric(face, origin + height * direction);
    Some((Place { face, barycentric }, height))
}

fn meet(domain: &Domain, source: &Source, back: &Rigid, v: usize, copy: &mut Copy) -> bool {
    let Some((place, height)) = place_of(domain, source, back, v) else { return false };
    let Place { face, barycentric } = place;
    copy.heights[v] = height;
    // Normals go by the inverse transpose, which differs where the copy is stretched.
    let normal = back.linear.transpose() * source.smooth_normal(face, barycentric);
    copy.normals[v] = normal.normalize_or_zero();
    copy.places[v] = Some(place);
    true
}

/// The colours of the copy, and how far they are from those of the ring. Where there is no place they
/// are the mean colour, a whole spread off.
fn paint(domain: &Domain, source: &Source, copy: &mut Copy) {
    let (Some(known), Some(of_source)) = (&domain.paint, &source.paint) else { return };
    for (v, place) in copy.places.iter().enumerate() {
        let Some(place) = place else {
            copy.rows.resize(copy.rows.len() + known.channels, 0.0);
            copy.stain.push(1.0);
            continue;
        };
        let corners = source.faces[place.face as usize];
        of_source.push_row(corners, place.barycentric, &mut copy.rows);
        let row = &copy.rows[v * known.channels..];
        copy.stain.push(squared_difference(row, known.row(v)));
    }
}

/// Heights where the source has a gap: means of the neighbours, from the known ones outward.
fn fill_in(domain: &Domain, copy: &mut Copy) {
    loop {
        let mut found = Vec::new();
        for v in 0..copy.heights.len() {
            if !copy.heights[v].is_nan() {
                continue;
            }
            let (mut sum, mut count, mut normal) = (0.0, 0.0, DVec3::ZERO);
            for (w, _) in domain.laplacian.row(v) {
                if !copy.heights[w].is_nan() {
                    sum += copy.heights[w];
                    normal += copy.normals[w];
                    count += 1.0;
                }
            }
            if count > 0.0 {
                found.push((v, sum / count, normal.normalize_or_zero()));
            }
        }
        if found.is_empty() {
            break;
        }
        for (v, height, normal) in found {
            (copy.heights[v], copy.normals[v]) = (height, normal);
        }
    }
    copy.heights.iter_mut().filter(|h| h.is_nan()).for_each(|h| *h = 0.0);
}
