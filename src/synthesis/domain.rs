//! What a fill is computed on: the initial completion with the known ring around it, and at each
//! vertex the line along which sources are looked for.
//!
//! All surfaces over a domain are heights: vertex i of one lies at `position` + height · `direction`.
//! The known surface has height 0 everywhere, and one number a vertex is what all later steps add,
//! compare and solve for.

use super::factor::Symmetric;
use super::rank::known_normals;
use crate::fill::patch::Patch;
use crate::fill::sheet::{Band, Incidence, Laplacian, Sheet, Weights};
use crate::matching::icp::RingPoint;
use crate::matching::paint::Paint;
use crate::matching::search::{Loose, Target};
use crate::mesh::neighbourhood::Neighbourhood;
use crate::mesh::normals::vertex_normals;
use glam::DVec3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Width of the known ring, in hole radii.
pub const RING: f64 = 0.5;
/// Extent over half-width above which a hole is looked at through windows: what is around a crack
/// says nothing about its far end. Ragged discs reach 3, cracks begin at 6.
const LONG: f64 = 4.0;
/// Radius of such a window, in half-widths: the ring beside it must be wide enough to be told apart.
const WINDOW: f64 = 2.5;
/// Length over which directions are smoothed, in hole radii: they shall follow the shape, not
/// the relief.
const SMOOTHING: f64 = 0.15;

/// What the widths of a domain are measured in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// The hole's radius.
    Whole,
    /// The hole's radius; the fill is not the initial completion any more, so that its own normals say
    /// where to look.
    Found,
    /// That of a window, where the hole is long and narrow.
    Narrow,
    /// The same of a fill that is not the initial completion any more.
    FoundNarrow,
}

/// The initial completion of one hole with the known ring around it.
pub struct Domain {
    /// Patch, then ring.
    pub sheet: Sheet,
    /// Its cotangent Laplacian.
    pub laplacian: Laplacian,
    /// Unit lines, outward.
    pub directions: Vec<DVec3>,
    /// Distance of each known vertex from the rim along edges, in mesh units; 0 inside. In a window from the rim of
    /// what it shows of the fill.
    pub rim_distance: Vec<f64>,
    /// Neighbourhood vertex of each known vertex, by (sheet vertex − patch vertices); the rim's
    /// are the first of the band.
    pub band: Vec<u32>,
    /// Known vertices (rim included) that are compared with sources.
    pub ring: Vec<usize>,
    /// Whether all triangles around a vertex are in the domain.
    pub complete: Vec<bool>,
    /// Whether the edge of a window cuts off some of the fill's triangles around a vertex.
    pub cut: Vec<bool>,
    /// How much of what is found is used at each vertex: 1, in a window less towards its edge.
    pub say: Vec<f64>,
    /// Vertices of the fill: `rim_count..patch_count` of the sheet.
    pub fill: std::ops::Range<usize>,
    /// The length that all widths are measured in, in mesh units: the greatest distance of a fill
    /// vertex from the middle of the fill; less for holes that are long and narrow.
    pub radius: f64,
    /// Greatest distance of a fill vertex from the middle of the fill, in mesh units.
    pub extent: f64,
    /// Greatest distance of a fill vertex from the rim, in mesh units.
    pub depth: f64,
    /// Mean edge length at the rim, in mesh units.
    pub edge: f64,
    /// Middle of the fill.
    pub centre: DVec3,
    /// Colours of the known vertices, by sheet vertex, if there are any.
    pub paint: Option<Paint>,
    /// What is known and says nothing of the fill.
    pub loose: Loose,
}

impl Domain {
    /// Of a patch whose rim is the band's first ring. `edge`: mean edge length at the rim. `None`
    /// if a system cannot be factored.
    pub fn new(
        patch: &Patch,
        near: &Neighbourhood,
        incidence: &Incidence,
        rim: &[u32],
        edge: f64,
        seen: Extent,
    ) -> Option<Self> {
        let fill = patch.rim_count..patch.positions.len();
        let inner = &patch.positions[fill.clone()];
        let all = if inner.is_empty() { &patch.positions[..] } else { inner };
        let centre = all.iter().copied().sum::<DVec3>() / all.len().max(1) as f64;
        let extent = all.iter().map(|p| p.distance(centre)).fold(0.0, f64::max);
        let depth = depth(patch);
        let radius = match seen {
            Extent::Whole | Extent::Found => extent,
            Extent::Narrow | Extent::FoundNarrow => extent.min(WINDOW * depth),
        };
        let rings = (RING * radius / edge).ceil() as usize + 2;
        let band = Band::grow(near, incidence, rim, rings);
        let sheet = Sheet::new(patch, &band, near);
        let laplacian = Laplacian::new(&sheet.positions, &sheet.triangles, Weights::Cotangent);
        let rim_distance = distances(&sheet);
        let complete: Vec<bool> =
            (0..sheet.positions.len()).map(|v| sheet.is_complete(v)).collect();
        let mut domain = Self {
            directions: Vec::new(),
            rim_distance,
            band: band.vertices,
            ring: Vec::new(),
            cut: vec![false; complete.len()],
            say: vec![1.0; complete.len()],
            complete,
            fill,
            radius,
            extent,
            depth,
            edge,
            centre,
            paint: None,
            loose: Loose::new(&sheet),
            laplacian,
            sheet,
        };
        domain.ring = domain.find_ring();
        domain.directions =
            domain.smooth_directions(matches!(seen, Extent::Found | Extent::FoundNarrow))?;
        Some(domain)
    }

    /// Whether the hole is long and narrow.
    pub fn is_slender(&self) -> bool {
        self.extent > LONG * self.depth
    }

    /// The same with its ring found anew, for another radius.
    pub fn with_ring(mut self) -> Self {
        self.ring = self.find_ring();
        self
    }

    /// With the colours of what is known, by input vertex.
    pub fn painted(mut self, known: &Option<Paint>, near: &Neighbourhood) -> Self {
        let input = |v: usize| near.vertices[self.near_vertex(v) as usize] as usize;
        let of = |v: usize| self.is_known(v).then(|| input(v));
        self.paint = known.as_ref().map(|p| p.part((0..self.sheet.positions.len()).map(of)));
        self
    }

    /// Positions, normals and tints of the ring.
    pub fn ring_points(&self) -> Vec<RingPoint> {
        let normals = known_normals(self);
        let tint = |v: usize| self.paint.as_ref().map_or(0.0, |p| p.tint[v]);
        self.ring.iter().map(|&v| (self.sheet.positions[v], normals[v], tint(v))).collect()
    }

    /// What candidates are searched for.
    pub fn target<'a>(&'a self, ring: &'a [RingPoint]) -> Target<'a> {
        let normal: DVec3 = self.fill.clone().map(|v| self.directions[v]).sum();
        Target {
            centre: self.centre,
            normal: normal.normalize_or_zero(),
            radius: self.radius,
            fill: &self.sheet.positions[self.fill.clone()],
            ring,
            loose: self.loose.clone(),
            emphasis: 1.0,
        }
    }

    /// Pairs of fill vertices that an edge joins, by their numbers among the fill's.
    pub fn fill_edges(&self) -> Vec<(u32, u32)> {
        let first = self.fill.start;
        let mut edges = Vec::new();
        for v in self.fill.clone() {
            let later = self.laplacian.row(v).filter(|&(w, _)| w > v && self.fill.contains(&w));
            edges.extend(later.map(|(w, _)| ((v - first) as u32, (w - first) as u32)));
        }
        edges
    }

    /// Distance of each known vertex along edges from that part of the rim that the fill touches; 0 in the fill.
    fn distance_from_fill(&self) -> Vec<f64> {
        let sheet = &self.sheet;
        let band = &sheet.triangles[sheet.triangles.len() - sheet.band_face_count..];
        let mut start = vec![false; sheet.rim_count];
        for v in self.fill.clone() {
            let rim = self.laplacian.row(v).map(|(w, _)| w).filter(|&w| w < self.fill.start);
            rim.for_each(|w| start[w] = true);
        }
        let start = (0..sheet.rim_count).filter(|&v| start[v]);
        let mut distance = from_rim(&sheet.positions, band, start);
        distance[self.fill.clone()].fill(0.0);
        distance
    }

    fn find_ring(&self) -> Vec<usize> {
        let width = RING * self.radius;
        let of_ring = |&v: &usize| {
            let near = self.is_known(v) && self.rim_distance[v] <= width && self.complete[v];
            near && !self.loose.beyond(self.sheet.positions[v])
        };
        (0..self.sheet.positions.len()).filter(of_ring).collect()
    }

    /// The part of the domain around a fill vertex: the fill within `radius` of it and the known
    /// surface within `radius` and the ring's width, as far as it hangs together. Also returns
    /// which vertex of this domain each vertex of the part is.
    pub fn window(&self, at: usize, radius: f64) -> (Self, Vec<usize>) {
        let centre = self.sheet.positions[at];
        let inside = |v: usize| {
            let most = if self.is_known(v) { (1.0 + RING) * radius } else { radius };
            self.sheet.positions[v].distance(centre) <= most
        };
        let mut number = vec![u32::MAX; self.sheet.positions.len()];
        let mut queue = vec![at];
        number[at] = 0;
        while let Some(v) = queue.pop() {
            for (w, _) in self.laplacian.row(v) {
                if number[w] == u32::MAX && inside(w) {
                    number[w] = 0;
                    queue.push(w);
                }
            }
        }
        let members: Vec<usize> = (0..number.len()).filter(|&v| number[v] == 0).collect();
        members.iter().enumerate().for_each(|(i, &v)| number[v] = i as u32);
        let mut complete: Vec<bool> = members.iter().map(|&v| self.complete[v]).collect();
        let keep = |t: &[u32; 3]| t.iter().all(|&v| number[v as usize] != u32::MAX);
        let mut cut = vec![false; members.len()];
        let band_start = self.sheet.triangles.len() - self.sheet.band_face_count;
        for (i, tri) in self.sheet.triangles.iter().enumerate().filter(|(_, t)| !keep(t)) {
            for v in tri.map(|v| number[v as usize]).into_iter().filter(|&v| v != u32::MAX) {
                complete[v as usize] = false;
                cut[v as usize] |= i < band_start;
            }
        }
        let pick = |t: &[u32; 3]| t.map(|v| number[v as usize]);
        let say = |&v: &usize| {
            let off = self.sheet.positions[v].distance(centre) / radius;
            (1.0 - off * off).max(0.0).powi(2)
        };
        let (patch, band) = self.sheet.triangles.split_at(band_start);
        let mut triangles: Vec<[u32; 3]> = patch.iter().filter(|t| keep(t)).map(pick).collect();
        let patch_faces = triangles.len();
        triangles.extend(band.iter().filter(|t| keep(t)).map(pick));
        let positions: Vec<DVec3> = members.iter().map(|&v| self.sheet.positions[v]).collect();
        let below = |end: usize| members.partition_point(|&v| v < end);
        let sheet = Sheet {
            band_face_count: triangles.len() - patch_faces,
            rim_count: below(self.fill.start),
            patch_count: below(self.fill.end),
            ring: members.iter().map(|&v| self.sheet.ring[v]).collect(),
            rings: self.sheet.rings,
            loose: Vec::new(),
            positions,
            triangles,
        };
        let band = (members.iter().filter(|&&v| v < self.fill.start))
            .chain(members.iter().filter(|&&v| v >= self.fill.end))
            .map(|&v| self.near_vertex(v))
            .collect();
        let mut part = Self {
            laplacian: Laplacian::new(&sheet.positions, &sheet.triangles, Weights::Cotangent),
            directions: members.iter().map(|&v| self.directions[v]).collect(),
            rim_distance: members.iter().map(|&v| self.rim_distance[v]).collect(),
            band,
            ring: Vec::new(),
            complete,
            cut,
            say: members.iter().map(say).collect(),
            fill: sheet.rim_count..sheet.patch_count,
            radius,
            extent: radius,
            depth: self.depth,
            edge: self.edge,
            centre,
            paint: self.paint.as_ref().map(|p| p.part(members.iter().map(|&v| Some(v)))),
            loose: self.loose.clone(),
            sheet,
        };
        part.ring = part.find_ring();
        if part.cut.contains(&true) {
            part.rim_distance = part.distance_from_fill();
        }
        (part, members)
    }

    /// Whether a vertex belongs to the input.
    #[inline]
    pub fn is_known(&self, v: usize) -> bool {
        !self.fill.contains(&v)
    }

    /// Neighbourhood vertex of a known vertex.
    pub fn near_vertex(&self, v: usize) -> u32 {
        match v < self.fill.start {
            true => self.band[v],
            false => self.band[v - self.fill.len()],
        }
    }

    /// L M⁻¹ L over complete rows, and those that a window cuts: the thin plate's energy, lower triangle.
    pub fn plate_energy(&self) -> Symmetric {
        Symmetric::from_columns(self.plate_columns())
    }

    /// The same by columns of (row, value), rows repeated.
    pub fn plate_columns(&self) -> Vec<Vec<(u32, f64)>> {
        let l = &self.laplacian;
        let n = self.sheet.positions.len();
        let mut columns: Vec<Vec<(u32, f64)>> = (0..n).map(|v| vec![(v as u32, 0.0)]).collect();
        for i in 0..n {
            if !self.complete[i] && self.is_known(i) && !self.cut[i] {
                continue;
            }
            let row = || std::iter::once((i, l.diagonal[i])).chain(l.row(i).map(|(k, w)| (k, -w)));
            for (a, x) in row() {
                for (b, y) in row().filter(|&(b, _)| b >= a) {
                    columns[a].push((b as u32, x * y / l.mass[i]));
                }
            }
        }
        columns
    }

    /// L itself, lower triangle: the membrane's energy.
    pub fn membrane_energy(&self) -> Symmetric {
        let l = &self.laplacian;
        let column = |v: usize| {
            let below = l.row(v).filter(|&(w, _)| w > v).map(|(w, x)| (w as u32, -x));
            std::iter::once((v as u32, l.diagonal[v])).chain(below).collect()
        };
        Symmetric::from_columns((0..self.sheet.positions.len()).map(column).collect())
    }

    /// Normals of the known surface (and the fill's, where they say something), smoothed and carried
    /// into the fill: minimises s² nᵀ L n + Σ_known m |n − n₀|².
    fn smooth_directions(&self, of_fill: bool) -> Option<Vec<DVec3>> {
        let n = self.sheet.positions.len();
        let band_start = self.sheet.triangles.len() - self.sheet.band_face_count;
        let from = if of_fill { 0 } else { band_start };
        let faces = self.sheet.triangles[from..].iter().copied();
        let normals = vertex_normals(&self.sheet.positions, faces);
        let s2 = (SMOOTHING * self.radius).powi(2);
        let says = |v: usize| self.is_known(v) && !self.loose.beyond(self.sheet.positions[v]);
        let is_data = |v: usize| of_fill || says(v);
        let data = |v: usize| if is_data(v) { self.laplacian.mass[v] } else { 0.0 };
        let diagonal: Vec<f64> = (0..n).map(|v| data(v) / s2).collect();
        let factor = self.membrane_energy().factor(1.0, &diagonal)?;
        let mut columns: Vec<Vec<f64>> =
            (0..3).map(|d| (0..n).map(|v| diagonal[v] * normals[v][d]).collect()).collect();
        factor.solve(&mut columns);
        let smooth = |v: usize| DVec3::new(columns[0][v], columns[1][v], columns[2][v]);
        Some((0..n).map(|v| smooth(v).normalize_or_zero()).collect())
    }
}

/// Distance of each known vertex from the rim along edges; 0 in the fill.
fn distances(sheet: &Sheet) -> Vec<f64> {
    let band = &sheet.triangles[sheet.triangles.len() - sheet.band_face_count..];
    let mut distance = from_rim(&sheet.positions, band, 0..sheet.rim_count);
    distance[sheet.rim_count..sheet.patch_count].fill(0.0);
    distance
}

/// Greatest distance from the rim to a fill vertex along edges: half the width of a long hole.
pub fn depth(patch: &Patch) -> f64 {
    let distance = from_rim(&patch.positions, &patch.triangles, 0..patch.rim_count);
    distance.into_iter().filter(|d| d.is_finite()).fold(0.0, f64::max)
}

/// Dijkstra from some vertices along the triangles' edges.
fn from_rim(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    rim: impl Iterator<Item = usize>,
) -> Vec<f64> {
    let n = positions.len();
    let mut links: Vec<Vec<u32>> = vec![Vec::new(); n];
    for tri in triangles {
        for k in 0..3 {
            links[tri[k] as usize].push(tri[(k + 1) % 3]);
            links[tri[(k + 1) % 3] as usize].push(tri[k]);
        }
    }
    let mut distance = vec![f64::INFINITY; n];
    let mut heap = BinaryHeap::new();
    for v in rim {
        distance[v] = 0.0;
        heap.push((Reverse(0), v));
    }
    // Positive floats order as their bits do.
    while let Some((Reverse(bits), v)) = heap.pop() {
        let d = f64::from_bits(bits);
        if d > distance[v] {
            continue;
        }
        for &w in &links[v] {
            let w = w as usize;
            let longer = d + positions[v].distance(positions[w]);
            if longer < distance[w] {
                distance[w] = longer;
                heap.push((Reverse(longer.to_bits()), w));
            }
        }
    }
    distance
}
