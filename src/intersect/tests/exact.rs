//! A second, independent answer: the common part of two triangles with integer corners, by exact
//! clipping. One triangle is cut, as a polygon in homogeneous integer coordinates, by the
//! half-spaces whose intersection is the other one.

/// A corner on the integer grid.
pub type Corner = [i64; 3];
/// A triangle on the integer grid.
pub type GridTriangle = [Corner; 3];

/// The rational point (x/w, y/w, z/w) as [x, y, z, w], w > 0, without a common divisor.
type Point = [i128; 4];

/// The half-space `n . x >= d` as [n, d].
type HalfSpace = [i128; 4];

fn gcd(a: i128, b: i128) -> i128 {
    if b == 0 {
        a.abs()
    } else {
        gcd(b, a % b)
    }
}

fn reduced(p: Point) -> Point {
    let g = p.iter().fold(0, |g, &x| gcd(g, x));
    p.map(|x| x / g)
}

fn sub(a: Corner, b: Corner) -> [i128; 3] {
    [0, 1, 2].map(|k| i128::from(a[k] - b[k]))
}

fn cross(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [i128; 3], b: [i128; 3]) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn negated(a: [i128; 3]) -> [i128; 3] {
    a.map(|x| -x)
}

/// The half-space through `at` with the inner normal `n`.
fn half_space(n: [i128; 3], at: Corner) -> HalfSpace {
    [n[0], n[1], n[2], dot(n, at.map(i128::from))]
}

pub fn has_area(t: &GridTriangle) -> bool {
    cross(sub(t[1], t[0]), sub(t[2], t[0])) != [0; 3]
}

/// Half-spaces whose intersection is exactly the triangle, segment or point.
fn half_spaces(t: &GridTriangle) -> Vec<HalfSpace> {
    let n = cross(sub(t[1], t[0]), sub(t[2], t[0]));
    let mut all = Vec::new();
    let mut plane = |n, at| all.extend([half_space(n, at), half_space(negated(n), at)]);
    if n != [0; 3] {
        plane(n, t[0]);
        for k in 0..3 {
            let edge = sub(t[(k + 1) % 3], t[k]);
            all.push(half_space(cross(n, edge), t[k]));
        }
        return all;
    }
    let (lo, hi) = (*t.iter().min().unwrap(), *t.iter().max().unwrap());
    let along = sub(hi, lo);
    let axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    for axis in axes {
        // For a point `along` is zero and the axes themselves pin it down.
        plane(if lo == hi { axis } else { cross(along, axis) }, lo);
    }
    all.extend([half_space(along, lo), half_space(negated(along), hi)]);
    all
}

/// Keeps the part of a closed polygon (possibly a segment or a point) inside the half-space.
fn clip(polygon: &[Point], h: &HalfSpace) -> Vec<Point> {
    let value = |p: &Point| h[0] * p[0] + h[1] * p[1] + h[2] * p[2] - h[3] * p[3];
    let mut kept = Vec::new();
    for (i, p) in polygon.iter().enumerate() {
        let q = &polygon[(i + 1) % polygon.len()];
        let (vp, vq) = (value(p), value(q));
        if vp >= 0 {
            kept.push(*p);
        }
        if (vp > 0 && vq < 0) || (vp < 0 && vq > 0) {
            // The combination that makes the value zero, signed so that w stays positive.
            let s = vp.signum();
            kept.push(reduced([0, 1, 2, 3].map(|k| s * (vp * q[k] - vq * p[k]))));
        }
    }
    kept.dedup();
    kept
}

/// The corners of the common part of two triangles; empty if there is none.
pub fn common_part(a: &GridTriangle, b: &GridTriangle) -> Vec<Point> {
    let start = a.map(|c| [c[0].into(), c[1].into(), c[2].into(), 1]).to_vec();
    half_spaces(b).iter().fold(start, |polygon, h| clip(&polygon, h))
}

fn is_at(p: &Point, c: Corner) -> bool {
    *p == [c[0].into(), c[1].into(), c[2].into(), 1]
}

/// Whether `p` lies on the line through two corners.
fn is_on_line(p: &Point, e0: Corner, e1: Corner) -> bool {
    let to = [0, 1, 2].map(|k| p[k] - p[3] * i128::from(e0[k]));
    cross(to, sub(e1, e0)) == [0; 3]
}

/// The expected answer by the definition: is there a common point beyond the shared vertex or
/// edge? `None` where triangles without area leave the definition to convention.
pub fn expected(a: &GridTriangle, b: &GridTriangle) -> Option<bool> {
    let distinct = |t: &GridTriangle| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
    if !distinct(a) || !distinct(b) {
        // Shared corners of a segment or point: only the case without any is by definition.
        let apart = a.iter().all(|p| !b.contains(p));
        return apart.then(|| !common_part(a, b).is_empty());
    }
    let shared: Vec<Corner> = a.iter().copied().filter(|p| b.contains(p)).collect();
    let part = common_part(a, b);
    match shared[..] {
        [] => Some(!part.is_empty()),
        [apex] => {
            let in_middle = |t: &GridTriangle| {
                !has_area(t) && t.iter().min() != Some(&apex) && t.iter().max() != Some(&apex)
            };
            let is_convention = in_middle(a) || in_middle(b);
            (!is_convention).then(|| part.iter().any(|p| !is_at(p, apex)))
        }
        [e0, e1] => {
            (has_area(a) && has_area(b)).then(|| part.iter().any(|p| !is_on_line(p, e0, e1)))
        }
        _ => Some(true),
    }
}
