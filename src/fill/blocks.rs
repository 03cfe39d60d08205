//! Schwarz (1870), multiplicative: a large system solved block by block, the rest standing still, so
//! that no factor is ever larger than that of one block.
//!
//! Each block's solution is the least energy with what is around it as it is now, so the energy
//! never rises. What is wrong over lengths shorter than a block is right after two rounds; what is
//! wrong over longer ones stays, so the start has to be near: the solution on a fill of twice the
//! edge length.

use super::sheet::{Laplacian, Sheet};
use super::solve::System;
use glam::DVec3;

/// Vertices of a block without its overlap, at most: smaller ones are put together more often for
/// their overlap than they save in their factor.
const CORE: usize = 500;
/// Rounds over all blocks, forwards and backwards: the rings by which they overlap. In edges of the
/// fill that the start comes from they are half as wide.
const OVERLAPS: [usize; 2] = [4, 2];

/// Makes the system of some free vertices (their numbers, then the vertices), all others fixed where
/// the sheet has them.
pub type Assemble<'a> = &'a dyn Fn(&Sheet, &[u32], &[usize]) -> System;

/// Improves the positions of the sheet's new vertices; `None` if a system is not positive definite.
pub fn solve_by_blocks(sheet: &mut Sheet, l: &Laplacian, assemble: Assemble<'_>) -> Option<()> {
    let mut new: Vec<u32> = (sheet.rim_count as u32..sheet.patch_count as u32).collect();
    let mut cores = Vec::new();
    bisect(&sheet.positions, &mut new, &mut cores);
    let mut number = vec![u32::MAX; sheet.positions.len()];
    for rings in OVERLAPS {
        for core in &cores {
            let free = grow(sheet, l, core, rings, &mut number);
            let solution = assemble(sheet, &number, &free).solve()?;
            for (&v, p) in free.iter().zip(solution) {
                sheet.positions[v] = p;
                number[v] = u32::MAX;
            }
        }
        cores.reverse();
    }
    Some(())
}

/// Halves across the longest extent until each part is small enough.
fn bisect(positions: &[DVec3], vertices: &mut [u32], parts: &mut Vec<Vec<u32>>) {
    if vertices.len() <= CORE {
        parts.push(vertices.to_vec());
        return;
    }
    let place = |v: u32| positions[v as usize];
    let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    vertices.iter().for_each(|&v| (min, max) = (min.min(place(v)), max.max(place(v))));
    let extent = max - min;
    let axis = (0..3).fold(0, |a, b| if extent[b] > extent[a] { b } else { a });
    let middle = vertices.len() / 2;
    let key = |a: &u32, b: &u32| place(*a)[axis].total_cmp(&place(*b)[axis]).then(a.cmp(b));
    vertices.select_nth_unstable_by(middle, key);
    let (left, right) = vertices.split_at_mut(middle);
    bisect(positions, left, parts);
    bisect(positions, right, parts);
}

/// A core and the new vertices within some rings, numbered.
fn grow(
    sheet: &Sheet,
    l: &Laplacian,
    core: &[u32],
    rings: usize,
    number: &mut [u32],
) -> Vec<usize> {
    let mut free: Vec<usize> = core.iter().map(|&v| v as usize).collect();
    free.iter().zip(0..).for_each(|(&v, i)| number[v] = i);
    let mut begin = 0;
    for _ in 0..rings {
        let end = free.len();
        for i in begin..end {
            for (w, _) in l.row(free[i]) {
                if sheet.is_new(w) && number[w] == u32::MAX {
                    number[w] = free.len() as u32;
                    free.push(w);
                }
            }
        }
        begin = end;
    }
    free
}
