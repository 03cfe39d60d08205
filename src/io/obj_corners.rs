//! Texture coordinates and normals of an OBJ fill.
//!
//! A corner of a face names them beside its vertex. Faces that were copied from somewhere take the texture
//! coordinates from there, see [`super::obj_texture`]. The others, if every vertex at their hole's rim has
//! one and the same in all its faces, take what goes on from there as harmonic functions; normals are the
//! fill's own. Where a texture seam or a crease meets the rim there is no one value to go on from, and
//! those corners name the vertex only.

use super::attributes::{Blend, Patch};
use super::obj::{arguments, keyword, statements};
use super::obj_texture::{Sourced, Texture};
use super::text::{parse, push_real};
use super::Mesh;
use crate::result::Completion;
use std::collections::{HashMap, HashSet};
use std::io::Write;

/// `vt` and `vn`: the second and third number of a corner.
const KINDS: [&[u8]; 2] = [b"vt", b"vn"];

/// What one vertex's corners say about one kind.
#[derive(Clone, Copy, PartialEq)]
enum Use {
    Unseen,
    /// This number (from 1) everywhere.
    One(u64),
    /// None, or several.
    Mixed,
}

/// One kind's numbers for the corners of the fill.
struct Kind {
    /// For each vertex of the rim.
    rim: Vec<Use>,
    /// For each new vertex.
    new: Vec<Option<u64>>,
    /// The holes without a value of this kind.
    without: HashSet<u32>,
}

/// The numbers for every corner of the fill.
pub(super) struct Corners<'a> {
    completion: &'a Completion,
    rim: &'a [u32],
    kinds: Vec<Kind>,
    /// The `vt` numbers of the faces that have them from their source.
    copied: Vec<Option<[u64; 3]>>,
    some_copied: bool,
}

impl<'a> Corners<'a> {
    /// Finds what goes on into the fill, and writes its `vt` and `vn` lines.
    pub fn write_values(
        out: &mut Vec<u8>,
        bytes: &[u8],
        mesh: &Mesh,
        completion: &'a Completion,
        patch: &'a Patch<'_>,
        sourced: &Sourced,
        line_end: &[u8],
    ) -> Self {
        let uses = collect_uses(bytes, patch.rim());
        let (rim, copied) = (patch.rim(), vec![None; completion.faces.len()]);
        let mut corners = Self { completion, rim, kinds: Vec::new(), copied, some_copied: false };
        let first_free = corners.write_copied(out, bytes, mesh, sourced, line_end);
        let bare = corners.without_source();
        for (k, rim) in uses.into_iter().enumerate() {
            let mut kind =
                Kind { rim, new: vec![None; completion.vertices.len()], without: HashSet::new() };
            corners.find_holes_without(&mut kind);
            let (values, width, count) = collect_values(bytes, KINDS[k], &kind.rim);
            let is_normal = k == 1;
            if width < if is_normal { 3 } else { 1 } {
                kind.without.extend(&completion.face_hole);
            }
            let wanted = |i: usize| {
                !kind.without.contains(&completion.vertex_hole[i]) && (k == 1 || bare[i])
            };
            if !(0..kind.new.len()).any(wanted) {
                corners.kinds.push(kind);
                continue;
            }
            let carried = if is_normal {
                let rim: Vec<_> = values.chunks_exact(width).map(|r| [r[0], r[1], r[2]]).collect();
                patch.normals(mesh.positions.view(bytes), &rim).concat()
            } else {
                patch.carry(&values, &vec![Blend::Smooth; width])
            };
            let width = if is_normal { 3 } else { width };
            let mut next = if is_normal { count } else { count.max(first_free) };
            for i in (0..completion.vertices.len()).filter(|&i| wanted(i)) {
                next += 1;
                kind.new[i] = Some(next);
                out.extend_from_slice(KINDS[k]);
                for &x in &carried[i * width..(i + 1) * width] {
                    out.push(b' ');
                    push_real(out, x, true);
                }
                out.extend_from_slice(line_end);
            }
            corners.kinds.push(kind);
        }
        corners
    }

    /// Writes the `vt` lines of what is copied; returns the last number.
    fn write_copied(
        &mut self,
        out: &mut Vec<u8>,
        bytes: &[u8],
        mesh: &Mesh,
        sourced: &Sourced,
        line_end: &[u8],
    ) -> u64 {
        let Some(texture) = Texture::read(bytes) else { return 0 };
        let mut last = texture.count() as u64;
        // The same place of the same vertex is written once.
        let mut written = HashMap::new();
        let rows = sourced.texture(&texture, mesh, bytes);
        for (f, rows) in rows.iter().enumerate() {
            let Some(rows) = rows else { continue };
            let mut numbers = [0; 3];
            for k in 0..3 {
                let key = (self.completion.faces[f][k], rows[k].map(f64::to_bits));
                numbers[k] = *written.entry(key).or_insert_with(|| {
                    last += 1;
                    out.extend_from_slice(KINDS[0]);
                    for &x in &rows[k][..texture.width] {
                        out.push(b' ');
                        push_real(out, x, true);
                    }
                    out.extend_from_slice(line_end);
                    last
                });
            }
            self.copied[f] = Some(numbers);
            self.some_copied = true;
        }
        last
    }

    /// Which new vertices have a face whose texture coordinates are not copied.
    fn without_source(&self) -> Vec<bool> {
        let mut bare = vec![false; self.completion.vertices.len()];
        for (face, _) in self.completion.faces.iter().zip(&self.copied).filter(|f| f.1.is_none()) {
            let new = |v: u32| (v as usize).checked_sub(self.completion.input_vertex_count);
            face.iter().filter_map(|&v| new(v)).for_each(|i| bare[i] = true);
        }
        bare
    }

    /// Whether texture coordinates were copied to some faces and not to this one.
    pub fn lacks_source(&self, f: usize) -> bool {
        self.some_copied && self.copied[f].is_none()
    }

    fn find_holes_without(&self, kind: &mut Kind) {
        for (face, &hole) in self.completion.faces.iter().zip(&self.completion.face_hole) {
            let rim = face.iter().filter_map(|v| self.rim.binary_search(v).ok());
            if rim.into_iter().any(|r| !matches!(kind.rim[r], Use::One(_))) {
                kind.without.insert(hole);
            }
        }
    }

    /// Writes corner `k` of new face `f`.
    pub fn write(&self, out: &mut Vec<u8>, f: usize, k: usize) {
        let v = self.completion.faces[f][k];
        let hole = self.completion.face_hole[f];
        let number = |kind: &Kind| {
            if kind.without.contains(&hole) {
                return None;
            }
            match (v as usize).checked_sub(self.completion.input_vertex_count) {
                Some(new) => kind.new[new],
                None => match kind.rim[self.rim.binary_search(&v).ok()?] {
                    Use::One(n) => Some(n),
                    _ => None,
                },
            }
        };
        let [texture, normal] = [0, 1].map(|k| self.kinds.get(k).and_then(number));
        let texture = self.copied[f].map(|t| t[k]).or(texture);
        let vertex = u64::from(v) + 1;
        // Writing to memory does not fail.
        let _ = match (texture, normal) {
            (None, None) => write!(out, " {vertex}"),
            (Some(t), None) => write!(out, " {vertex}/{t}"),
            (None, Some(n)) => write!(out, " {vertex}//{n}"),
            (Some(t), Some(n)) => write!(out, " {vertex}/{t}/{n}"),
        };
    }
}

/// What the input's corners at the rim's vertices say, kind by kind.
fn collect_uses(bytes: &[u8], rim: &[u32]) -> [Vec<Use>; 2] {
    let mut uses = [0, 1].map(|_| vec![Use::Unseen; rim.len()]);
    let mut so_far = [0i64; 3];
    for line in statements(bytes) {
        match keyword(line.text) {
            b"v" => so_far[0] += 1,
            b"vt" => so_far[1] += 1,
            b"vn" => so_far[2] += 1,
            b"f" => {
                for word in arguments(line.text) {
                    let mut parts = word.split(|&c| c == b'/');
                    // Numbers from 1; negative ones count back from the last.
                    let numbers = so_far.map(|n| {
                        let i = parts.next().and_then(parse::<i64>)?;
                        u64::try_from(if i < 0 { n + 1 + i } else { i }).ok().filter(|&i| i > 0)
                    });
                    let vertex = numbers[0].and_then(|n| u32::try_from(n - 1).ok());
                    let Some(r) = vertex.and_then(|v| rim.binary_search(&v).ok()) else { continue };
                    for (kind, number) in uses.iter_mut().zip(&numbers[1..]) {
                        kind[r] = match (kind[r], *number) {
                            (Use::Unseen, Some(n)) => Use::One(n),
                            (Use::One(m), Some(n)) if m == n => Use::One(n),
                            _ => Use::Mixed,
                        };
                    }
                }
            }
            _ => {}
        }
    }
    uses
}

/// The values that the rim names, a row for each of its vertices; how many numbers all of them
/// have; and how many lines of this kind there are.
fn collect_values(bytes: &[u8], kind: &[u8], rim: &[Use]) -> (Vec<f64>, usize, u64) {
    let mut wanted: Vec<(u64, usize)> = rim
        .iter()
        .enumerate()
        .filter_map(|(r, u)| if let Use::One(n) = u { Some((*n, r)) } else { None })
        .collect();
    wanted.sort_unstable();
    let mut rows: Vec<Vec<f64>> = vec![Vec::new(); rim.len()];
    let (mut count, mut at) = (0, 0);
    for line in statements(bytes).filter(|l| keyword(l.text) == kind) {
        count += 1;
        while let Some(&(_, r)) = wanted.get(at).filter(|w| w.0 == count) {
            rows[r] = arguments(line.text).map_while(parse).take(3).collect();
            at += 1;
        }
    }
    // A number beyond the last line names nothing: then nothing can be carried on.
    let width = wanted.iter().map(|w| rows[w.1].len()).min().unwrap_or(0);
    let value = |row: &Vec<f64>, c: usize| row.get(c).copied().unwrap_or(f64::NAN);
    let values = rows.iter().flat_map(|row| (0..width).map(|c| value(row, c)).collect::<Vec<_>>());
    (values.collect(), width, count)
}
