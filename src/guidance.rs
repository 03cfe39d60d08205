//! What a person says of a fill beyond [`crate::Sources`]: a transform given by hand, one of several
//! candidates, a range of scales.

use crate::error::{Error, Result};
use crate::matching::rigid::Rigid;
use crate::matching::similarity::scale_of;
use crate::matching::stretch::MOST;
use crate::options::Method;
use std::sync::Arc;

/// Scales beyond these are taken for a mistake: a copy a thousandth as large has no detail left.
const SCALES: [f64; 2] = [1e-3, 1e3];

/// Guidance by hand; by default there is none. Only [`Method::Coherent`] can be guided, and [`Method::Warp`] but
/// for the scales; [`Method::Smooth`] takes the points, too.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Guidance {
    /// The one place to copy from; `None`: places are searched for.
    pub placement: Option<Placement>,
    /// Which of the places found a fill is made from, counted from 1, the best first, for each hole; 0:
    /// all of them together. A hole that has fewer gets a smooth fill, and
    /// [`crate::HoleReport::candidates`] says how many there are.
    pub candidate: usize,
    /// Least and greatest factor by which sources may be scaled, 0.001 to 1000; `None`: they are not.
    /// The time of a search grows with the logarithm of their ratio: 10 % a step.
    pub scales: Option<[f64; 2]>,
    /// Points that fills pass through, in mesh units: scan points that float inside a hole. Each belongs to
    /// the nearest hole that is filled; one farther from its middle than its diameter is refused. They move
    /// the fill, smooth or coherent, by a thin plate that ends at the rim.
    pub points: Arc<[[f64; 3]]>,
    /// Fill each hole with a part taken whole, with the source's own triangles: a missing hand, foot or spout,
    /// which no smooth surface comes near to. The part is what lies over the hole, at the placement or at the
    /// first of the places found that has one. Give both ends of a missing band as one hole.
    pub part: bool,
    /// Vertices of rims where the fill need only be joined: neither tangents nor relief nor colours go on from what
    /// lies beyond them, which says nothing of the fill. For an edge that was sharp, or a part of another
    /// material.
    pub loose: Arc<[u32]>,
    /// How far the fill may stay off the points, 0 (it passes through them) to 1: 0.1 halves the height
    /// of a bump over the whole hole.
    pub softness: f64,
}

/// Where a copy lies, given by hand: then it is the only one, in every hole that is filled. With an
/// exemplar it is the exemplar that is placed, else the mesh itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// From the source to the hole: a similarity, mirrored or not, as [`crate::SourceReport::transform`].
    /// Strains of up to 15 %, which those may have, are taken, too.
    pub transform: Rigid,
    /// Whether it is improved by ICP on what is known around the hole, from as far as half a hole's
    /// radius; with its scale, unless that is 1.
    pub refined: bool,
}

impl Guidance {
    /// Whether a fill is made from one copy alone.
    pub(crate) fn is_single(&self) -> bool {
        self.placement.is_some() || self.candidate > 0
    }

    /// Checks every range.
    pub(crate) fn check(&self, method: Method) -> Result<()> {
        let bad = |name, reason: String| Err(Error::InvalidOption { name, reason });
        let Self { placement, candidate, scales, points, part, loose, softness } = self;
        let given = [
            ("placement", placement.is_some()),
            ("candidate", *candidate > 0),
            ("scales", scales.is_some()),
            ("part", *part),
        ];
        let heeds = |name: &str| match method {
            Method::Coherent => true,
            Method::Warp => name != "scales" && name != "part",
            _ => false,
        };
        if let Some((name, _)) = given.iter().find(|g| g.1 && !heeds(g.0)) {
            return bad(name, format!("the method {} cannot be guided", method.name()));
        }
        if !loose.is_empty() && (*part || matches!(method, Method::Harary | Method::Fragment)) {
            let by = if *part { "a part".into() } else { format!("the method {}", method.name()) };
            return bad("loose", format!("{by} heeds none"));
        }
        if *part && !points.is_empty() {
            return bad("points", "a part is taken as it is".into());
        }
        if !points.is_empty() && matches!(method, Method::Harary | Method::Fragment) {
            return bad("points", format!("the method {} takes none", method.name()));
        }
        if let Some(i) = points.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            return bad("points", format!("point {i} has a coordinate that is not finite"));
        }
        if !(0.0..=1.0).contains(softness) {
            return bad("softness", format!("{softness} is outside 0 to 1"));
        }
        if let (Some(_), Some((name, _))) = (placement, given[1..3].iter().find(|g| g.1)) {
            return bad(name, "a placement is the only copy and has its own scale".into());
        }
        if let Some([least, most]) = *scales {
            if !(SCALES[0] <= least && least <= most && most <= SCALES[1]) {
                let [a, b] = SCALES;
                return bad("scales", format!("{least} to {most} is no range within {a} to {b}"));
            }
        }
        placement.as_ref().map_or(Ok(()), Placement::check)
    }
}

impl Placement {
    fn check(&self) -> Result<()> {
        let bad = |reason: String| Err(Error::InvalidOption { name: "placement", reason });
        let Rigid { linear, translation } = self.transform;
        if !linear.is_finite() || !translation.is_finite() {
            return bad("a number of the transform is not finite".into());
        }
        let scale = scale_of(&self.transform);
        if !(SCALES[0]..=SCALES[1]).contains(&scale) {
            let [a, b] = SCALES;
            return bad(format!("the transform scales by {scale:.3e}: {a} to {b} is allowed"));
        }
        let strain = (linear.transpose() * linear * scale.powi(-2) - glam::DMat3::IDENTITY)
            .to_cols_array()
            .into_iter()
            .fold(0.0, |most: f64, g| most.max(0.5 * g.abs()));
        if strain > MOST {
            return bad(format!(
                "the transform is no similarity: it stretches or shears by {:.0} %, {:.0} % is allowed",
                100.0 * strain,
                100.0 * MOST
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat3, DVec3};

    fn checked(linear: DMat3) -> Result<()> {
        let transform = Rigid { linear, translation: DVec3::X };
        let placement = Some(Placement { transform, refined: false });
        Guidance { placement, ..Guidance::default() }.check(Method::Coherent)
    }

    #[test]
    fn similarities_pass_and_nothing_else_does() {
        let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 2.0) / 3.0, 2.0);
        let mirror = DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0));
        for good in [turn, 0.01 * turn * mirror, 300.0 * turn] {
            assert_eq!(checked(good), Ok(()));
        }
        // As much as fits may stretch.
        assert_eq!(checked(turn * DMat3::from_diagonal(DVec3::new(1.1, 1.0, 1.0))), Ok(()));
        for (bad, word) in [
            (turn * DMat3::from_diagonal(DVec3::new(1.5, 1.0, 1.0)), "similarity"),
            (DMat3::from_cols(DVec3::X, DVec3::Y + DVec3::X, DVec3::Z), "similarity"),
            (DMat3::ZERO, "scales by"),
            (DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0)), "scales by"),
            (1e4 * turn, "scales by"),
            (f64::NAN * turn, "finite"),
        ] {
            let said = checked(bad).unwrap_err().to_string();
            assert!(said.contains(word) && said.contains("placement"), "{said}");
        }
    }

    #[test]
    fn contradictions_are_named() {
        let placement = Some(Placement { transform: Rigid::IDENTITY, refined: true });
        let refused = |guidance: Guidance, method, option: &str| match guidance.check(method) {
            Err(Error::InvalidOption { name, .. }) => assert_eq!(name, option),
            other => panic!("{other:?}"),
        };
        let coherent = Method::Coherent;
        let none = Guidance::default;
        refused(Guidance { placement, candidate: 1, ..none() }, coherent, "candidate");
        refused(Guidance { placement, scales: Some([1.0, 2.0]), ..none() }, coherent, "scales");
        for scales in [[2.0, 1.0], [0.0, 1.0], [1.0, 2000.0], [f64::NAN, 1.0]] {
            refused(Guidance { scales: Some(scales), ..none() }, coherent, "scales");
        }
        refused(Guidance { candidate: 2, ..none() }, Method::Smooth, "candidate");
        let points: Arc<[[f64; 3]]> = Arc::new([[0.0; 3]]);
        for method in [Method::Harary, Method::Fragment] {
            refused(Guidance { points: points.clone(), ..none() }, method, "points");
        }
        assert_eq!(none().check(Method::Smooth), Ok(()));
    }
}
