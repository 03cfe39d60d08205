//! Points as rows of numbers, as XYZ and PCD have them: what the new ones hold in each column.

use super::attributes::{Blend, Patch};
use crate::points::PointCompletion;

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Column {
    /// x, y or z.
    Position(usize),
    /// The same of the normal.
    Normal(usize),
    /// Something that is carried over from the rim.
    Carried(Blend),
}

/// The new points' rows. `rim`: the rows of the input points that the fill touches, in ascending
/// order of their indices.
pub(super) fn new_rows(made: &PointCompletion, columns: &[Column], rim: &[f64]) -> Vec<Vec<f64>> {
    let carried: Vec<(usize, Blend)> = columns
        .iter()
        .enumerate()
        .filter_map(|(i, c)| match c {
            Column::Carried(blend) => Some((i, *blend)),
            _ => None,
        })
        .collect();
    let width = columns.len().max(1);
    let rows = rim.chunks_exact(width);
    let at_rim: Vec<f64> = rows.flat_map(|row| carried.iter().map(|&(i, _)| row[i])).collect();
    let blends: Vec<Blend> = carried.iter().map(|c| c.1).collect();
    let inside = Patch::new(&made.completion).carry(&at_rim, &blends);
    (0..made.completion.vertices.len())
        .map(|v| {
            let mut rest = inside[v * blends.len()..].iter();
            let value = |c: &Column| match *c {
                Column::Position(axis) => made.completion.vertices[v][axis],
                // Adding 0 turns -0 to 0, which reads better in a text.
                Column::Normal(axis) => made.normals[v][axis] + 0.0,
                Column::Carried(_) => rest.next().copied().unwrap_or(0.0),
            };
            columns.iter().map(value).collect()
        })
        .collect()
}

/// The input points that the fill touches, ascending.
pub(super) fn rim(made: &PointCompletion) -> Vec<u32> {
    Patch::new(&made.completion).rim().to_vec()
}
