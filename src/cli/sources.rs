//! What a coherent fill may copy from, as said on the command line.

use super::failure::Failure;
use crate::io::Document;
use crate::options::{Exemplar, Sources};
use clap::Args;
use std::path::PathBuf;
use std::sync::Arc;

/// What may be copied from.
#[derive(Debug, Default, Args)]
pub(super) struct SourceArgs {
    /// Copy only from the faces around a point: centre and radius, in mesh units; may be repeated
    #[arg(long, value_name = "X,Y,Z,R", value_parser = parse_ball, allow_hyphen_values = true)]
    pub source_ball: Vec<Ball>,
    /// Copy from no face around a point; may be repeated
    #[arg(long, value_name = "X,Y,Z,R", value_parser = parse_ball, allow_hyphen_values = true)]
    pub avoid_ball: Vec<Ball>,
    /// Another mesh to copy from, in any position and of the same scale: an intact twin; may be repeated
    #[arg(long, value_name = "FILE")]
    pub exemplar: Vec<PathBuf>,
    /// Copy from the exemplar alone
    #[arg(long, requires = "exemplar")]
    pub exemplar_only: bool,
    /// Copy nothing mirrored
    #[arg(long)]
    pub unmirrored: bool,
}

/// A region of the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ball {
    centre: [f64; 3],
    radius: f64,
}

fn parse_ball(text: &str) -> Result<Ball, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|x| x.trim().parse::<f64>()).collect();
    match numbers.as_deref() {
        Ok(&[x, y, z, radius]) if [x, y, z].iter().all(|c| c.is_finite()) && radius > 0.0 => {
            Ok(Ball { centre: [x, y, z], radius })
        }
        _ => Err("expected a centre and a positive radius, four numbers: X,Y,Z,R".into()),
    }
}

impl SourceArgs {
    /// The exemplars' files.
    pub fn exemplars(&self) -> Result<Vec<Document>, Failure> {
        Ok(self.exemplar.iter().map(|path| Document::read(path)).collect::<Result<_, _>>()?)
    }

    /// The library's sources, for a mesh and exemplars that were read.
    pub fn sources(&self, document: &Document, exemplars: &[Document]) -> Sources {
        let whole = |other: &Document| {
            let (vertices, faces) = (other.vertices(), other.faces());
            Exemplar {
                vertices: (0..vertices.len()).map(|v| vertices.get(v)).collect(),
                faces: (0..faces.len()).map(|f| faces.get(f)).collect(),
                parts: Vec::new(),
            }
        };
        let mut exemplars: Vec<Exemplar> = exemplars.iter().map(whole).collect();
        let exemplar = match exemplars.len() {
            0 | 1 => exemplars.pop(),
            _ => Some(Exemplar::joined(&exemplars)),
        };
        Sources {
            faces: self.faces(document),
            exemplar: exemplar.map(Arc::new),
            exemplar_only: self.exemplar_only,
            unmirrored: self.unmirrored,
        }
    }

    fn faces(&self, document: &Document) -> Option<Arc<[bool]>> {
        if self.source_ball.is_empty() && self.avoid_ball.is_empty() {
            return None;
        }
        let (vertices, faces) = (document.vertices(), document.faces());
        let may = |f: usize| {
            let corners = faces.get(f).map(|v| vertices.get(v as usize));
            let middle: [f64; 3] =
                std::array::from_fn(|d| corners.iter().map(|p| p[d]).sum::<f64>() / 3.0);
            let inside = |b: &Ball| {
                let d2: f64 = (0..3).map(|d| (middle[d] - b.centre[d]).powi(2)).sum();
                d2 <= b.radius * b.radius
            };
            (self.source_ball.is_empty() || self.source_ball.iter().any(inside))
                && !self.avoid_ball.iter().any(inside)
        };
        Some((0..faces.len()).map(may).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn balls_are_four_numbers() {
        let ball = Ball { centre: [1.0, -2.5, 3.0], radius: 0.5 };
        assert_eq!(parse_ball("1, -2.5,3,0.5"), Ok(ball));
        for bad in
            ["", "1,2,3", "1,2,3,0", "1,2,3,-1", "1,2,3,4,5", "nan,0,0,1", "0,0,0,nan", "a,0,0,1"]
        {
            assert!(parse_ball(bad).is_err(), "{bad}");
        }
    }
}
