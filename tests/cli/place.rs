//! A folder of its own for each test, small files for it, and what is read back.

use complete_mesh::io::Document;
use complete_mesh::sample::Sample;
use complete_mesh::{find_holes, Grouping, MeshView, Monitor};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// A folder of its own, and the binary run in it.
pub struct Place(pub TempDir);

impl Place {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_complete-mesh"));
        command.args(line.split_whitespace()).current_dir(self.0.path());
        command
    }

    pub fn run(&self, line: &str) -> Output {
        self.command(line).output().unwrap()
    }

    /// Runs it, expects the exit code, and returns stdout and stderr.
    pub fn expect(&self, code: i32, line: &str) -> (String, String) {
        let out = self.run(line);
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        let (stdout, stderr) = (text(out.stdout), text(out.stderr));
        assert_eq!(out.status.code(), Some(code), "{line}\n{stdout}\n{stderr}");
        (stdout, stderr)
    }

    pub fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap();
    }

    pub fn names(&self) -> BTreeSet<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
    }

    pub fn json(&self, name: &str) -> Value {
        serde_json::from_slice(&std::fs::read(self.path(name)).unwrap()).unwrap()
    }
}

/// An ascii PLY.
pub fn ply(vertices: &[[f32; 3]], faces: &[[u32; 3]]) -> String {
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        vertices.len(),
        faces.len()
    );
    vertices.iter().for_each(|[x, y, z]| text.push_str(&format!("{x} {y} {z}\n")));
    faces.iter().for_each(|[a, b, c]| text.push_str(&format!("3 {a} {b} {c}\n")));
    text
}

pub const OCTAHEDRON: [[f32; 3]; 6] = [
    [1.0, 0.0, 0.0],
    [-1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, -1.0],
];
pub const EIGHT: [[u32; 3]; 8] =
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];

/// The octahedron without its first face: one hole, 0-2-4.
pub fn open_octahedron() -> String {
    ply(&OCTAHEDRON, &EIGHT[1..])
}

/// Positions (as bits) and triangles of a file.
pub fn geometry(path: &Path) -> (Vec<[u64; 3]>, Vec<[u32; 3]>) {
    let document = Document::read(path).unwrap();
    let (v, f) = (document.vertices(), document.faces());
    (
        (0..v.len()).map(|i| v.get(i).map(f64::to_bits)).collect(),
        (0..f.len()).map(|i| f.get(i)).collect(),
    )
}

pub fn hole_count(path: &Path) -> usize {
    let document = Document::read(path).unwrap();
    let mesh = MeshView::new(document.vertices(), document.faces());
    find_holes(mesh, &Grouping::Automatic, &Monitor::silent()).unwrap().holes.len()
}

/// The input's elements come first, bit for bit.
pub fn assert_kept(input: &Path, output: &Path) {
    let ((v, f), (w, g)) = (geometry(input), geometry(output));
    assert_eq!(v[..], w[..v.len()], "vertices");
    assert_eq!(f[..], g[..f.len()], "faces");
}

pub fn lines(stdout: &str) -> Vec<Value> {
    stdout.lines().map(|l| serde_json::from_str(l).unwrap_or_else(|e| panic!("{e}: {l}"))).collect()
}

/// Ids of the holes that the report says are filled.
pub fn filled(report: &Value) -> Vec<u64> {
    let holes = report["holes"].as_array().unwrap().iter();
    holes.filter(|h| h["status"] == "filled").map(|h| h["id"].as_u64().unwrap()).collect()
}

/// A sphere with two faces missing that share just one vertex, and one far away: the first two
/// rims touch.
pub fn touching() -> String {
    let mesh = Sample::Sphere.build(24).unwrap();
    let pole = mesh.vertices.len() as u32 - 1;
    let around: Vec<usize> =
        (0..mesh.faces.len()).filter(|&f| mesh.faces[f].contains(&pole)).collect();
    let first = around[0];
    let shared = |f: usize| mesh.faces[f].iter().filter(|v| mesh.faces[first].contains(v)).count();
    let second = around.iter().copied().find(|&f| shared(f) == 1).unwrap();
    let far = mesh.faces.len() / 2;
    let faces: Vec<[u32; 3]> = (0..mesh.faces.len())
        .filter(|f| ![first, second, far].contains(f))
        .map(|f| mesh.faces[f])
        .collect();
    ply(&mesh.vertices, &faces)
}
