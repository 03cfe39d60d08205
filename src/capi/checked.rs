//! The options of C as those of Rust, every number checked.

use super::arrays::{array, corners, points};
use super::error::{Failure, Status};
use super::options::{flag, unknown, COptions};
use crate::options::{
    Appearance, Cleaning, Exemplar, Fairing, GivenHole, Grouping, Initial, Method, Options,
    Selection, Sizing, Sources,
};
use std::sync::Arc;

/// More threads than any machine has cores for one call; a garbage number would start them all.
const MAX_THREADS: u32 = 1024;

impl COptions {
    /// The same options for Rust, every number checked. The counts are the mesh's.
    ///
    /// # Safety
    /// The arrays are as long as their counts say.
    pub(super) unsafe fn checked(
        &self,
        vertex_count: usize,
        face_count: usize,
    ) -> Result<Options, Failure> {
        if self.threads > MAX_THREADS {
            return Err(Failure::new(
                Status::InvalidOption,
                format!("option threads: {} is more than {MAX_THREADS}", self.threads),
            ));
        }
        Ok(Options {
            // SAFETY: by the contract of this function.
            appearance: unsafe { self.appearance(vertex_count) }?,
            method: match self.method {
                0 => Method::Smooth,
                1 => Method::Coherent,
                2 => Method::Harary,
                3 => Method::Fragment,
                4 => Method::Warp,
                other => return Err(unknown("method", other, "complete_mesh_method")),
            },
            fairing: *Fairing::ALL
                .get(self.fairing as usize)
                .ok_or_else(|| unknown("fairing", self.fairing, "complete_mesh_fairing"))?,
            sizing: match self.sizing {
                0 => Sizing::Surroundings,
                1 => Sizing::Scaled(self.sizing_value),
                2 => Sizing::EdgeLength(self.sizing_value),
                3 => Sizing::None,
                other => return Err(unknown("sizing", other, "complete_mesh_sizing")),
            },
            // SAFETY: the caller of this function answers for the arrays.
            grouping: unsafe { self.grouping() }?,
            // SAFETY: as above.
            selection: unsafe { self.selection() }?,
            skip_unsafe: flag("skip_unsafe", self.skip_unsafe)?,
            // SAFETY: as above.
            initial: unsafe { self.initial() }?,
            // SAFETY: as above.
            sources: unsafe { self.sources(face_count) }?,
            // SAFETY: as above.
            guidance: unsafe { self.guidance() }?,
            clean: flag("clean", self.clean)?
                .then_some(Cleaning { rounds: self.clean_rounds as usize }),
            // SAFETY: as above.
            given_holes: unsafe { self.given_holes() }?,
            threads: self.threads as usize,
        })
    }

    unsafe fn sources(&self, face_count: usize) -> Result<Sources, Failure> {
        let faces = match self.source_faces.is_null() {
            true => None,
            false => {
                // SAFETY: the caller of `checked` answers for the array.
                let bytes = unsafe { array("source_faces", self.source_faces, face_count) }?;
                Some(bytes.iter().map(|&b| b != 0).collect())
            }
        };
        let exemplar = match self.exemplar_face_count {
            0 => None,
            triangles => {
                let (vertices, count) = (self.exemplar_vertices, self.exemplar_vertex_count);
                // SAFETY: the caller of `checked` answers for the arrays.
                let vertices =
                    unsafe { points("exemplar_vertices", vertices, count, self.single()?) }?;
                // SAFETY: as above.
                let faces = unsafe { corners("exemplar_faces", self.exemplar_faces, triangles) }?;
                let (sizes, count) = (self.exemplar_parts, self.exemplar_part_count);
                // SAFETY: as above.
                let sizes = unsafe { array("exemplar_parts", sizes, count) }?;
                let parts = sizes.iter().map(|&n| n as usize).collect();
                Some(Arc::new(Exemplar { vertices, faces, parts }))
            }
        };
        Ok(Sources {
            faces,
            exemplar,
            exemplar_only: flag("exemplar_only", self.exemplar_only)?,
            unmirrored: flag("unmirrored", self.unmirrored)?,
        })
    }

    unsafe fn initial(&self) -> Result<Option<Arc<Initial>>, Failure> {
        if self.initial_face_count == 0 {
            return Ok(None);
        }
        let (vertices, count) = (self.initial_vertices, self.initial_vertex_count);
        // SAFETY: the caller of `checked` answers for the arrays.
        let vertices = unsafe { points("initial_vertices", vertices, count, self.single()?) }?;
        let triangles = self.initial_face_count;
        // SAFETY: as above.
        let faces = unsafe { corners("initial_faces", self.initial_faces, triangles) }?;
        Ok(Some(Arc::new(Initial { vertices, faces })))
    }

    unsafe fn appearance(&self, vertices: usize) -> Result<Option<Arc<Appearance>>, Failure> {
        let (channels, steering) = (self.value_channels as usize, self.steering_channels as usize);
        let nothing = self.vertex_values.is_null() && self.exemplar_values.is_null();
        if nothing && channels == 0 && steering == 0 {
            return Ok(None);
        }
        let count = |vertices: usize| vertices.saturating_mul(channels);
        // SAFETY: the caller of `checked` answers for the arrays.
        let values = unsafe { array("vertex_values", self.vertex_values, count(vertices)) }?;
        let exemplar_values = match self.exemplar_values.is_null() {
            true => Vec::new(),
            // SAFETY: as above.
            false => unsafe {
                let count = count(self.exemplar_vertex_count);
                array("exemplar_values", self.exemplar_values, count)
            }?,
        };
        Ok(Some(Arc::new(Appearance { channels, steering, values, exemplar_values })))
    }

    unsafe fn selection(&self) -> Result<Selection, Failure> {
        // SAFETY: the caller of `checked` answers for the array.
        let ids = || unsafe { array("selection_ids", self.selection_ids, self.selection_count) };
        Ok(match self.selection {
            0 => Selection::All,
            1 => Selection::Ids(ids()?.iter().map(|&id| id as usize).collect()),
            2 => Selection::MaxEdges(self.selection_max_edges),
            3 => Selection::MaxCircumference(self.selection_length),
            4 => Selection::MaxDiameter(self.selection_length),
            5 => Selection::AllButLargest,
            6 => Selection::NearPoint(self.selection_point),
            7 => Selection::NearVertices(ids()?),
            other => return Err(unknown("selection", other, "complete_mesh_selection")),
        })
    }

    unsafe fn grouping(&self) -> Result<Grouping, Failure> {
        match self.grouping {
            0 => Ok(Grouping::Automatic),
            1 => Ok(Grouping::Separate),
            2 => {
                let names = ["join_sizes", "join_vertices"];
                // SAFETY: the caller of `checked` answers for the arrays.
                let lists =
                    unsafe { lists(names, self.join_sizes, self.join_count, self.join_vertices) }?;
                Ok(Grouping::Join(lists))
            }
            other => Err(unknown("grouping", other, "complete_mesh_grouping")),
        }
    }

    unsafe fn given_holes(&self) -> Result<Vec<GivenHole>, Failure> {
        let names = ["given_loop_sizes", "given_loop_points"];
        let (sizes, count) = (self.given_loop_sizes, self.given_loop_count);
        // SAFETY: the caller of `checked` answers for the arrays.
        let loops = unsafe { lists(names, sizes, count, self.given_loop_points) }?;
        let numbers = self.given_region_count.saturating_mul(4);
        // SAFETY: as above.
        let regions = unsafe { array("given_regions", self.given_regions, numbers) }?;
        let region = |r: &[f64]| GivenHole::Region { centre: [r[0], r[1], r[2]], radius: r[3] };
        let loops = loops.into_iter().map(GivenHole::Loop);
        Ok(loops.chain(regions.chunks_exact(4).map(region)).collect())
    }
}

/// Lists of indices that stand one after the other. `names`: of the sizes and of the numbers.
///
/// # Safety
/// There are `count` sizes, and as many numbers as they say.
unsafe fn lists(
    names: [&'static str; 2],
    sizes: *const u32,
    count: usize,
    numbers: *const u32,
) -> Result<Vec<Vec<u32>>, Failure> {
    // SAFETY: by the contract of this function.
    let sizes = unsafe { array(names[0], sizes, count) }?;
    let total = sizes.iter().fold(0usize, |sum, &s| sum.saturating_add(s as usize));
    // SAFETY: as above.
    let numbers = unsafe { array(names[1], numbers, total) }?;
    let mut rest = &numbers[..];
    let mut next = |&size: &u32| {
        let (list, after) = rest.split_at(size as usize);
        rest = after;
        list.to_vec()
    };
    Ok(sizes.iter().map(&mut next).collect())
}
