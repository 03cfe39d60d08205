//! The mesh through a cloud, its holes in the cloud's own numbers, and the way back.

use super::check_options;
use super::clean::{clean, Cleaned};
use super::detectors::Seen;
use super::given::{self, narrow, Ball, Given};
use super::normals::{normals as make_normals, normals_after};
use super::smooth::smooth;
use super::surface::surface;
use super::tidy::{rims, tidy, Rim, RimKind};
use super::{
    vertex_normals, CleanedPoints, Completion, Copied, HoleStatus, Origin, PointCompletion,
    Vertices, NONE,
};
use crate::error::{Error, Result};
use crate::holes::{find_holes, HoleKind, HoleList};
use crate::mesh::{MeshView, VertexView};
use crate::options::{Appearance, Grouping, Options, Sources};
use crate::progress::Monitor;
use glam::DVec3;
use std::collections::HashMap;

/// The shorter end of a missing band is at least so long, as a share of the other: a cluster of
/// outliers beside a hole is no end.
const BAND: f64 = 0.3;
/// Part of a completion's progress that the mesh through the points and its rims are.
pub const MADE: f64 = 0.03;

/// What was found out about a cloud.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PointHoles {
    /// The holes: loops of input points; "edges" are the points of a rim, "vertices" are points.
    pub list: HoleList,
    /// For each hole whether it is the outer border of an open surface.
    pub borders: Vec<bool>,
    /// For each hole an estimate of how many points are missing.
    pub missing_in: Vec<f64>,
    /// For each hole the mean boundary probability of its rim's points (Bendels et al. 2005), 0 to 1:
    /// from 0.4 a rim is plain to see.
    pub probability: Vec<f64>,
    /// For each hole whether a second detector closes loops where its rims are: a spanning tree of the
    /// points that are likely to lie on a boundary (Bendels et al. 2005).
    pub in_loops: Vec<bool>,
    /// For each hole whether the distance field has one there, a third detector (Park et al. 2006): what
    /// grows inside meets what grows outside. `None` where it cannot say: an open surface has no inside.
    pub in_field: Vec<Option<bool>>,
    /// Centres of the places that only the distance field takes for holes.
    pub only_in_field: Vec<[f64; 3]>,
    /// The middle one of the distances to the sixth neighbour, in cloud units.
    pub spacing: f64,
    /// Points without coordinates (all three NaN); they are passed through and otherwise ignored.
    pub missing: Vec<u32>,
    /// Points at, or within a quarter spacing of, an earlier one; not looked at.
    pub doubles: Vec<u32>,
    /// Points beside the surface; not looked at.
    pub outliers: Vec<u32>,
    /// Points inside loops that the caller gave; not looked at.
    pub inside: Vec<u32>,
}

impl PointHoles {
    /// Whether no detector that can judge is against a hole, by its id. One that not all agree on may be a
    /// sparse place.
    pub fn agreed(&self, hole: usize) -> bool {
        self.in_loops[hole] && self.in_field[hole] != Some(false)
    }
}

/// Finds, measures and judges the holes of a cloud. Of the options grouping, given holes, cleaning and threads
/// count, but all are checked. See [`super::complete_points`].
pub fn find_point_holes(
    points: VertexView<'_>,
    normals: Option<VertexView<'_>>,
    options: &Options,
    monitor: &Monitor,
) -> Result<PointHoles> {
    options.check()?;
    check_options(options)?;
    let scaffold = Scaffold::new(points, normals, options, monitor)?;
    let vertices = scaffold.vertices(points);
    let mesh = MeshView { vertices: vertices.view(), faces: (&scaffold.faces[..]).into() };
    let grouping = scaffold.local_grouping(mesh, &options.grouping, monitor)?;
    let list = find_holes(mesh, &grouping, monitor)?;
    Ok(scaffold.holes(&list).0)
}

/// A mesh through the points of a cloud.
pub(super) struct Scaffold {
    /// Input index of each of its vertices, ascending.
    pub ids: Vec<u32>,
    /// Its triangles, over its own vertices.
    pub faces: Vec<[u32; 3]>,
    /// Where its vertices lie if the points were smoothed.
    pub smoothed: Option<Vec<DVec3>>,
    rims: Vec<Rim>,
    /// Whether its holes were given.
    given: bool,
    found: PointHoles,
}

impl Scaffold {
    pub fn new(
        cloud: VertexView<'_>,
        given: Option<VertexView<'_>>,
        options: &Options,
        monitor: &Monitor,
    ) -> Result<Self> {
        let (cleaning, threads) = (options.clean, options.threads);
        given::check(&options.given_holes, cloud)?;
        monitor.step(0.0, "finding neighbours")?;
        if given.is_some_and(|g| g.len() != cloud.len()) {
            let reason = format!("{} for {} points", given.map_or(0, |g| g.len()), cloud.len());
            return Err(Error::InvalidOption { name: "normals", reason });
        }
        let cleaned = clean(cloud, threads, monitor)?;
        let Cleaned { ids, points, neighbours, spacing, missing, doubles, outliers } = cleaned;
        let holes = Given::new(&options.given_holes, &ids)?;
        monitor.step(0.01, "orienting normals")?;
        let given: Option<Vec<DVec3>> = given.map(|g| {
            let normal = |&i: &u32| DVec3::from(g.get(i as usize));
            ids.iter()
                .map(normal)
                .map(|n| if n.is_finite() { n.normalize_or_zero() } else { DVec3::ZERO })
                .collect()
        });
        let side = given.as_deref();
        let mut normals = make_normals(&points, &neighbours, side, threads, monitor)?;
        let mut points = points;
        let rounds = cleaning.map_or(0, |c| c.rounds);
        if rounds > 0 {
            points = smooth(&points, &normals, &neighbours, &spacing, rounds, threads, monitor)?;
            if cloud.is_single() {
                points.iter_mut().for_each(|p| *p = p.as_vec3().as_dvec3());
            }
            normals = normals_after(&points, &neighbours, &normals, threads, monitor)?;
        }
        monitor.step(0.02, "meshing")?;
        let linked = neighbours.mutual();
        let lay = |limits: &[f64], regions: &[Ball]| {
            let mut made = surface(&points, &normals, &linked, limits, threads, monitor)?;
            tidy(&mut made, regions);
            Ok(made)
        };
        let mut surface = lay(&spacing, &[])?;
        let unseen = holes.without_hole(&surface);
        if !unseen.is_empty() {
            surface = lay(&narrow(&unseen, &points, &spacing), &unseen)?;
        }
        drop(linked);
        monitor.step(MADE, "judging gaps")?;
        let (inside, cut) = holes.cut(&mut surface, &spacing, &ids)?;
        let mut rims = rims(&surface, &unseen);
        if !holes.is_empty() {
            holes.mark(&surface, &mut rims, &cut)?;
        }
        let seen = Seen { points: &points, normals: &normals, neighbours: &neighbours };
        let only_in_field = seen.ask(&mut rims, &spacing, threads, monitor)?;
        let alive = surface.triangles.iter().zip(&surface.dropped).filter(|t| !t.1);
        let faces: Vec<[u32; 3]> = alive.map(|t| *t.0).collect();
        if faces.is_empty() {
            return Err(Error::NoSurface { count: ids.len() });
        }
        let mut middle = spacing;
        let half = middle.len() / 2;
        let spacing = *middle.select_nth_unstable_by(half, f64::total_cmp).1;
        let found = PointHoles {
            spacing,
            missing,
            doubles,
            outliers,
            inside: inside.iter().map(|&v| ids[v as usize]).collect(),
            only_in_field,
            ..PointHoles::default()
        };
        let smoothed = (rounds > 0).then_some(points);
        let given = !holes.is_empty();
        Ok(Self { ids, faces, smoothed, rims, given, found })
    }

    /// The vertices of the mesh.
    pub fn vertices(&self, cloud: VertexView<'_>) -> Vertices {
        let at = |i: usize| match &self.smoothed {
            Some(points) => points[i].to_array(),
            None => cloud.get(self.ids[i] as usize),
        };
        Vertices::new((0..self.ids.len()).map(at), cloud.is_single())
    }

    /// The cleaned copy of the cloud.
    pub fn cleaned(&self, cloud: VertexView<'_>) -> CleanedPoints {
        let mut positions: Vec<[f64; 3]> = (0..cloud.len()).map(|i| cloud.get(i)).collect();
        let mut removed = vec![true; cloud.len()];
        for (k, &i) in self.ids.iter().enumerate() {
            removed[i as usize] = self.found.inside.binary_search(&i).is_ok();
            if removed[i as usize] {
                continue;
            }
            if let Some(points) = &self.smoothed {
                positions[i as usize] = points[k].to_array();
            }
        }
        CleanedPoints { positions, removed }
    }

    /// The caller's grouping in the mesh's own numbers. Only a hole and the islands in it, and
    /// the two ends of a missing band, are joined: borders look at much that is not theirs.
    pub fn local_grouping(
        &self,
        mesh: MeshView<'_>,
        grouping: &Grouping,
        monitor: &Monitor,
    ) -> Result<Grouping> {
        let local = |v: &u32| {
            self.ids.binary_search(v).map(|i| i as u32).map_err(|_| Error::InvalidOption {
                name: "grouping",
                reason: format!("point {v} lies on no rim"),
            })
        };
        match grouping {
            Grouping::Separate => Ok(Grouping::Separate),
            Grouping::Join(lists) => {
                let lists: Result<Vec<Vec<u32>>> =
                    lists.iter().map(|list| list.iter().map(local).collect()).collect();
                lists.map(Grouping::Join)
            }
            Grouping::Automatic => {
                let list = find_holes(mesh, grouping, monitor)?;
                let known = self.known();
                let is_hole = |l: &usize| {
                    let rim = known.get(&list.loops[*l].vertices[..]);
                    rim.is_some_and(|r| r.kind == RimKind::Hole)
                };
                // Holes that see each other are two all the same.
                let groups = list.holes.iter().map(|h| {
                    let length = |i: usize| list.loops[h.loops[i]].length;
                    match h.kind {
                        // Of holes that were given, both ends were.
                        HoleKind::Ring
                            if length(1) > BAND * length(0)
                                && (!self.given || h.loops.iter().all(is_hole)) =>
                        {
                            h.loops.clone()
                        }
                        HoleKind::Islands if is_hole(&h.loops[0]) => h.loops.clone(),
                        _ => Vec::new(),
                    }
                });
                let first = |l: usize| list.loops[l].vertices[0];
                let lists = groups.filter(|g| g.len() > 1);
                Ok(Grouping::Join(lists.map(|g| g.into_iter().map(first).collect()).collect()))
            }
        }
    }

    /// The rims by their points.
    fn known(&self) -> HashMap<&[u32], &Rim> {
        self.rims.iter().map(|r| (&r.points[..], r)).collect()
    }

    /// The holes and borders in the caller's numbers, and for each its number among the mesh's: what
    /// is left of cracks is left out.
    pub fn holes(&self, list: &HoleList) -> (PointHoles, Vec<usize>) {
        let known = self.known();
        let mut found = self.found.clone();
        let mut numbers = Vec::new();
        for hole in &list.holes {
            let rims: Vec<&Rim> = hole
                .loops
                .iter()
                .filter_map(|&l| known.get(&list.loops[l].vertices[..]).copied())
                .collect();
            if rims.iter().all(|r| r.kind == RimKind::Crack) {
                continue;
            }
            let mut hole = hole.clone();
            numbers.push(hole.id);
            hole.id = found.list.holes.len();
            for l in &mut hole.loops {
                let mut shape = list.loops[*l].clone();
                shape.vertices.iter_mut().for_each(|v| *v = self.ids[*v as usize]);
                *l = found.list.loops.len();
                found.list.loops.push(shape);
            }
            found.list.holes.push(hole);
            let alone = rims.len() == 1 && rims[0].kind == RimKind::Border;
            found.borders.push(alone);
            found.missing_in.push(rims.iter().map(|r| r.missing).sum());
            let points: f64 = rims.iter().map(|r| r.points.len() as f64).sum();
            let sum: f64 = rims.iter().map(|r| r.probability * r.points.len() as f64).sum();
            found.probability.push(sum / points.max(1.0));
            found.in_loops.push(rims.iter().all(|r| r.in_loops));
            let in_field = rims.iter().map(|r| r.in_field).reduce(|a, b| Some(a? && b?));
            found.in_field.push(in_field.flatten());
        }
        (found, numbers)
    }

    /// The values of the mesh's vertices.
    pub fn appearance(
        &self,
        of: &Appearance,
        points: usize,
        sources: &Sources,
    ) -> Result<Appearance> {
        of.check(points, sources)?;
        let row = |&v: &u32| &of.values[v as usize * of.channels..][..of.channels];
        let values = self.ids.iter().flat_map(row).copied().collect();
        let exemplar_values = of.exemplar_values.clone();
        Ok(Appearance { values, exemplar_values, ..*of })
    }

    /// A completion of the mesh as one of the cloud.
    pub fn into_points(
        self,
        mut made: Completion,
        cloud: VertexView<'_>,
        found: PointHoles,
        numbers: &[usize],
    ) -> PointCompletion {
        let (old, new) = (self.ids.len() as u32, cloud.len() as u32);
        let number = |h: usize| numbers.iter().position(|&n| n == h).unwrap_or(usize::MAX);
        let source_points = made.origins.iter().map(|o| self.source_point(o)).collect();
        let origins = made.origins.clone();
        for o in &mut made.origins {
            *o = Origin { face: NONE, barycentric: [0.0; 3], ..*o };
        }
        let seams = made.holes.iter_mut().flat_map(|h| h.seams.iter_mut().chain(&mut h.ring));
        for v in made.faces.iter_mut().flatten().chain(seams.map(|s| &mut s.vertex)) {
            *v = if *v < old { self.ids[*v as usize] } else { *v - old + new };
        }
        made.vertex_hole
            .iter_mut()
            .chain(&mut made.face_hole)
            .for_each(|h| *h = number(*h as usize) as u32);
        made.holes.retain(|h| numbers.contains(&h.hole));
        for (id, report) in made.holes.iter_mut().enumerate() {
            report.hole = id;
            report.loops = found.list.holes[id].loops.clone();
            if let HoleStatus::Failed(Error::HoleFailed { hole, .. }) = &mut report.status {
                *hole = id;
            }
        }
        (made.input_vertex_count, made.input_face_count) = (cloud.len(), 0);
        let at = |v: u32| match (&self.smoothed, self.ids.binary_search(&v)) {
            (Some(points), Ok(i)) => points[i],
            _ => DVec3::from(cloud.get(v as usize)),
        };
        let normals = new_normals(&made, cloud.len() as u32, &at);
        let mut faces = self.faces;
        faces.iter_mut().flatten().for_each(|v| *v = self.ids[*v as usize]);
        let copied = Copied { faces, origins };
        let values = Vec::new();
        let cleaned = None;
        PointCompletion { completion: made, normals, source_points, values, copied, cleaned, found }
    }

    /// The input point nearest to an origin.
    fn source_point(&self, origin: &Origin) -> u32 {
        let Some(face) = self.faces.get(origin.face as usize) else { return NONE };
        let b = origin.barycentric;
        let k = (0..3).max_by(|&i, &j| b[i].total_cmp(&b[j]).then(j.cmp(&i))).unwrap_or(0);
        self.ids[face[k] as usize]
    }
}

/// Normals of the new points from the faces between them.
fn new_normals(made: &Completion, input: u32, at: &dyn Fn(u32) -> DVec3) -> Vec<[f64; 3]> {
    // Only the points that the fill touches, numbered anew.
    let mut rim: Vec<u32> = made.faces.iter().flatten().copied().filter(|&v| v < input).collect();
    rim.sort_unstable();
    rim.dedup();
    let new = made.vertices.len();
    let local = |v: u32| match v.checked_sub(input) {
        Some(i) => i,
        None => (new + rim.binary_search(&v).unwrap_or(0)) as u32,
    };
    let mut positions: Vec<DVec3> = made.vertices.iter().map(|&p| p.into()).collect();
    positions.extend(rim.iter().map(|&v| at(v)));
    let normals = vertex_normals(&positions, made.faces.iter().map(|f| f.map(local)));
    normals[..new].iter().map(|n| n.to_array()).collect()
}
