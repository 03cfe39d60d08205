//! What the caller may choose. Every default is what a user who knows nothing should get.

use crate::error::{Error, Result};
use crate::guidance::Guidance;
use std::sync::Arc;

/// How a fill is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Method {
    /// The smooth completion: triangulation, refinement, fairing. See [`Fairing`].
    Smooth,
    /// Coherent completion (Harary, Tal, Grinspun 2014): continues what the object shows. A hole
    /// for which nothing on the object serves gets the smooth completion, and its
    /// [`crate::HoleReport::method`] says so.
    #[default]
    Coherent,
    /// Coherent completion as Harary, Tal and Grinspun (2014) describe it, step by step, to compare
    /// with. Slower than [`Method::Coherent`]; see `docs/harary.md`.
    Harary,
    /// Fragment-based inpainting (Bendels, Schnabel, Klein 2005): copies of fragments of the object,
    /// scale by scale. See `docs/fragment.md`.
    Fragment,
    /// Completion for shape and appearance (Park, Guo, Shin, Qin 2006): the patch whose surroundings are the
    /// most similar is warped into the hole. See `docs/warp.md`.
    Warp,
}

impl Method {
    /// The name in the command line, the report and the C header.
    pub fn name(self) -> &'static str {
        match self {
            Method::Smooth => "smooth",
            Method::Coherent => "coherent",
            Method::Harary => "harary",
            Method::Fragment => "fragment",
            Method::Warp => "warp",
        }
    }
}

/// How a copy of a point cloud is cleaned before it is completed (Park et al. 2006, Sec. 4): points beside
/// the surface and doubles go, noise is smoothed. The input stays what it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cleaning {
    /// Times that noise is smoothed, up to 100; each time about half of what is left goes, and relief
    /// below two spacings with it. 0: nothing is moved.
    pub rounds: usize,
}

impl Default for Cleaning {
    /// Three rounds: noise of 0.3 spacings falls below 0.1.
    fn default() -> Self {
        Self { rounds: 3 }
    }
}

/// A hole of a point cloud that the caller gives.
#[derive(Debug, Clone, PartialEq)]
pub enum GivenHole {
    /// Indices of three or more points around it, in order, either way round. Where the surface through the
    /// points has no edge between two of them the loop follows its rims and edges, without a detour. Inside is
    /// the smaller part; points there stay, and are not looked at.
    Loop(Vec<u32>),
    /// A ball: the holes whose rims lie in it; if there are none, the largest gap that shows.
    Region {
        /// In cloud units.
        centre: [f64; 3],
        /// In cloud units, greater than 0.
        radius: f64,
    },
}

/// The smooth surface that a hole is filled with. A coherent or warped fill has it where nothing serves, leans on it
/// where copies are doubted, and heeds it not at all where they are trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Fairing {
    /// The best of the others for this hole, chosen by what the surroundings show (`docs/smooth.md`).
    #[default]
    Auto,
    /// No fairing: the refined triangulation as it is.
    None,
    /// Membrane, L x = 0: meets the rim, with a crease (C0).
    C0,
    /// Thin plate, L M⁻¹ L x = 0: continues the tangent planes at the rim (C1).
    C1,
    /// Triharmonic, L M⁻¹ L M⁻¹ L x = 0: continues the curvature, too (C2).
    C2,
    /// Least-squares mesh (Sorkine and Cohen-Or 2004): uniform Laplacian of the fill and of a band
    /// of the surroundings, whose vertices are soft constraints.
    LeastSquares,
    /// Thin plate through the smoothed surroundings: continues their shape, not their roughness.
    SmoothedPlate,
}

impl Fairing {
    /// The name in the command line and the report.
    pub fn name(self) -> &'static str {
        match self {
            Fairing::Auto => "auto",
            Fairing::None => "none",
            Fairing::C0 => "c0",
            Fairing::C1 => "c1",
            Fairing::C2 => "c2",
            Fairing::LeastSquares => "least-squares",
            Fairing::SmoothedPlate => "smoothed-plate",
        }
    }
    /// All values, in the order of their C constants.
    pub const ALL: [Fairing; 7] = [
        Fairing::Auto,
        Fairing::None,
        Fairing::C0,
        Fairing::C1,
        Fairing::C2,
        Fairing::LeastSquares,
        Fairing::SmoothedPlate,
    ];
}

/// Which boundary loops make one hole together.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Grouping {
    /// Loops that face each other belong together: islands, rings. See [`crate::holes`].
    #[default]
    Automatic,
    /// Every loop is a hole of its own.
    Separate,
    /// Loops named by any of their vertices belong together, one list a hole; all others are
    /// holes of their own.
    Join(Vec<Vec<u32>>),
}

/// Which holes are filled.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub enum Selection {
    /// Every hole.
    #[default]
    All,
    /// The holes with these ids (see [`crate::Hole::id`]).
    Ids(Vec<usize>),
    /// Holes whose loops have at most this many edges together.
    MaxEdges(usize),
    /// Holes whose loops are at most this long together, in mesh units.
    MaxCircumference(f64),
    /// Holes that fit into this diameter, in mesh units.
    MaxDiameter(f64),
    /// All but the hole with the longest loop: an open scan's own border.
    AllButLargest,
    /// The one hole whose rim passes nearest to this point, in mesh units.
    NearPoint([f64; 3]),
    /// The one hole whose rim passes nearest to these vertices' positions; holes whose rim
    /// contains one of them all count.
    NearVertices(Vec<u32>),
}

/// The edge length that new triangles aim for.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Sizing {
    /// The edge length of the surroundings, carried inward from the rim.
    #[default]
    Surroundings,
    /// The same, times this factor (0.05 to 20).
    Scaled(f64),
    /// One edge length everywhere, in mesh units.
    EdgeLength(f64),
    /// No refinement: the rim is triangulated, no vertex is added (but where the contract needs one).
    None,
}

/// What a coherent completion may copy from: by default the whole mesh that it fills.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sources {
    /// Of each face of the mesh whether it may be copied from; `None`: all.
    pub faces: Option<Arc<[bool]>>,
    /// Another mesh to copy from, in any position: an intact twin, the other half of a pair.
    pub exemplar: Option<Arc<Exemplar>>,
    /// Copy from the exemplar alone.
    pub exemplar_only: bool,
    /// Copy nothing mirrored.
    pub unmirrored: bool,
}

/// What the vertices carry besides their place: colours, any numbers. They are completed with the shape,
/// from the same sources, and the first of them help to find the sources.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Appearance {
    /// How many numbers a vertex has.
    pub channels: usize,
    /// How many of them, from the first on, steer the search: 3 for red, green and blue, 0 for none.
    /// Their unit does not matter, but it is one.
    pub steering: usize,
    /// The numbers of each vertex of the mesh, one vertex after the other; finite.
    pub values: Vec<f64>,
    /// The same of the exemplar; empty: not known.
    pub exemplar_values: Vec<f64>,
}

impl Appearance {
    /// Checks the lists against a mesh of so many vertices.
    pub(crate) fn check(&self, vertices: usize, sources: &Sources) -> Result<()> {
        let bad = |reason: String| Err(Error::InvalidOption { name: "appearance", reason });
        if self.channels == 0 || self.steering > self.channels {
            let Self { channels, steering, .. } = self;
            return bad(format!("{channels} channels, of which {steering} steer"));
        }
        let others = sources.exemplar.as_ref().map_or(0, |e| e.vertices.len());
        for (values, vertices) in [(&self.values, vertices), (&self.exemplar_values, others)] {
            let missing = values.is_empty() && std::ptr::eq(values, &self.exemplar_values);
            if !missing && Some(values.len()) != vertices.checked_mul(self.channels) {
                let (n, channels) = (values.len(), self.channels);
                return bad(format!("{n} values for {vertices} vertices of {channels} channels"));
            }
            if let Some(i) = values.iter().position(|x| !x.is_finite()) {
                return bad(format!("a value of vertex {} is not finite", i / self.channels));
            }
        }
        Ok(())
    }
}

/// A mesh that is copied from and does not become part of the result. Its scale is that of the mesh
/// that is filled.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Exemplar {
    /// Positions, in mesh units.
    pub vertices: Vec<[f64; 3]>,
    /// Three vertex indices each, counter-clockwise seen from outside.
    pub faces: Vec<[u32; 3]>,
    /// How many vertices each of several meshes has, one after the other in the lists: each may lie
    /// anywhere, on top of another, too. Empty: they are one.
    pub parts: Vec<usize>,
}

impl Exemplar {
    /// Several exemplars in one, in their order.
    pub fn joined(all: &[Exemplar]) -> Self {
        let mut joined = Self::default();
        for one in all {
            let first = joined.vertices.len() as u32;
            joined.vertices.extend_from_slice(&one.vertices);
            joined.faces.extend(one.faces.iter().map(|f| f.map(|v| v.saturating_add(first))));
            match one.parts.is_empty() {
                true => joined.parts.push(one.vertices.len()),
                false => joined.parts.extend_from_slice(&one.parts),
            }
        }
        joined
    }

    fn check_parts(&self) -> std::result::Result<(), String> {
        if self.parts.is_empty() {
            return Ok(());
        }
        let sum = self.parts.iter().fold(0usize, |sum, &n| sum.saturating_add(n));
        if sum != self.vertices.len() {
            let n = self.vertices.len();
            return Err(format!("the exemplar's parts have {sum} vertices, but it has {n}"));
        }
        let part = |v: u32| self.part_of(v);
        let whole = |f: &[u32; 3]| part(f[0]) == part(f[1]) && part(f[0]) == part(f[2]);
        if let Some(f) = self.faces.iter().position(|f| !whole(f)) {
            return Err(format!("the exemplar's face {f} joins two parts"));
        }
        match self.faces.windows(2).position(|f| part(f[0][0]) > part(f[1][0])) {
            Some(f) => Err(format!("the exemplar's face {} is not in its part's place", f + 1)),
            None => Ok(()),
        }
    }

    /// The part that a vertex belongs to.
    pub(crate) fn part_of(&self, vertex: u32) -> usize {
        let mut last = 0;
        let beyond = |&n: &usize| {
            last += n;
            last > vertex as usize
        };
        self.parts.iter().position(beyond).unwrap_or(0)
    }
}

impl Sources {
    /// Whether anything differs from the default.
    pub fn are_chosen(&self) -> bool {
        self.faces.is_some() || self.exemplar.is_some() || self.unmirrored
    }

    /// Checks the lists against a mesh of so many faces.
    pub(crate) fn check(&self, faces: usize) -> Result<()> {
        let bad = |reason: String| Err(Error::InvalidOption { name: "sources", reason });
        if let Some(chosen) = &self.faces {
            if chosen.len() != faces {
                return bad(format!("{} entries for {faces} faces", chosen.len()));
            }
            if !self.exemplar_only && !chosen.contains(&true) {
                return bad("no face may be copied from: choose at least one".into());
            }
        }
        let Some(exemplar) = &self.exemplar else {
            return match self.exemplar_only {
                true => bad("the exemplar alone shall be copied from, but there is none".into()),
                false => Ok(()),
            };
        };
        if exemplar.faces.is_empty() {
            return bad("the exemplar has no faces".into());
        }
        let finite = |v: &[f64; 3]| v.iter().all(|x| x.is_finite());
        if let Some(v) = exemplar.vertices.iter().position(|v| !finite(v)) {
            return bad(format!("the exemplar's vertex {v} is not finite"));
        }
        let inside = |f: &[u32; 3]| f.iter().all(|&v| (v as usize) < exemplar.vertices.len());
        if let Some(f) = exemplar.faces.iter().position(|f| !inside(f)) {
            return bad(format!("the exemplar's face {f} names a vertex that does not exist"));
        }
        exemplar.check_parts().or_else(bad)
    }
}

/// An initial completion made elsewhere, numbered as a [`crate::Completion`] is: new vertices follow
/// the mesh's.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Initial {
    /// Positions of the new vertices, in mesh units.
    pub vertices: Vec<[f64; 3]>,
    /// The new faces, counter-clockwise seen from outside.
    pub faces: Vec<[u32; 3]>,
}

impl Initial {
    /// Checks the lists against a mesh of so many vertices.
    pub(crate) fn check(&self, mesh_vertices: usize) -> Result<()> {
        let bad = |reason: String| Err(Error::InvalidOption { name: "initial", reason });
        let finite = |v: &[f64; 3]| v.iter().all(|x| x.is_finite());
        if let Some(v) = self.vertices.iter().position(|v| !finite(v)) {
            return bad(format!("the new vertex {v} is not finite"));
        }
        let count = mesh_vertices + self.vertices.len();
        let inside = |f: &[u32; 3]| f.iter().all(|&v| (v as usize) < count);
        match self.faces.iter().position(|f| !inside(f)) {
            Some(f) => bad(format!("the new face {f} names a vertex that does not exist")),
            None => Ok(()),
        }
    }
}

/// Options of [`crate::complete_mesh`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Options {
    /// How the fill is made.
    pub method: Method,
    /// Which holes are filled.
    pub selection: Selection,
    /// Which loops make one hole.
    pub grouping: Grouping,
    /// The smooth surface; `Auto` by default.
    pub fairing: Fairing,
    /// The size of the new triangles.
    pub sizing: Sizing,
    /// What holes are filled with to start from; `None`: a smooth completion is made. A hole that it
    /// does not fill, as the contract asks, fails. With `Method::Smooth` it is the result.
    pub initial: Option<Arc<Initial>>,
    /// What may be copied from. Only `Method::Coherent` and `Method::Warp` can be told; `Method::Fragment`
    /// heeds `unmirrored`.
    pub sources: Sources,
    /// Where to copy from, given by hand. Only `Method::Coherent` and, but for `scales`, `Method::Warp` can be
    /// told.
    pub guidance: Guidance,
    /// What the vertices carry; its first channels help `Method::Coherent` and `Method::Warp` to find the
    /// sources.
    pub appearance: Option<Arc<Appearance>>,
    /// Of a point cloud: complete a cleaned copy of it; `None`: the points as they are. A mesh is refused.
    pub clean: Option<Cleaning>,
    /// Of a point cloud: these are its holes, and no others are looked for; empty: they are found. A mesh is
    /// refused.
    pub given_holes: Vec<GivenHole>,
    /// Fill the other holes when a selected one is unsafe or fails, and say so in its
    /// [`crate::HoleReport`]; by default such a hole is an error for the whole call.
    pub skip_unsafe: bool,
    /// Worker threads; 0: as many as the machine has cores. The result does not depend on it.
    pub threads: usize,
}

impl Options {
    /// With what the guidance says of the sources: a placement is one of the exemplar alone.
    pub(crate) fn guided(&self) -> Self {
        let mut options = self.clone();
        if self.guidance.placement.is_some() {
            options.sources.exemplar_only |= self.sources.exemplar.is_some();
            // All parts are placed together, as they lie.
            if let Some(exemplar) =
                options.sources.exemplar.as_mut().filter(|e| !e.parts.is_empty())
            {
                *exemplar = Arc::new(Exemplar { parts: Vec::new(), ..(**exemplar).clone() });
            }
        }
        options
    }

    /// Checks every range. Called by every completion.
    pub fn check(&self) -> Result<()> {
        let bad = |name, reason: String| Err(Error::InvalidOption { name, reason });
        match self.sizing {
            Sizing::Scaled(f) if !(0.05..=20.0).contains(&f) => {
                return bad("sizing", format!("the factor {f} is outside 0.05 to 20"))
            }
            Sizing::EdgeLength(l) if !(l > 0.0 && l.is_finite()) => {
                return bad("sizing", format!("the edge length {l} is not positive"))
            }
            _ => {}
        }
        if let Some(Cleaning { rounds }) = self.clean.filter(|c| c.rounds > 100) {
            return bad("clean", format!("{rounds} rounds are more than 100"));
        }
        if self.method == Method::Harary && self.sources.are_chosen() {
            return bad("sources", "the method harary copies from the whole mesh".into());
        }
        self.guidance.check(self.method)?;
        if self.guidance.part && self.initial.is_some() {
            return bad(
                "part",
                "an initial completion has its own faces: leave one of the two".into(),
            );
        }
        let Sources { faces, exemplar, .. } = &self.sources;
        if self.method == Method::Fragment && (faces.is_some() || exemplar.is_some()) {
            return bad("sources", "the method fragment copies from the whole mesh".into());
        }
        match &self.selection {
            Selection::MaxCircumference(l) | Selection::MaxDiameter(l)
                if l.is_nan() || *l <= 0.0 =>
            {
                bad("selection", format!("the length {l} is not positive"))
            }
            Selection::NearPoint(p) if p.iter().any(|x| !x.is_finite()) => {
                bad("selection", "the point is not finite".into())
            }
            _ => Ok(()),
        }
    }
}
