//! `complete-mesh holes`: the table of holes.

use super::args::HolesArgs;
use super::console::{short, Console};
use super::failure::Failure;
use super::fill::look;
use super::interrupt;
use super::report::{mean_edge, Measured, Warning};
use crate::holes::{find_holes, HoleList};
use crate::io::Document;
use crate::mesh::MeshView;
use crate::progress::Monitor;
use serde::Serialize;

/// The last line of `--json`.
#[derive(Serialize)]
struct Summary {
    path: String,
    vertices: usize,
    faces: usize,
    mean_edge: f64,
    holes: usize,
    warnings: Vec<Warning>,
}

pub(super) fn run(args: &HolesArgs, console: &Console) -> Result<(), Failure> {
    console.step("read");
    let document = Document::read(&args.input)?;
    super::check_interrupt()?;
    if document.is_cloud() {
        return super::points::holes(args, &document, console);
    }
    args.given.none_of_a_mesh()?;
    let mesh = MeshView::new(document.vertices(), document.faces());
    let progress = |fraction: f64, stage: &str| console.progress(fraction, stage);
    let monitor = Monitor::new(&progress);
    let holes =
        interrupt::watched(&monitor, || find_holes(mesh, &args.grouping.grouping(), &monitor))?;
    console.clear();
    let mean_edge = mean_edge(mesh);
    console.say(&format!(
        "{}: {} vertices, {} faces, mean edge {}",
        args.input.display(),
        mesh.vertices.len(),
        mesh.faces.len(),
        short(mean_edge)
    ));
    if holes.holes.is_empty() {
        console.say("no holes: the mesh is closed");
    } else {
        console.say(&table(&holes, mean_edge));
    }
    for hole in &holes.holes {
        console.event("hole", &Measured::of(hole));
    }
    let warnings = look(&holes, console);
    let summary = Summary {
        path: args.input.display().to_string(),
        vertices: mesh.vertices.len(),
        faces: mesh.faces.len(),
        mean_edge,
        holes: holes.holes.len(),
        warnings,
    };
    console.event("done", &summary);
    Ok(())
}

/// The table, numbers to the right. Lengths are in mesh units and, in brackets, in mean edges.
fn table(holes: &HoleList, mean_edge: f64) -> String {
    let head = ["id", "kind", "loops", "edges", "circumference", "diameter", "centre", "problem"];
    let length = |x: f64| format!("{} ({:.1})", short(x), x / mean_edge);
    let mut rows = vec![head.map(str::to_owned)];
    rows.extend(holes.holes.iter().map(|hole| {
        let m = Measured::of(hole);
        [
            m.id.to_string(),
            m.kind.to_owned(),
            m.loops.to_string(),
            m.edges.to_string(),
            length(m.circumference),
            length(m.diameter),
            // Far below the hole's size it is rounding noise.
            m.centre.map(|x| short(if x.abs() < 1e-9 * m.diameter { 0.0 } else { x })).join(" "),
            m.problem.unwrap_or_else(|| "-".into()),
        ]
    }));
    align(&rows, &[1, 6, 7])
}

/// Rows in columns, those of words (`left`) to the left.
pub(super) fn align<const N: usize>(rows: &[[String; N]], left: &[usize]) -> String {
    let width: [usize; N] =
        std::array::from_fn(|c| rows.iter().map(|r| r[c].len()).max().unwrap_or(0));
    let line = |row: &[String; N]| {
        let cells = row.iter().enumerate().map(|(c, text)| match left.contains(&c) {
            true => format!("{text:<w$}", w = width[c]),
            false => format!("{text:>w$}", w = width[c]),
        });
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    rows.iter().map(line).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Problem;
    use crate::holes::{Hole, HoleKind};

    #[test]
    fn the_table_is_aligned_and_says_what_is_wrong() {
        let hole = Hole {
            id: 0,
            loops: vec![0],
            kind: HoleKind::Disc,
            edges: 12,
            circumference: 6.0,
            diameter: 2.0,
            centre: [-1e-17, -1.5, 0.25],
            problem: None,
        };
        let problem = Some(Problem::TouchingLoops { vertices: vec![511] });
        let second = Hole { id: 1, kind: HoleKind::Islands, edges: 1200, problem, ..hole.clone() };
        let list = HoleList { holes: vec![hole, second], ..HoleList::default() };
        let text = table(&list, 0.5);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 3);
        assert!(lines[1].contains("6.000 (12.0)") && lines[1].contains("2.000 (4.0)"), "{text}");
        assert!(lines[1].ends_with("0 -1.500 0.2500  -"), "{text}");
        assert!(lines[2].contains("vertex 511"), "{text}");
        let column = |line: &str, word: &str| line.find(word).map(|at| at + word.len());
        assert_eq!(column(lines[1], " 12 "), column(lines[2], "1200 "), "{text}");
    }
}
