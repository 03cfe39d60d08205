//! The gap between the rim and a part, closed by a smooth fill of what is around it.

use super::cut::Cut;
use super::Wanted;
use crate::complete::check::{Obstacles, Rounding};
use crate::complete::smooth::{fill_hole, Spreading, Surroundings};
use crate::error::Result;
use crate::fill::sheet::Incidences;
use crate::mesh::neighbourhood::{Bounds, FacePlaces, Neighbourhood, Positions};
use crate::options::{Fairing, Sizing};
use glam::DVec3;

/// New vertices and faces of a gap, numbered after the mesh and the part.
pub type Gap = (Vec<DVec3>, Vec<[u32; 3]>);

/// What is known around one rim: the same for all places that are tried.
pub struct Shore {
    vertices: Vec<u32>,
    positions: Vec<DVec3>,
    faces: Vec<[u32; 3]>,
}

impl Shore {
    /// The faces of the neighbourhood that meet a box.
    pub fn new(around: &Surroundings<'_>, reach: &Bounds) -> Self {
        let near = around.near;
        let faces = around.places.meeting(near, reach);
        let corners = || faces.iter().map(|&f| near.faces[f as usize]);
        let mut local: Vec<u32> = corners().flatten().collect();
        local.sort_unstable();
        local.dedup();
        let number = |v: u32| local.partition_point(|&w| w < v) as u32;
        Self {
            faces: corners().map(|f| f.map(number)).collect(),
            vertices: local.iter().map(|&v| near.vertices[v as usize]).collect(),
            positions: local.iter().map(|&v| near.positions.get(v)).collect(),
        }
    }

    /// With a part, whose vertices are numbered from `input` on.
    fn with(&self, cut: &Cut, input: u32) -> Neighbourhood {
        let first = self.vertices.len() as u32;
        let numbers = input..input + cut.positions.len() as u32;
        let of_part = cut.faces.iter().map(|f| f.map(|v| v + first));
        Neighbourhood {
            vertices: self.vertices.iter().copied().chain(numbers).collect(),
            positions: Positions::Double([&self.positions[..], &cut.positions].concat()),
            faces: self.faces.iter().copied().chain(of_part).collect(),
            loose: Vec::new(),
        }
    }
}

/// What lies between the rim and the part: smooth fills of a mesh that has the part already. Only what is
/// around them is looked at: the whole fill is tested against the whole mesh at its end.
pub fn close_gap(
    around: &Surroundings<'_>,
    wanted: &Wanted<'_>,
    cut: &Cut,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<std::result::Result<Gap, String>> {
    let input = around.input_vertices as u32;
    let near = wanted.shore.with(cut, input);
    let local = Surroundings {
        initial: None,
        input_vertices: around.input_vertices + cut.positions.len(),
        spreading: Spreading::Never,
        near: &near,
        incidence: &Incidences::new(&near),
        places: &FacePlaces::new(&near, 1),
        fairing: Fairing::C1,
        sizing: Sizing::Surroundings,
        // As the part: rounded with it.
        rounding: Rounding::Double,
    };
    let everywhere = [Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY }];
    let Some(pairs) = pair_loops(wanted, cut, &near, input) else {
        return Ok(Err("its part has too few borders".into()));
    };
    let (mut vertices, mut faces, mut others) = (Vec::new(), Vec::new(), Vec::new());
    let count = pairs.len() as f64;
    for (i, loops) in pairs.iter().enumerate() {
        let part = |part: f64| check((i as f64 + part) / count);
        let obstacles = Obstacles { mesh: wanted.mesh, covered: &everywhere, others: &others };
        let fill = match fill_hole(&local, loops, &obstacles, &part)? {
            Ok(fill) => fill,
            Err(why) => return Ok(Err(format!("between its rim and its part: {why}"))),
        };
        let (patch, rim) = (&fill.patch, fill.patch.rim_count);
        let first = (local.input_vertices + vertices.len()) as u32;
        let index = |v: u32| match (v as usize).checked_sub(rim) {
            Some(new) => first + new as u32,
            None => near.vertices[fill.outline.vertices[v as usize] as usize],
        };
        faces.extend(patch.triangles.iter().map(|t| t.map(index)));
        vertices.extend_from_slice(&patch.positions[rim..]);
        others.extend(patch.triangles.iter().map(|t| t.map(|v| patch.p(v))));
    }
    Ok(Ok((vertices, faces)))
}

/// Each loop of the rim with the border of the part that is nearest to it, the longer one first, in
/// vertices of the neighbourhood; `None` if there are too few borders.
fn pair_loops(
    wanted: &Wanted<'_>,
    cut: &Cut,
    near: &Neighbourhood,
    input: u32,
) -> Option<Vec<[Vec<u32>; 2]>> {
    let local = |l: &Vec<u32>| l.iter().map(|&v| near.local(v)).collect::<Option<Vec<u32>>>();
    let rims: Vec<Vec<u32>> = wanted.rim.iter().map(local).collect::<Option<_>>()?;
    // A fill runs against its surroundings, as the loops of the rim do.
    let against = |l: &Vec<u32>| {
        let rest = l[1..].iter().rev();
        l[..1].iter().chain(rest).map(|&v| near.local(v + input)).collect::<Option<Vec<u32>>>()
    };
    let mut left: Vec<Vec<u32>> = cut.loops.iter().map(against).collect::<Option<_>>()?;
    let at = |v: u32| near.positions.get(v);
    let middle = |l: &[u32]| l.iter().map(|&v| at(v)).sum::<DVec3>() / l.len() as f64;
    let length = |l: &[u32]| -> f64 {
        (0..l.len()).map(|i| at(l[i]).distance(at(l[(i + 1) % l.len()]))).sum()
    };
    let mut pairs = Vec::new();
    for rim in rims {
        let off = |l: &Vec<u32>| middle(l).distance_squared(middle(&rim));
        let k = (0..left.len()).min_by(|&a, &b| off(&left[a]).total_cmp(&off(&left[b])))?;
        let border = left.swap_remove(k);
        let pair = if length(&border) > length(&rim) { [border, rim] } else { [rim, border] };
        pairs.push(pair);
    }
    pairs.sort_by_key(|[a, b]| a[0].min(b[0]));
    Some(pairs)
}
