//! How well the holes of clouds are found: meshes lose their faces, their boundary loops are the truth.
//!
//! `cargo run --release --example cloud_holes -- [--noise EDGES] [--outliers SHARE]
//! [--uneven smooth|abrupt|rows] [--list] MESH...`

use complete_mesh::io::Document;
use complete_mesh::options::Grouping;
use complete_mesh::points::PointHoles;
use complete_mesh::{find_holes, find_point_holes, MeshView, Monitor, Options, VertexView};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use scanned::{scan, uneven::Uneven};
use std::error::Error;

mod scanned;

/// Loops of fewer points are not asked for, nor those that are shorter than so many spacings.
const LEAST: usize = 13;
/// Share of a rim's points that must lie beside the other, and how near, in spacings.
const SHARED: f64 = 0.5;
const BESIDE: f64 = 2.0;
struct Asked {
    uneven: Option<Uneven>,
    noise: f64,
    outliers: f64,
    list: bool,
}

#[derive(Default)]
struct Score {
    loops: usize,
    found: usize,
    others: usize,
    /// Of the found and of the others, those that each further detector sees, and those that the field
    /// cannot judge.
    seen: [[usize; 3]; 2],
}

impl Score {
    fn row(&self, name: &str) {
        let counts = |s: [usize; 3]| format!("{} {} {}", s[0], s[1], s[2]);
        let [found, others] = self.seen.map(counts);
        println!(
            "{:>6} {:>6} {:>10} {:>6} {:>10}  {name}",
            self.loops, self.found, found, self.others, others
        );
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let (mut asked, mut meshes) =
        (Asked { uneven: None, noise: 0.0, outliers: 0.0, list: false }, Vec::new());
    let mut words = std::env::args().skip(1);
    let number = |word: Option<String>| -> Result<f64, Box<dyn Error>> {
        Ok(word.ok_or("a number is missing")?.parse()?)
    };
    while let Some(word) = words.next() {
        match &word[..] {
            "--noise" => asked.noise = number(words.next())?,
            "--outliers" => asked.outliers = number(words.next())?,
            "--uneven" => {
                let how = words.next().and_then(|w| Uneven::named(&w));
                asked.uneven = Some(how.ok_or("--uneven takes smooth, abrupt or rows")?);
            }
            "--list" => asked.list = true,
            _ => meshes.push(word),
        }
    }
    let mut all = Score::default();
    println!("{:>6} {:>6} {:>10} {:>6} {:>10}", "loops", "found", "seen", "others", "seen");
    println!("seen: by loops, by the distance field, not to be judged by the field");
    for path in &meshes {
        let s = score(path, &asked)?;
        s.row(path);
        all.loops += s.loops;
        all.found += s.found;
        all.others += s.others;
        (0..6).for_each(|k| all.seen[k / 3][k % 3] += s.seen[k / 3][k % 3]);
    }
    all.row("all");
    Ok(())
}

fn score(path: &str, asked: &Asked) -> Result<Score, Box<dyn Error>> {
    let document = Document::read(path.as_ref())?;
    let mesh = MeshView::new(document.vertices(), document.faces());
    let truth = find_holes(mesh, &Grouping::Separate, &Monitor::silent())?;
    let scanned = scan(mesh, asked.uneven, asked.noise, asked.outliers);
    let (points, edge) = (&scanned.points, scanned.edge);
    let view: VertexView<'_> = (&points[..]).into();
    let found = find_point_holes(view, None, &Options::default(), &Monitor::silent())?;
    let ends = |ids: &[u32], at: &dyn Fn(u32) -> [f64; 3]| ids.iter().map(|&v| at(v)).collect();
    let rims: Vec<Vec<[f64; 3]>> =
        truth.loops.iter().map(|l| ends(&l.vertices, &|v| mesh.vertices.get(v as usize))).collect();
    let made: Vec<Vec<[f64; 3]>> =
        found.list.loops.iter().map(|l| ends(&l.vertices, &|v| points[v as usize])).collect();
    // A rim where the points are sparse may have fewer than the mesh.
    let asked_for = |rim: &[[f64; 3]]| {
        let step = |i: usize| distance(rim[i], rim[(i + 1) % rim.len()]) / scanned.spacing(rim[i]);
        let points = (0..rim.len()).map(step).sum::<f64>();
        rim.len() >= LEAST && (asked.uneven.is_none() || points >= LEAST as f64)
    };
    let beside = |a: &[[f64; 3]], b: &[[f64; 3]]| beside(a, b, &|p| BESIDE * scanned.spacing(p));
    let mut score = Score::default();
    for (l, rim) in rims.iter().enumerate().filter(|(_, r)| asked_for(r)) {
        score.loops += 1;
        if made.iter().any(|m| beside(rim, m) >= SHARED) {
            score.found += 1;
        } else if asked.list {
            let b = &truth.loops[l];
            println!(
                "  missed {} points, {:.1} edges, at {:.4?}",
                rim.len(),
                b.length / edge,
                b.centre
            );
        }
    }
    let every: Vec<[f64; 3]> = rims.iter().flatten().copied().collect();
    for (h, hole) in found.list.holes.iter().enumerate().filter(|(h, _)| !found.borders[*h]) {
        let other = !hole.loops.iter().any(|&l| beside(&made[l], &every) >= SHARED);
        let field = found.in_field[h];
        let seen = [found.in_loops[h], field == Some(true), field.is_none()];
        (0..3).for_each(|k| score.seen[usize::from(other)][k] += usize::from(seen[k]));
        score.others += usize::from(other);
        if asked.list && (other || seen[1..] == [false; 2]) {
            tell(&found, h, edge, if other { "other" } else { "not in the field:" });
        }
    }
    if asked.list && !found.only_in_field.is_empty() {
        println!("  only in the field: {:.4?}", found.only_in_field);
    }
    Ok(score)
}

fn tell(found: &PointHoles, h: usize, edge: f64, what: &str) {
    let hole = &found.list.holes[h];
    println!(
        "  {what} {} points, {:.1} edges, {:.0} missing, probability {:.2}, loops {}, field {:?}, at {:.4?}",
        hole.edges,
        hole.circumference / edge,
        found.missing_in[h],
        found.probability[h],
        found.in_loops[h],
        found.in_field[h],
        hole.centre
    );
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// Share of the points of `a` that lie beside one of `b`.
fn beside(a: &[[f64; 3]], b: &[[f64; 3]], near: &dyn Fn([f64; 3]) -> f64) -> f64 {
    if b.is_empty() {
        return 0.0;
    }
    let tree: ImmutableKdTree<f64, 3> = ImmutableKdTree::new_from_slice(b);
    let close =
        a.iter().filter(|p| tree.nearest_one::<SquaredEuclidean>(p).distance < near(**p).powi(2));
    close.count() as f64 / a.len() as f64
}
