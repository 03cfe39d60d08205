//! The principal axes of a surface: directions that move with it, so that what is thinned into cells or
//! turned into bins by them moves with it, too.

use crate::error::Result;
use crate::progress::Pace;
use glam::{DMat3, DVec3};
use nalgebra::{Matrix3, SymmetricEigen};

/// Elementary steps that a pass takes for a face.
const FACE: usize = 8;

/// Three right-handed unit axes as columns, that of the greatest spread of the area first; the first two
/// point to where the surface reaches farther. Any three where there is no area or too much of it.
/// Linear; asks `check` now and then whether to go on.
pub fn principal_axes(
    positions: &[DVec3],
    faces: &[[u32; 3]],
    check: &dyn Fn() -> Result<()>,
) -> Result<DMat3> {
    let mut pace = Pace::new(check);
    let mut each = |sum: &mut dyn FnMut(f64, DVec3)| -> Result<()> {
        for face in faces {
            pace.work(FACE)?;
            let [a, b, c] = face.map(|v| positions[v as usize]);
            sum(0.5 * (b - a).cross(c - a).length(), (a + b + c) / 3.0);
        }
        Ok(())
    };
    let (mut area, mut sum) = (0.0, DVec3::ZERO);
    each(&mut |w, p| (area, sum) = (area + w, sum + w * p))?;
    let mean = sum / area;
    let mut spread = DMat3::ZERO;
    each(&mut |w, p| {
        let d = p - mean;
        spread += w * DMat3::from_cols(d.x * d, d.y * d, d.z * d);
    })?;
    if !spread.is_finite() {
        return Ok(DMat3::IDENTITY);
    }
    let eigen = SymmetricEigen::new(Matrix3::from_column_slice(&spread.to_cols_array()));
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let mut two = [order[0], order[1]].map(|k| {
        let column = eigen.eigenvectors.column(k);
        DVec3::new(column[0], column[1], column[2]).normalize_or_zero()
    });
    // The third moments say which end is which.
    let mut skew = [0.0; 2];
    each(&mut |w, p| (0..2).for_each(|k| skew[k] += w * (p - mean).dot(two[k]).powi(3)))?;
    for (axis, skew) in two.iter_mut().zip(skew) {
        if skew < 0.0 {
            *axis = -*axis;
        }
    }
    let [x, y] = two;
    let axes = DMat3::from_cols(x, y, x.cross(y));
    Ok(match (axes.determinant() - 1.0).abs() < 1e-6 {
        true => axes,
        false => DMat3::IDENTITY,
    })
}

#[cfg(test)]
mod tests {
    use super::super::source::tests::{hilly_source, some_transform};
    use super::*;

    fn principal_axes(positions: &[DVec3], faces: &[[u32; 3]]) -> DMat3 {
        super::principal_axes(positions, faces, &|| Ok(())).unwrap()
    }

    #[test]
    fn axes_move_with_the_surface() {
        let source = hilly_source(30);
        let axes = principal_axes(&source.positions, &source.faces);
        assert!((axes.transpose() * axes).abs_diff_eq(DMat3::IDENTITY, 1e-12));
        let t = some_transform(false);
        let moved: Vec<DVec3> = source.positions.iter().map(|&p| t.point(p)).collect();
        let turned = principal_axes(&moved, &source.faces);
        assert!(turned.abs_diff_eq(t.linear * axes, 1e-9), "{turned} {}", t.linear * axes);
        assert!(!axes.abs_diff_eq(DMat3::IDENTITY, 0.1));
    }

    /// A flat wedge of many strips: its length first, towards its tip; then its width.
    #[test]
    fn the_longest_axis_is_the_first() {
        let corner = |k: u32| {
            let (x, side) = (f64::from(k / 2), f64::from(k % 2) - 0.5);
            DVec3::new(side * (3.0 - 0.1 * x), x, 0.0)
        };
        let p: Vec<DVec3> = (0..60).map(corner).collect();
        let strip = |k: u32| [[k, k + 1, k + 2], [k + 1, k + 3, k + 2]];
        let faces: Vec<[u32; 3]> = (0..58).step_by(2).flat_map(strip).collect();
        let axes = principal_axes(&p, &faces);
        assert!(axes.x_axis.y > 0.99 && axes.y_axis.x.abs() > 0.99, "{axes}");
    }

    #[test]
    fn without_area_there_are_any_axes() {
        assert_eq!(principal_axes(&[DVec3::ONE; 3], &[[0, 1, 2]]), DMat3::IDENTITY);
        assert_eq!(principal_axes(&[], &[]), DMat3::IDENTITY);
    }
}
