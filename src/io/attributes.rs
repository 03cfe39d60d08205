//! What the fill's elements carry besides their place: colours, normals, flags, whatever the file
//! has.
//!
//! Quantities of the vertices are copied from where the shape was copied from, see
//! [`crate::synthesis::appearance`]. In a fill without a source, and for texture coordinates, they are
//! carried inward from the rim as harmonic functions of the uniform Laplacian: each new vertex has the
//! mean of its neighbours, the rim is fixed. They have no extremum inside, so no colour appears that is
//! not between the rim's. New faces copy what they carry from the
//! nearest input face at the rim.

use super::Document;
use crate::mesh::{FaceView, VertexView};
use crate::result::Completion;
use crate::synthesis::appearance::{complete_rows, Known};
use std::collections::{HashMap, VecDeque};

/// The fill as a graph: its new vertices first, then the input vertices at its rim.
pub(super) struct Patch<'a> {
    completion: &'a Completion,
    /// Input vertices that the fill touches, sorted.
    rim: Vec<u32>,
    /// Neighbours of node i: `neighbours[starts[i]..starts[i + 1]]`, once for each face.
    starts: Vec<u32>,
    neighbours: Vec<u32>,
    /// The rim and the corners of the faces copied from, sorted.
    known: Vec<u32>,
    /// The mesh's faces and the exemplar, to copy from.
    faces: Option<FaceView<'a>>,
    exemplar: Option<&'a Document>,
    /// Nodes by their distance from the rim in edges, the rim left out.
    inward: Vec<Step>,
    /// The greatest distance.
    depth: usize,
}

/// A new vertex and the neighbour through which the rim is nearest.
struct Step {
    node: u32,
    from: u32,
}

/// How a property goes on into the fill.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Blend {
    /// Copied with the shape, harmonic without a source.
    Copied,
    /// Harmonic.
    Smooth,
    /// The value of the nearest vertex of the rim, for labels: between 3 and 7 there is no 5.
    Nearest,
}

impl Blend {
    /// Floats are quantities. Integers are when their name says so; else they are labels.
    pub fn of(name: &str, integer: bool) -> Self {
        const QUANTITIES: [&str; 12] = [
            "red",
            "green",
            "blue",
            "alpha",
            "intensity",
            "quality",
            "confidence",
            "gray",
            "grey",
            "reflectance",
            "luminance",
            "curvature",
        ];
        const TEXTURE: [&str; 8] =
            ["s", "t", "u", "v", "texture_u", "texture_v", "texture_s", "texture_t"];
        let name_end = name.to_ascii_lowercase();
        let quantity = |q: &&str| name_end.ends_with(*q);
        let single = ["r", "g", "b", "a"].contains(&name);
        if integer && !single && !QUANTITIES.iter().any(quantity) {
            Blend::Nearest
        } else if TEXTURE.contains(&&*name_end) {
            // A piece of another place's texture, bent to fit at the rim, would be stretched.
            Blend::Smooth
        } else {
            Blend::Copied
        }
    }
}

impl<'a> Patch<'a> {
    /// The fill of a completion whose indices have been checked.
    pub fn new(completion: &'a Completion) -> Self {
        let input = completion.input_vertex_count as u32;
        let mut rim: Vec<u32> =
            completion.faces.iter().flatten().copied().filter(|&v| v < input).collect();
        rim.sort_unstable();
        rim.dedup();
        let nodes = completion.vertices.len() + rim.len();
        let mut patch = Self {
            completion,
            known: rim.clone(),
            rim,
            faces: None,
            exemplar: None,
            starts: vec![0; nodes + 1],
            neighbours: vec![0; completion.faces.len() * 6],
            inward: Vec::with_capacity(completion.vertices.len()),
            depth: 0,
        };
        patch.link();
        patch.walk_inward();
        patch
    }

    /// The same, to be copied into from the mesh's faces and from an exemplar.
    pub fn with_sources(
        completion: &'a Completion,
        faces: FaceView<'a>,
        exemplar: Option<&'a Document>,
    ) -> Self {
        let mut patch = Self::new(completion);
        let seams = completion.holes.iter().flat_map(|h| h.seams.iter().chain(&h.ring));
        let seams = seams.map(|s| s.face);
        let ring = completion.holes.iter().flat_map(|h| h.ring.iter());
        let origins = completion.colours_from().iter().map(|o| o.face);
        let mut used: Vec<u32> = origins.chain(seams).collect();
        used.sort_unstable();
        used.dedup();
        used.retain(|&f| (f as usize) < faces.len());
        patch.known.extend(used.iter().flat_map(|&f| faces.get(f as usize)));
        patch.known.extend(ring.map(|s| s.vertex));
        patch.known.sort_unstable();
        patch.known.dedup();
        Self { faces: Some(faces), exemplar, ..patch }
    }

    /// Input vertices whose values must be known: the rim and the corners of what is copied; sorted.
    pub fn known(&self) -> &[u32] {
        &self.known
    }

    /// The rows of the rim, of those of [`Patch::known`].
    pub fn rim_of<'b, T>(&'b self, rows: &'b [T], width: usize) -> impl Iterator<Item = &'b [T]> {
        let at = move |v: &u32| self.known.binary_search(v).unwrap_or(0) * width;
        self.rim.iter().map(move |v| &rows[at(v)..at(v) + width])
    }

    /// Columns of numbers for the new vertices, from a row of each vertex of [`Patch::known`].
    pub fn complete(&self, rows: &[f64], columns: &[Column]) -> Vec<f64> {
        let blends: Vec<Blend> = columns.iter().map(|c| c.blend).collect();
        let width = columns.len();
        let rim: Vec<f64> = self.rim_of(rows, width).flatten().copied().collect();
        let mut values = self.carry(&rim, &blends);
        let mut copied_from = vec![false; self.completion.holes.len()];
        let origins = self.completion.colours_from().iter();
        for (origin, &hole) in origins.zip(&self.completion.vertex_hole) {
            if !origin.is_nowhere() && (hole as usize) < copied_from.len() {
                copied_from[hole as usize] = true;
            }
        }
        if !copied_from.contains(&true) {
            return values;
        }
        let colours = self.exemplar.and_then(Document::vertex_colours);
        // Of the exemplar colours alone are known, so that the other columns are another system.
        for of_colour in [true, false] {
            let is_of = |c: &Column| (c.colour.is_some() && colours.is_some()) == of_colour;
            let of_kind = |&c: &usize| blends[c] == Blend::Copied && is_of(&columns[c]);
            let chosen: Vec<usize> = (0..width).filter(of_kind).collect();
            if chosen.is_empty() {
                continue;
            }
            let known = KnownRows::new(self, rows, columns, &chosen, colours.as_deref());
            let Some(made) = complete_rows(self.completion, &known) else { continue };
            for (i, row) in made.chunks_exact(chosen.len()).enumerate() {
                if copied_from[self.completion.vertex_hole[i] as usize] {
                    chosen.iter().zip(row).for_each(|(c, x)| values[i * width + c] = *x);
                }
            }
        }
        values
    }

    /// What was completed.
    pub fn completion(&self) -> &'a Completion {
        self.completion
    }

    /// Input vertices that the fill touches, sorted.
    pub fn rim(&self) -> &[u32] {
        &self.rim
    }

    fn node(&self, v: u32) -> usize {
        let input = self.completion.input_vertex_count as u32;
        match v.checked_sub(input) {
            Some(new) => new as usize,
            None => self.completion.vertices.len() + self.rim.binary_search(&v).unwrap_or(0),
        }
    }

    /// An inner edge has two faces, so each neighbour of a new vertex comes up twice: all weights
    /// are equal without looking for doubles.
    fn link(&mut self) {
        let nodes: Vec<[usize; 3]> =
            self.completion.faces.iter().map(|f| f.map(|v| self.node(v))).collect();
        for &i in nodes.iter().flatten() {
            self.starts[i + 1] += 2;
        }
        for i in 1..self.starts.len() {
            self.starts[i] += self.starts[i - 1];
        }
        let mut free = self.starts.clone();
        for corners in nodes {
            for k in 0..3 {
                for other in [corners[(k + 1) % 3], corners[(k + 2) % 3]] {
                    self.neighbours[free[corners[k]] as usize] = other as u32;
                    free[corners[k]] += 1;
                }
            }
        }
    }

    fn around(&self, node: u32) -> &[u32] {
        let [a, b] = [0, 1].map(|k| self.starts[node as usize + k] as usize);
        &self.neighbours[a..b]
    }

    /// Breadth first from the whole rim; ties go to the lower index.
    fn walk_inward(&mut self) {
        let new = self.completion.vertices.len() as u32;
        let mut distance = vec![usize::MAX; self.starts.len() - 1];
        let mut queue: VecDeque<u32> = (new..distance.len() as u32).collect();
        distance[new as usize..].fill(0);
        while let Some(from) = queue.pop_front() {
            let next = distance[from as usize] + 1;
            for k in self.starts[from as usize]..self.starts[from as usize + 1] {
                let node = self.neighbours[k as usize];
                if distance[node as usize] == usize::MAX {
                    distance[node as usize] = next;
                    self.inward.push(Step { node, from });
                    self.depth = next;
                    queue.push_back(node);
                }
            }
        }
    }

    /// Carries columns of numbers inward. `rim_values` holds one row of `blends.len()` numbers for
    /// each vertex of [`Patch::rim`]; the result one for each new vertex.
    pub fn carry(&self, rim_values: &[f64], blends: &[Blend]) -> Vec<f64> {
        let (new, columns) = (self.completion.vertices.len(), blends.len());
        let mut values = vec![0.0; new * columns];
        values.extend_from_slice(rim_values);
        let ranges: Vec<f64> =
            (0..columns).map(|c| mend_column(&mut values[new * columns..], c, columns)).collect();
        for step in &self.inward {
            let from = step.from as usize * columns;
            values.copy_within(from..from + columns, step.node as usize * columns);
        }
        let smooth: Vec<usize> =
            (0..columns).filter(|&c| blends[c] != Blend::Nearest && ranges[c] > 0.0).collect();
        if !smooth.is_empty() {
            self.relax(&mut values, columns, &smooth, &ranges);
        }
        values.truncate(new * columns);
        values
    }

    /// Gauss-Seidel sweeps with over-relaxation (Young 1954).
    fn relax(&self, values: &mut [f64], columns: usize, smooth: &[usize], ranges: &[f64]) {
        // Jacobi's spectral radius on a strip as wide as the fill is deep; a rounder fill has a
        // smaller one, and too much over-relaxation still converges.
        let half_wave = std::f64::consts::PI / (2.0 * (self.depth + 1) as f64);
        let omega = 2.0 / (1.0 + half_wave.sin());
        // Measured on square holes 20 and 75 edges deep: 117 and 428 sweeps until a step is 1e-7 of
        // the rim's range; the error is then half of that. So the limit is never met in practice.
        for _ in 0..100 + 20 * self.depth {
            let mut largest = 0.0f64;
            for step in &self.inward {
                let around = self.around(step.node);
                for &c in smooth {
                    let sum: f64 = around.iter().map(|&n| values[n as usize * columns + c]).sum();
                    let value = &mut values[step.node as usize * columns + c];
                    let change = omega * (sum / around.len() as f64 - *value);
                    *value += change;
                    largest = largest.max(change.abs() / ranges[c]);
                }
            }
            if largest <= 1e-7 {
                break;
            }
        }
    }

    /// Unit normals of the new vertices: the new faces', weighted by their angle there (Thürmer
    /// and Wüthrich 1998). They are turned to the side on which the file's own normals of the rim
    /// (`rim_normals`, one a vertex of [`Patch::rim`]) lie.
    pub fn normals(&self, vertices: VertexView<'_>, rim_normals: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let (new, input) = (self.completion.vertices.len(), self.completion.input_vertex_count);
        let mut sums = vec![[0.0; 3]; self.starts.len() - 1];
        for face in &self.completion.faces {
            let p = face.map(|v| match (v as usize).checked_sub(input) {
                Some(i) => self.completion.vertices[i],
                None => vertices.get(v as usize),
            });
            let n = unit(cross(sub(p[1], p[0]), sub(p[2], p[0])));
            for k in 0..3 {
                let (a, b) = (unit(sub(p[(k + 1) % 3], p[k])), unit(sub(p[(k + 2) % 3], p[k])));
                let angle = dot(a, b).clamp(-1.0, 1.0).acos();
                let sum = &mut sums[self.node(face[k])];
                *sum = [0, 1, 2].map(|i| sum[i] + angle * n[i]);
            }
        }
        let agreement: f64 =
            sums[new..].iter().zip(rim_normals).map(|(a, b)| dot(unit(*a), *b)).sum();
        // Adding 0 turns -0 to 0, which reads better in a text.
        let side = if agreement < 0.0 { -1.0 } else { 1.0 };
        sums.truncate(new);
        sums.iter().map(|&s| unit(s).map(|x| x * side + 0.0)).collect()
    }

    /// For each new face the input face that it takes after: the one at the rim that is the fewest
    /// faces away. `None` where the rim has no input face.
    pub fn templates(&self, input_faces: FaceView<'_>) -> Vec<Option<u32>> {
        let faces = &self.completion.faces;
        let edges = |f: [u32; 3]| [[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]];
        let mut owner = HashMap::with_capacity(3 * faces.len());
        for (i, &f) in faces.iter().enumerate() {
            owner.extend(edges(f).map(|e| (e, i)));
        }
        let mut on_rim = vec![false; self.completion.input_vertex_count];
        self.rim.iter().for_each(|&v| on_rim[v as usize] = true);
        let mut found = vec![None; faces.len()];
        let mut queue = VecDeque::new();
        for t in 0..input_faces.len() {
            let face = input_faces.get(t);
            if face.iter().filter(|&&v| on_rim[v as usize]).count() < 2 {
                continue;
            }
            for [a, b] in edges(face) {
                if let Some(&i) = owner.get(&[b, a]).filter(|&&i| found[i].is_none()) {
                    found[i] = Some(t as u32);
                    queue.push_back(i);
                }
            }
        }
        while let Some(i) = queue.pop_front() {
            for [a, b] in edges(faces[i]) {
                if let Some(&j) = owner.get(&[b, a]).filter(|&&j| found[j].is_none()) {
                    found[j] = found[i];
                    queue.push_back(j);
                }
            }
        }
        found
    }
}

/// A column of numbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Column {
    /// How it goes on.
    pub blend: Blend,
    /// Which channel of a colour it is, red first, and what stands for 255.
    pub colour: Option<(usize, f64)>,
}

/// The rows of some columns, for the copy.
struct KnownRows<'a> {
    patch: &'a Patch<'a>,
    width: usize,
    rows: Vec<f64>,
    /// Of the exemplar, by its vertices.
    others: Vec<f64>,
    ranges: Vec<[f64; 2]>,
    /// Whether a column is a colour's, but not its first.
    of_colour: Vec<bool>,
}

impl<'a> KnownRows<'a> {
    fn new(
        patch: &'a Patch<'a>,
        rows: &[f64],
        columns: &[Column],
        chosen: &[usize],
        colours: Option<&[[u8; 4]]>,
    ) -> Self {
        let width = chosen.len();
        let pick = |row: &[f64]| chosen.iter().map(|&c| row[c]).collect::<Vec<f64>>();
        let mut rows: Vec<f64> = rows.chunks_exact(columns.len()).flat_map(pick).collect();
        for c in 0..width {
            mend_column(&mut rows, c, width);
        }
        let has_colours = chosen.iter().all(|&c| columns[c].colour.is_some());
        let others: Vec<f64> = (colours.filter(|_| has_colours).into_iter().flatten())
            .flat_map(|of| {
                let channel = |c: &usize| columns[*c].colour.map(|(k, full)| (of[k], full));
                chosen.iter().filter_map(channel).map(|(x, full)| f64::from(x) * full / 255.0)
            })
            .collect();
        let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; width];
        for (i, &x) in rows.iter().chain(&others).enumerate() {
            let range = &mut ranges[i % width];
            *range = [range[0].min(x), range[1].max(x)];
        }
        let is_colour = |c: usize| columns[chosen[c]].colour.is_some();
        let of_colour = (0..width).map(|c| c > 0 && is_colour(c) && is_colour(c - 1)).collect();
        Self { patch, width, rows, others, ranges, of_colour }
    }

    fn row(&self, v: u32) -> Option<&[f64]> {
        let at = self.patch.known.binary_search(&v).ok()? * self.width;
        self.rows.get(at..at + self.width)
    }
}

impl Known for KnownRows<'_> {
    fn channels(&self) -> usize {
        self.width
    }

    fn goes_with_last(&self, channel: usize) -> bool {
        self.of_colour[channel]
    }

    fn vertex(&self, vertex: u32) -> &[f64] {
        self.row(vertex).unwrap_or_default()
    }

    fn corners(&self, face: u32) -> Option<[&[f64]; 3]> {
        let faces = self.patch.faces?;
        let face = face as usize;
        if face < faces.len() {
            let [a, b, c] = faces.get(face).map(|v| self.row(v));
            return Some([a?, b?, c?]);
        }
        let exemplar = self.patch.exemplar?.faces();
        let face = Some(face - faces.len()).filter(|&f| f < exemplar.len())?;
        let row = |v: u32| self.others.get(v as usize * self.width..)?.get(..self.width);
        let [a, b, c] = exemplar.get(face).map(row);
        Some([a?, b?, c?])
    }

    fn range(&self, channel: usize) -> [f64; 2] {
        self.ranges[channel]
    }
}

/// Replaces what is not finite in a column by the mean of what is, and returns the column's range.
fn mend_column(values: &mut [f64], column: usize, columns: usize) -> f64 {
    let finite = values.iter().skip(column).step_by(columns).filter(|x| x.is_finite());
    let (mut low, mut high, mut sum, mut n) = (f64::INFINITY, f64::NEG_INFINITY, 0.0, 0.0);
    for &x in finite {
        (low, high, sum, n) = (low.min(x), high.max(x), sum + x, n + 1.0);
    }
    let mean = if n > 0.0 { sum / n } else { 0.0 };
    for x in values.iter_mut().skip(column).step_by(columns).filter(|x| !x.is_finite()) {
        *x = mean;
    }
    (high - low).max(0.0)
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The direction of a vector; zero stays zero.
pub(super) fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = dot(a, a).sqrt();
    if length > 0.0 {
        a.map(|x| x / length)
    } else {
        a
    }
}

/// The unit normal of a triangle; zero if it has no area.
pub(super) fn face_normal(p: [[f64; 3]; 3]) -> [f64; 3] {
    unit(cross(sub(p[1], p[0]), sub(p[2], p[0])))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square hole of n by n cells, filled with a grid. The rim is the input.
    fn grid(n: u32) -> (Completion, Vec<[f64; 2]>, Vec<[f64; 2]>) {
        let on_rim = |x: u32, y: u32| x == 0 || y == 0 || x == n || y == n;
        let points = || (0..=n).flat_map(|y| (0..=n).map(move |x| (x, y)));
        let (rim, new): (Vec<_>, Vec<_>) = points().partition(|&(x, y)| on_rim(x, y));
        let number: HashMap<_, _> =
            rim.iter().chain(&new).zip(0u32..).map(|(&p, i)| (p, i)).collect();
        let v = |x, y| number[&(x, y)];
        let faces = (0..n).flat_map(|y| (0..n).map(move |x| (x, y))).flat_map(|(x, y)| {
            let (a, b, c, d) = (v(x, y), v(x + 1, y), v(x + 1, y + 1), v(x, y + 1));
            [[a, b, c], [a, c, d]]
        });
        let faces: Vec<_> = faces.collect();
        let place = |p: &[(u32, u32)]| -> Vec<[f64; 2]> {
            p.iter().map(|&(x, y)| [x.into(), y.into()]).collect()
        };
        let completion = Completion {
            input_vertex_count: rim.len(),
            input_face_count: 0,
            vertices: place(&new).iter().map(|p| [p[0], p[1], 0.0]).collect(),
            vertex_hole: vec![0; new.len()],
            origins: vec![crate::Origin::NOWHERE; new.len()],
            colour_origins: Vec::new(),
            loose: Default::default(),
            face_hole: vec![0; faces.len()],
            faces,
            holes: Vec::new(),
            seconds: 0.0,
            cpu_seconds: 0.0,
        };
        (completion, place(&rim), place(&new))
    }

    #[test]
    fn linear_values_go_on_linearly() {
        // Linear functions are harmonic for any weights that are symmetric around a vertex, so
        // the exact answer is known; labels are those of some vertex of the rim.
        for n in [2, 5, 40, 150] {
            let (completion, rim, new) = grid(n);
            let patch = Patch::new(&completion);
            let linear = |p: &[f64; 2]| 3.0 * p[0] - 2.0 * p[1] + 7.0;
            let label = |p: &[f64; 2]| if p[0] > p[1] { 11.0 } else { 4.0 };
            let values: Vec<f64> = rim.iter().flat_map(|p| [linear(p), label(p), 5.0]).collect();
            let blends = [Blend::Smooth, Blend::Nearest, Blend::Smooth];
            let carried = patch.carry(&values, &blends);
            for (row, p) in carried.chunks(3).zip(&new) {
                assert!(
                    (row[0] - linear(p)).abs() < 1e-6 * f64::from(5 * n),
                    "{n}: {row:?} at {p:?}"
                );
                assert!(row[1] == 11.0 || row[1] == 4.0);
                assert_eq!(row[2], 5.0);
            }
            // Deep inside the triangle of one label there is no other.
            let at = new.iter().position(|p| *p == [f64::from(n) - 1.0, 1.0]).unwrap();
            assert_eq!(carried[3 * at + 1], if n > 2 { 11.0 } else { carried[3 * at + 1] });
        }
    }

    #[test]
    fn no_value_leaves_the_range_of_the_rim() {
        // One white vertex on a black rim: darker inward, never below black.
        let (completion, rim, _) = grid(12);
        let mut values = vec![0.0; rim.len()];
        values[6] = 255.0;
        let carried = Patch::new(&completion).carry(&values, &[Blend::Smooth]);
        assert!(carried.iter().all(|&x| (-1e-3..255.0).contains(&x)));
        assert!(carried[5] > 20.0 && carried[carried.len() - 1] < 1.0, "{carried:?}");
    }

    #[test]
    fn missing_values_do_not_spread() {
        let (completion, rim, _) = grid(6);
        let mut values = vec![2.0; rim.len()];
        values[3] = f64::NAN;
        values[9] = f64::INFINITY;
        let carried = Patch::new(&completion).carry(&values, &[Blend::Smooth]);
        assert!(carried.iter().all(|&x| x == 2.0));
    }

    #[test]
    fn integers_are_labels_unless_their_name_says_more() {
        assert_eq!(Blend::of("red", true), Blend::Copied);
        assert_eq!(Blend::of("diffuse_Blue", true), Blend::Copied);
        assert_eq!(Blend::of("scalar_intensity", true), Blend::Copied);
        assert_eq!(Blend::of("segment", true), Blend::Nearest);
        assert_eq!(Blend::of("segment", false), Blend::Copied);
    }
}
