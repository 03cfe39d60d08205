//! Jennings (1966), "A compact storage scheme for the solution of symmetric linear simultaneous
//! equations": Cholesky within the envelope, for the systems of one hole.
//!
//! The columns of the factor are stored from the diagonal to their last entry, and every step is
//! the difference of contiguous pieces. A hole is a disc or a strip: numbered from one end to the
//! other its columns are short. Up to some thousand unknowns that beats a general sparse
//! factorisation, whose orderings and index lists cost more than the arithmetic.
//!
//! Sums are written out in a fixed order, so that the bits are the same with any instruction set.

use glam::DVec3;
use pulp::{Arch, Simd, WithSimd};

/// Lanes of a sum: one AVX-512 register, two of AVX.
const LANES: usize = 8;
/// Columns subtracted at once: the one they are subtracted from is loaded and stored once.
const BLOCK: usize = 4;

/// The lower triangle of a symmetric matrix, column by column, the rows of each in any order.
pub struct Lower<'a> {
    /// Column starts and the end.
    pub columns: &'a [u32],
    /// Rows.
    pub rows: &'a [u32],
    /// Values.
    pub values: &'a [f64],
}

impl Lower<'_> {
    fn column(&self, j: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.columns[j] as usize..self.columns[j + 1] as usize;
        range.map(|e| (self.rows[e] as usize, self.values[e]))
    }
}

/// A numbering and the shape of the factor under it.
pub struct Envelope {
    /// New number of each unknown.
    number: Vec<u32>,
    /// Where each column of the factor starts in memory; it runs down from the diagonal.
    start: Vec<usize>,
}

impl Envelope {
    /// Numbers the unknowns along their longest extent. Cuthill and McKee's walk along the edges is
    /// no better on discs, far worse where edges are of uneven length, and costs more.
    pub fn new(matrix: &Lower<'_>, places: &[DVec3]) -> Self {
        let n = places.len();
        let number = sweep(places);
        let mut last: Vec<usize> = (0..n).collect();
        for j in 0..n {
            for (i, _) in matrix.column(j) {
                let (a, b) = (number[i] as usize, number[j] as usize);
                last[a.min(b)] = last[a.min(b)].max(a.max(b));
            }
        }
        // A column reaches as far as those before it.
        let mut start = vec![0; n + 1];
        let mut reach = 0;
        for j in 0..n {
            reach = last[j].max(reach);
            start[j + 1] = start[j] + reach + 1 - j;
        }
        Self { number, start }
    }

    /// Multiplications of the factorisation, about.
    pub fn cost(&self) -> f64 {
        self.start.windows(2).map(|s| 0.5 * ((s[1] - s[0]) as f64).powi(2)).sum()
    }

    /// Factors and solves; `None` if the matrix is not positive definite.
    pub fn solve(&self, matrix: &Lower<'_>, rhs: &[DVec3]) -> Option<Vec<DVec3>> {
        let n = rhs.len();
        let mut factor = vec![0.0; self.start[n]];
        let mut x = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
        for j in 0..n {
            let b = self.number[j] as usize;
            (0..3).for_each(|d| x[d][b] = rhs[j][d]);
            for (i, value) in matrix.column(j) {
                let a = self.number[i] as usize;
                factor[self.start[a.min(b)] + a.abs_diff(b)] = value;
            }
        }
        Arch::new().dispatch(Solve { start: &self.start, factor: &mut factor, x: &mut x })?;
        let at = |j: usize| {
            let i = self.number[j] as usize;
            DVec3::new(x[0][i], x[1][i], x[2][i])
        };
        Some((0..n).map(at).collect())
    }
}

/// Factorisation and substitutions, compiled for the widest registers there are: all they call is
/// inlined.
struct Solve<'a> {
    start: &'a [usize],
    factor: &'a mut [f64],
    x: &'a mut [Vec<f64>; 3],
}

impl WithSimd for Solve<'_> {
    type Output = Option<()>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Option<()> {
        factorise(self.start, self.factor)?;
        substitute(self.start, self.factor, self.x);
        Some(())
    }
}

/// Column by column, each less the earlier ones that reach it.
#[inline(always)]
fn factorise(start: &[usize], factor: &mut [f64]) -> Option<()> {
    let n = start.len() - 1;
    let mut first = 0;
    for j in 0..n {
        let (before, rest) = factor.split_at_mut(start[j]);
        let column = &mut rest[..start[j + 1] - start[j]];
        while first < j && first + (start[first + 1] - start[first]) <= j {
            first += 1;
        }
        // Column k from row j down; later columns reach farther.
        let piece = |k: usize| &before[start[k] + j - k..start[k + 1]];
        let mut k = first;
        while k + BLOCK <= j {
            let [a, b, c, d] = [piece(k), piece(k + 1), piece(k + 2), piece(k + 3)];
            let m = a.len();
            subtract4(&mut column[..m], [a, &b[..m], &c[..m], &d[..m]], [a[0], b[0], c[0], d[0]]);
            for x in [b, c, d] {
                subtract(&mut column[m..x.len()], &x[m..], x[0]);
            }
            k += BLOCK;
        }
        for k in k..j {
            let a = piece(k);
            subtract(&mut column[..a.len()], a, a[0]);
        }
        // NaN fails, too.
        if !(column[0] > 0.0 && column[0].is_finite()) {
            return None;
        }
        let root = column[0].sqrt();
        let scale = 1.0 / root;
        column[0] = root;
        for x in &mut column[1..] {
            *x *= scale;
        }
    }
    Some(())
}

#[inline(always)]
fn subtract(to: &mut [f64], a: &[f64], scale: f64) {
    for (x, a) in to.iter_mut().zip(a) {
        *x -= scale * a;
    }
}

#[inline(always)]
fn subtract4(to: &mut [f64], pieces: [&[f64]; BLOCK], scale: [f64; BLOCK]) {
    let [a, b, c, d] = pieces.map(|p| &p[..to.len()]);
    for i in 0..to.len() {
        to[i] -= (scale[0] * a[i] + scale[1] * b[i]) + (scale[2] * c[i] + scale[3] * d[i]);
    }
}

#[inline(always)]
fn substitute(start: &[usize], factor: &[f64], x: &mut [Vec<f64>; 3]) {
    let n = start.len() - 1;
    // All three for each column, which is near then.
    for j in 0..n {
        let column = &factor[start[j]..start[j + 1]];
        for x in &mut *x {
            let value = x[j] / column[0];
            x[j] = value;
            subtract(&mut x[j + 1..j + column.len()], &column[1..], value);
        }
    }
    for j in (0..n).rev() {
        let column = &factor[start[j]..start[j + 1]];
        for x in &mut *x {
            x[j] = (x[j] - dot(&column[1..], &x[j + 1..j + column.len()])) / column[0];
        }
    }
}

#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; LANES];
    let (a, b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        for l in 0..LANES {
            lanes[l] += a[l] * b[l];
        }
    }
    let [a, b, c, d, e, f, g, h] = lanes;
    (((a + e) + (c + g)) + ((b + f) + (d + h))) + rest
}

/// Numbers along the line through two points that are far apart.
fn sweep(places: &[DVec3]) -> Vec<u32> {
    let far = |from: DVec3| {
        let distance = |i: usize| places[i].distance_squared(from);
        let farther = |a: usize, b: usize| if distance(b) > distance(a) { b } else { a };
        places[(0..places.len()).fold(0, farther)]
    };
    let end = far(places[0]);
    let along = far(end) - end;
    let mut order: Vec<(f64, u32)> = places.iter().map(|p| along.dot(*p)).zip(0..).collect();
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut number = vec![0; places.len()];
    order.iter().zip(0..).for_each(|(o, i)| number[o.1 as usize] = i);
    number
}
