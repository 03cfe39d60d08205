//! `complete-mesh demo`: a fluted column with a piece broken off, completed, and a picture of both.

use super::args::DemoArgs;
use super::console::Console;
use super::failure::Failure;
use super::fill::{complete, draw};
use super::output::Outputs;
use super::skin::Wardrobe;
use crate::io::{Document, Extras};
use crate::options::Options;
use crate::sample::{break_mesh, Break, BreakOptions, Sample};
use serde::Serialize;

/// Edges along the column: about 100,000 faces.
const RESOLUTION: usize = 200;

#[derive(Serialize)]
struct Done {
    broken: String,
    completed: String,
    picture: String,
    vertices: usize,
    faces: usize,
    new_vertices: usize,
    new_faces: usize,
    fill_seconds: f64,
    fill_cpu_seconds: f64,
}

pub(super) fn run(args: &DemoArgs, console: &Console) -> Result<(), Failure> {
    let folder = &args.out_dir;
    std::fs::create_dir_all(folder).map_err(|e| Failure::writing(folder, e))?;
    let path = |name: &str| folder.join(name);
    let (broken_path, completed_path, picture_path) =
        (path("broken.ply"), path("completed.ply"), path("before_after.png"));

    console.step("make");
    let whole = Sample::Column.build(RESOLUTION)?;
    let options = BreakOptions { kind: Break::Ragged, seed: 1, size: 1.0 };
    let broken = break_mesh(Sample::Column, &whole, &options)?;
    let (vertices, faces) = (broken.mesh.vertices.len(), broken.mesh.faces.len());
    console.say(&format!(
        "A fluted column of {} faces; a piece of {} faces breaks off.",
        whole.faces.len(),
        broken.removed.faces.len()
    ));

    let mut outputs = Outputs::default();
    let mut document = Document::from_mesh_f32(broken.mesh.vertices, broken.mesh.faces)?;
    outputs.stage(&broken_path, |w| w.write_all(document.as_bytes()))?;
    let (holes, completion) = complete(&document, &Options::default(), console)?;
    document.append(&completion, &Extras::default())?;
    outputs.stage(&completed_path, |w| w.write_all(document.as_bytes()))?;
    console.step("draw");
    let (image, _) = draw(&document, &holes, &completion, false, &Wardrobe::default());
    outputs.stage(&picture_path, |w| image.write_png(w))?;
    super::check_interrupt()?;
    outputs.commit()?;
    console.clear();

    for (hole, report) in holes.holes.iter().zip(&completion.holes) {
        console.say(&format!(
            "Hole {}: {} edges around; filled with {} vertices and {} faces: {}.",
            hole.id,
            hole.edges,
            report.vertices.len(),
            report.faces.len(),
            report.summary()
        ));
    }
    console.say(&format!(
        "The fill took {:.3} s ({:.3} s CPU); all {vertices} vertices and {faces} faces of the \
         broken column are in the result, bit for bit.",
        completion.seconds, completion.cpu_seconds
    ));
    console.say(&format!(
        "\n  before     {}\n  after      {}\n  picture    {}\n\nNext: look at the picture, or try\n  \
         complete-mesh holes {}\n  complete-mesh fill YOUR_MESH.ply -o completed.ply --picture \
         completed.png",
        broken_path.display(),
        completed_path.display(),
        picture_path.display(),
        broken_path.display()
    ));
    console.event(
        "done",
        &Done {
            broken: broken_path.display().to_string(),
            completed: completed_path.display().to_string(),
            picture: picture_path.display().to_string(),
            vertices,
            faces,
            new_vertices: completion.vertices.len(),
            new_faces: completion.faces.len(),
            fill_seconds: completion.seconds,
            fill_cpu_seconds: completion.cpu_seconds,
        },
    );
    Ok(())
}
