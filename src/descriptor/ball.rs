//! Patches as Harary, Tal and Grinspun (2014, section 3) define them: the vertices around a centre
//! that lie in a ball and hang together in it.

use crate::mesh::neighbourhood::NONE;
use glam::DVec3;

/// The vertices next to each vertex.
#[derive(Debug, Clone)]
pub struct VertexGraph {
    start: Vec<u32>,
    to: Vec<u32>,
}

impl VertexGraph {
    /// The edges of the faces. Face indices must be below `vertex_count`.
    pub fn new(vertex_count: usize, faces: &[[u32; 3]]) -> Self {
        let mut start = vec![0u32; vertex_count + 1];
        faces.iter().flatten().for_each(|&v| start[v as usize + 1] += 2);
        for v in 0..vertex_count {
            start[v + 1] += start[v];
        }
        let mut next = start.clone();
        let mut all = vec![NONE; 6 * faces.len()];
        for face in faces {
            for k in 0..3 {
                let at = &mut next[face[k] as usize];
                all[*at as usize] = face[(k + 1) % 3];
                all[*at as usize + 1] = face[(k + 2) % 3];
                *at += 2;
            }
        }
        let mut graph = Self { start: Vec::with_capacity(vertex_count + 1), to: Vec::new() };
        graph.to.reserve(all.len() / 2 + vertex_count);
        for v in 0..vertex_count {
            graph.start.push(graph.to.len() as u32);
            let row = &mut all[start[v] as usize..start[v + 1] as usize];
            row.sort_unstable();
            let mut last = v as u32;
            for &w in row.iter() {
                if w != last && w != v as u32 {
                    graph.to.push(w);
                    last = w;
                }
            }
        }
        graph.start.push(graph.to.len() as u32);
        graph
    }

    /// The neighbours of `v`, ascending.
    pub fn neighbours(&self, v: u32) -> &[u32] {
        &self.to[self.start[v as usize] as usize..self.start[v as usize + 1] as usize]
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.start.len() - 1
    }
}

/// Gathers patches; keeps its scratch from one to the next.
pub struct Balls<'a> {
    positions: &'a [DVec3],
    graph: &'a VertexGraph,
    mark: Vec<u32>,
    round: u32,
}

impl<'a> Balls<'a> {
    /// Patches of this mesh.
    pub fn new(positions: &'a [DVec3], graph: &'a VertexGraph) -> Self {
        Self { positions, graph, mark: vec![0; graph.vertex_count()], round: 0 }
    }

    /// The vertices at most `radius` (mesh units) from vertex `centre` that are joined to it by
    /// edges between such vertices; the centre first, then outward along edges.
    pub fn gather(&mut self, centre: u32, radius: f64, patch: &mut Vec<u32>) {
        self.round += 1;
        patch.clear();
        patch.push(centre);
        self.mark[centre as usize] = self.round;
        let (middle, limit) = (self.positions[centre as usize], radius * radius);
        let mut next = 0;
        while next < patch.len() {
            for &w in self.graph.neighbours(patch[next]) {
                let mark = &mut self.mark[w as usize];
                if *mark != self.round {
                    *mark = self.round;
                    if self.positions[w as usize].distance_squared(middle) <= limit {
                        patch.push(w);
                    }
                }
            }
            next += 1;
        }
    }
}
