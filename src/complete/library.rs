//! What a coherent completion of a mesh copies from, its height maps by scale, and the searches made in
//! it: kept between the holes of a call, and between the calls of a completer.

use super::cost::LongCost;
use super::finished::Completions;
use super::guided::{guess_scales, Ranked, Transforms};
use super::harary::Initial;
use super::searches::Searches;
use crate::descriptor::voting::voted_curvatures;
use crate::error::Result;
use crate::matching::cloud::{Cloud, Thinned};
use crate::matching::maps::{
    centre_spacing, centres_on, cloud_at, cloud_scale, radius_at, scale_of, Maps,
};
use crate::matching::paint::Paint;
use crate::matching::rigid::Rigid;
use crate::matching::ring_pattern::Candidate;
use crate::matching::search::{find_candidates, Target};
use crate::matching::signature::Features;
use crate::matching::source::Source;
use crate::matching::symmetry::symmetries;
use crate::mesh::neighbourhood::NONE;
use crate::mesh::MeshView;
use crate::options::{Appearance, Sources};
use std::cell::Cell;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// What is made once a mesh and kept: what is known, what may be copied from, and its maps by scale.
#[derive(Clone)]
pub struct Library {
    /// The whole mesh, with the smooth completions of other holes.
    pub known: Source,
    /// What may be copied from, where that is not all of it.
    chosen: Option<Source>,
    /// Whether mirrored copies may be made.
    pub mirrored: bool,
    /// Scales at which the exemplars are as large as the mesh.
    pub guesses: Vec<f64>,
    /// What was made and found, for all holes.
    pub kept: Arc<Kept>,
}

/// What all holes share, made when one first asks for it.
#[derive(Default)]
pub struct Kept {
    maps: Mutex<BTreeMap<i32, Arc<Maps>>>,
    /// Of what is known, and of what was chosen.
    clouds: [Clouds; 2],
    /// On such a cloud of the source, so far apart.
    centres: Mutex<BTreeMap<(i32, u64), Arc<Thinned>>>,
    found: Searches<Found>,
    /// Searches among sources of other sizes.
    pub scaled: Searches<Transforms>,
    /// The candidates of a window, in order.
    pub ranked: Searches<Arc<Ranked>>,
    /// The same by [`crate::Method::Warp`].
    pub warped: Searches<Arc<Vec<Rigid>>>,
    /// Whole completions.
    pub finished: Completions,
    features: Mutex<BTreeMap<(), Arc<Described>>>,
    symmetries: Mutex<BTreeMap<(), Arc<Vec<Rigid>>>>,
}

/// By scale.
type Clouds = Arc<Mutex<BTreeMap<i32, Arc<Cloud>>>>;

/// What signatures are taken of: all that is known, and what was chosen of it and of exemplars.
pub struct Described {
    /// Of [`Library::known`].
    pub known: Features,
    /// Of [`Library::source`], where that is not all that is known.
    pub chosen: Option<Features>,
}

/// The candidates of each of some windows.
pub type Found = Arc<Vec<Vec<Candidate>>>;

impl Library {
    /// Of a mesh with these boundary vertices; maps are made when a hole first asks for them. `like`: one of the same
    /// mesh with the same colours, of other sources.
    pub fn new(
        mesh: MeshView<'_>,
        boundary: &[u32],
        sources: &Sources,
        appearance: Option<&Appearance>,
        like: Option<&Self>,
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<Self> {
        let rims = || boundary.iter().copied();
        let of_part = sources.faces.is_some() || sources.exemplar.is_some();
        let paint = appearance.and_then(Paint::new);
        let first = if of_part { 0.5 } else { 0.0 };
        let early = |part: f64| check(first * part);
        let late = |part: f64| check(first + (1.0 - first) * part);
        let chosen = of_part.then(|| Source::chosen(mesh, rims(), sources, &early)).transpose()?;
        let known = match like {
            Some(like) => like.known.clone(),
            None => Source::new(mesh, rims(), &late)?.painted(&paint),
        };
        let made = Self {
            guesses: guess_scales(known.area, sources.exemplar.as_deref()),
            known,
            chosen: chosen.map(|s| s.painted(&paint)),
            mirrored: !sources.unmirrored,
            kept: Arc::default(),
        };
        Ok(like.map_or(made.clone(), |like| made.beside(like)))
    }

    /// With what is kept of the same known surface.
    fn beside(self, other: &Self) -> Self {
        let clouds = [other.kept.clouds[0].clone(), Clouds::default()];
        Self { kept: Arc::new(Kept { clouds, ..Kept::default() }), ..self }
    }

    /// The same with mirrored copies or without.
    pub fn with_mirrored(&self, mirrored: bool) -> Self {
        Self { mirrored, ..self.clone() }.beside(self)
    }

    /// Of a mesh with completions of several of its holes, each with a number; each hole may copy from
    /// those of the others. See [`Library::for_hole`].
    pub fn completed(
        mesh: MeshView<'_>,
        boundary: &[u32],
        fills: &[(u32, Initial<'_>)],
        mirrored: bool,
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<Self> {
        let (vertices, faces) = (mesh.vertices.len(), mesh.faces.len());
        let mut positions: Vec<[f64; 3]> = (0..vertices).map(|v| mesh.vertices.get(v)).collect();
        let mut triangles: Vec<[u32; 3]> = (0..faces).map(|f| mesh.faces.get(f)).collect();
        let mut completion = vec![NONE; vertices];
        for &(hole, Initial { ref rim, patch, .. }) in fills {
            let first = positions.len() - patch.rim_count;
            let number = |v: u32| *rim.get(v as usize).unwrap_or(&(first as u32 + v));
            positions.extend(patch.positions[patch.rim_count..].iter().map(|p| p.to_array()));
            triangles.extend(patch.triangles.iter().map(|t| t.map(number)));
            completion.resize(positions.len(), hole);
            rim.iter().for_each(|&v| completion[v as usize] = hole);
        }
        let whole = MeshView::new(&positions[..], &triangles[..]);
        let rims = boundary.iter().copied();
        let known = Source::completed(whole, rims, completion, [vertices, faces], check)?;
        Ok(Self { guesses: Vec::new(), known, chosen: None, mirrored, kept: Arc::default() })
    }

    /// The same for one of its completions: that is nothing to copy from.
    pub fn for_hole(&self, own: u32) -> Self {
        Self { known: self.known.for_hole(own), ..self.clone() }
    }

    /// Whether all that is known may be copied from, and nothing else.
    pub fn is_whole(&self) -> bool {
        self.chosen.is_none()
    }

    /// What may be copied from.
    pub fn source(&self) -> &Source {
        self.chosen.as_ref().unwrap_or(&self.known)
    }

    /// A cloud of what is known (0) or was chosen (1).
    fn cloud(
        &self,
        source: &Source,
        kept: usize,
        radius: f64,
        check: &dyn Fn() -> Result<()>,
    ) -> Result<Arc<Cloud>> {
        let key = cloud_scale(source, radius);
        once(&self.kept.clouds[kept], key, || cloud_at(source, key, check))
    }

    fn maps(&self, radius: f64, check: &dyn Fn() -> Result<()>) -> Result<Arc<Maps>> {
        let edge = self.known.edge;
        let scale = scale_of(edge, radius);
        let radius = radius_at(edge, scale);
        let known = self.cloud(&self.known, 0, radius, check)?;
        let chosen = self.chosen.as_ref().map(|s| self.cloud(s, 1, radius, check)).transpose()?;
        let of_source = chosen.unwrap_or_else(|| known.clone());
        // An exemplar lies elsewhere.
        let symmetries =
            if self.is_whole() { self.symmetries(&|_| check())? } else { Arc::default() };
        once(&self.kept.maps, scale, || {
            let source = self.source();
            let spacing = centre_spacing(source, radius);
            // Small holes share them.
            let key = (cloud_scale(source, radius), spacing.to_bits());
            let make = || centres_on(&of_source, spacing, check);
            let centres = once(&self.kept.centres, key, make)?;
            let clouds = [of_source.clone(), known];
            let maps = Maps::new(source, radius, clouds, centres, self.mirrored);
            Ok(maps.with_symmetries(symmetries))
        })
    }

    /// What may carry the object onto itself.
    pub fn symmetries(&self, check: &dyn Fn(f64) -> Result<()>) -> Result<Arc<Vec<Rigid>>> {
        once(&self.kept.symmetries, (), || symmetries(&self.known, self.mirrored, check))
    }

    /// Maps of a source of another size, which are not kept.
    pub fn maps_of(
        &self,
        source: &Source,
        radius: f64,
        check: &dyn Fn() -> Result<()>,
    ) -> Result<Maps> {
        let edge = self.known.edge;
        let radius = radius_at(edge, scale_of(edge, radius));
        let known = self.cloud(&self.known, 0, radius, check)?;
        let own = Arc::new(cloud_at(source, cloud_scale(source, radius), check)?);
        let centres = Arc::new(centres_on(&own, centre_spacing(source, radius), check)?);
        Ok(Maps::new(source, radius, [own, known], centres, self.mirrored))
    }

    /// Curvatures and colours of the vertices, made when first asked for.
    pub fn features(
        &self,
        threads: usize,
        check: &dyn Fn() -> Result<()>,
    ) -> Result<Arc<Described>> {
        let of = |s: &Source| {
            let curvatures = voted_curvatures(&s.positions, &s.normals, &s.faces, threads, check)?;
            Ok::<_, crate::Error>(Features::new(s, &curvatures))
        };
        once(&self.kept.features, (), || {
            let chosen = self.chosen.as_ref().map(of).transpose()?;
            Ok(Described { known: of(&self.known)?, chosen })
        })
    }

    /// The candidates for some windows, which share one radius.
    pub fn candidates(
        &self,
        targets: &[Target<'_>],
        threads: usize,
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<Found> {
        let Some(first) = targets.first() else { return Ok(Found::default()) };
        self.kept.found.find(targets, None, || {
            // Windows share the maps.
            let maps_part = match targets.len() {
                1 => 0.1,
                n => {
                    let area = self.known.area / first.radius.powi(2);
                    LongCost::of(0, n, first.fill.len(), area).maps_part()
                }
            };
            // How often it will be asked is not known: half of it is over at the second time.
            let asked = Cell::new(0.0);
            let maps = self.maps(first.radius, &|| {
                asked.set(asked.get() + 1.0);
                check(maps_part * asked.get() / (asked.get() + 2.0))
            })?;
            check(maps_part)?;
            let late = |part: f64| check(maps_part + (1.0 - maps_part) * part);
            let (known, source) = (&self.known, self.source());
            find_candidates(known, source, &maps, targets, threads, &late).map(Arc::new)
        })
    }
}

/// What is kept under a key, made if it is not there: who comes later waits for the first.
fn once<K: Ord, T>(
    kept: &Mutex<BTreeMap<K, Arc<T>>>,
    key: K,
    make: impl FnOnce() -> Result<T>,
) -> Result<Arc<T>> {
    let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(found) = kept.get(&key) {
        return Ok(found.clone());
    }
    let made = Arc::new(make()?);
    kept.insert(key, made.clone());
    Ok(made)
}
