//! Kwatra, Schödl, Essa, Turk, Bobick (2003), "Graphcut textures": which of the pieces laid over a vertex gives it
//! its values, so that the seams run where the pieces agree, and at the rim with what is known.
//!
//! Differences from the paper: all pieces are cut at once, by α-expansion ([`super::labels`]); the rim counts
//! as a piece that keeps its place.

use super::domain::Domain;
use super::labels::Energy;
use super::project::Place;
use super::quilt::Quilt;
use crate::error::Result;
use crate::matching::paint::squared_difference;
use crate::matching::rigid::Rigid;
use crate::matching::source::Source;
use glam::DVec3;

/// A piece over the rim's and the fill's vertices: where on the source; `None` beyond its reach.
pub type Over = Vec<Option<Place>>;

/// Lays the pieces over a domain, as far as they reach (`radius`, in mesh units).
pub fn lay(domain: &Domain, source: &Source, quilt: &Quilt, radius: f64) -> Vec<Over> {
    let one = |(piece, centre): &(Rigid, DVec3)| {
        let back = piece.inverse();
        let place = |v: usize| {
            let p = Some(domain.sheet.positions[v]).filter(|p| p.distance(*centre) <= radius)?;
            let hit = source.tree.closest_point(back.point(p), radius)?;
            let barycentric = source.barycentric(hit.face, hit.point);
            Some(Place { face: hit.face, barycentric })
        };
        (0..domain.fill.end).map(place).collect()
    };
    quilt.pieces.iter().map(one).collect()
}

/// Moves the borders of the pieces. Nothing happens without values.
pub fn cut(
    domain: &Domain,
    source: &Source,
    pieces: &[Over],
    mut labels: Vec<usize>,
    check: &dyn Fn() -> Result<()>,
) -> Result<Vec<usize>> {
    let (Some(known), Some(paint)) = (&domain.paint, &source.paint) else { return Ok(labels) };
    let (first, channels) = (domain.fill.start, paint.channels);
    // A vertex that its piece does not reach takes the first that does.
    let reaches = |v: usize| pieces.iter().position(|piece| piece[v].is_some());
    for (i, label) in labels.iter_mut().enumerate() {
        if pieces[*label][first + i].is_none() {
            *label = reaches(first + i).unwrap_or(*label);
        }
    }
    let (mut unary, mut rows) = (Vec::new(), Vec::new());
    for piece in pieces {
        let mut row = Vec::new();
        for place in piece {
            match place {
                Some(at) => {
                    paint.push_row(source.faces[at.face as usize], at.barycentric, &mut row);
                }
                None => row.resize(row.len() + channels, 0.0),
            }
        }
        let at_rim = |w: usize| match piece[w] {
            Some(_) => squared_difference(&row[w * channels..][..channels], known.row(w)).sqrt(),
            None => 0.0,
        };
        let cost = |v: usize| match piece[v] {
            // As a seam's, both ends' differences.
            Some(_) => {
                let rim = domain.laplacian.row(v).map(|(w, _)| w).filter(|&w| w < first);
                rim.map(|w| 2.0 * at_rim(w)).sum()
            }
            None if pieces[labels[v - first]][v].is_none() => 0.0,
            None => f64::INFINITY,
        };
        unary.push(domain.fill.clone().map(cost).collect::<Vec<f64>>());
        rows.push(row.split_off(first * channels));
    }
    let values = vec![vec![0.0; labels.len()]; pieces.len()];
    let edges = domain.fill_edges();
    let order: Vec<usize> = (0..pieces.len()).collect();
    let (values, rows) = (&values[..], (&rows[..], channels));
    Energy { unary: &unary, values, rows, edges: &edges }.minimise(labels, &order, check)
}
