//! Points as rows of numbers, as XYZ and PCD have them: what the new ones hold in each column.

use super::attributes::{self, Blend, Patch};
use crate::points::PointCompletion;

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Column {
    /// x, y or z.
    Position(usize),
    /// The same of the normal.
    Normal(usize),
    /// Something that is copied, or carried over from the rim.
    Carried(Blend),
    /// A channel of a colour of bytes, red first.
    Colour(usize),
}

/// The new points' rows. `known`: the rows of the points of [`Patch::known`].
pub(super) fn new_rows(
    made: &PointCompletion,
    patch: &Patch<'_>,
    columns: &[Column],
    known: &[f64],
) -> Vec<Vec<f64>> {
    let carried: Vec<(usize, attributes::Column)> = columns
        .iter()
        .enumerate()
        .filter_map(|(i, c)| match c {
            Column::Carried(blend) => Some((i, attributes::Column { blend: *blend, colour: None })),
            Column::Colour(channel) => {
                let (blend, colour) = (Blend::Copied, Some((*channel, 255.0)));
                Some((i, attributes::Column { blend, colour }))
            }
            _ => None,
        })
        .collect();
    let width = columns.len().max(1);
    let rows = known.chunks_exact(width);
    let known: Vec<f64> = rows.flat_map(|row| carried.iter().map(|&(i, _)| row[i])).collect();
    let carried: Vec<attributes::Column> = carried.iter().map(|c| c.1).collect();
    let inside = patch.complete(&known, &carried);
    (0..made.completion.vertices.len())
        .map(|v| {
            let mut rest = inside[v * carried.len()..].iter();
            let value = |c: &Column| match *c {
                Column::Position(axis) => made.completion.vertices[v][axis],
                // Adding 0 turns -0 to 0, which reads better in a text.
                Column::Normal(axis) => made.normals[v][axis] + 0.0,
                Column::Carried(_) | Column::Colour(_) => rest.next().copied().unwrap_or(0.0),
            };
            columns.iter().map(value).collect()
        })
        .collect()
}
