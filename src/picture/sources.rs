//! Where a fill comes from, in colour: the fill by its sources, and the places on the object in the
//! same colours, as in Fig. 12 and 14 of Harary et al. 2014.

use super::{font, Image};
use crate::mesh::MeshView;
use crate::result::{Completion, HoleReport, HoleStatus, NONE};

/// Told apart from each other, from clay and from slate, also by those who see red and green
/// alike (after Okabe and Ito 2008).
const PALETTE: [[u8; 3]; 7] = [
    [0, 158, 115],
    [204, 60, 140],
    [240, 228, 66],
    [120, 60, 160],
    [86, 180, 233],
    [200, 60, 0],
    [0, 114, 178],
];
/// A fill, or a part of one, that no source stands behind.
const NO_SOURCE: [u8; 3] = [150, 150, 150];
/// Sources of a hole that the legend lists.
const LISTED: usize = 5;
/// Gaps between marked faces that are closed, in rounds of one ring: a fill has about as many
/// vertices as its source, so that some of the source's faces are hit by none.
const CLOSING: usize = 2;
/// Width of a colour sample in the legend, in pixels.
const SAMPLE: usize = 28;

/// The colours of one picture.
pub(super) struct Colours {
    /// Of each face of the completed mesh.
    pub tints: Vec<Option<[u8; 3]>>,
    /// By hole and source: those that gave detail.
    of_source: Vec<Vec<Option<[u8; 3]>>>,
}

impl Colours {
    /// Of a completed mesh. Holes named first get the first colours.
    pub fn new(after: MeshView<'_>, completion: &Completion, first: &[usize]) -> Self {
        let mut colours = Self {
            tints: vec![None; after.faces.len()],
            of_source: completion.holes.iter().map(|h| vec![None; h.sources.len()]).collect(),
        };
        let rest = (0..completion.holes.len()).filter(|h| !first.contains(h));
        let mut next = PALETTE.iter().cycle();
        for h in first.iter().copied().chain(rest) {
            let Some(hole) = completion.holes.get(h) else { continue };
            for s in by_use(completion, hole) {
                colours.of_source[h][s] = next.next().copied();
            }
        }
        colours.tint_fill(completion);
        colours.tint_sources(after, completion);
        colours
    }

    fn of_vertex(&self, completion: &Completion, new: usize) -> Option<[u8; 3]> {
        let (hole, origin) = (*completion.vertex_hole.get(new)?, completion.origins.get(new)?);
        *self.of_source.get(hole as usize)?.get(origin.source as usize)?
    }

    fn tint_fill(&mut self, completion: &Completion) {
        let of_source =
            |h: &HoleReport| by_use(completion, h).first().and_then(|&s| self.of_source[h.hole][s]);
        let main: Vec<Option<[u8; 3]>> = completion.holes.iter().map(of_source).collect();
        for (i, face) in completion.faces.iter().enumerate() {
            let mut new = face
                .iter()
                .filter_map(|&v| (v as usize).checked_sub(completion.input_vertex_count));
            let coloured = new.clone().find_map(|v| self.of_vertex(completion, v));
            // Between rim vertices there is no detail: the hole's main colour.
            let whole = || *main.get(completion.face_hole[i] as usize)?;
            let colour = if new.next().is_none() { whole() } else { coloured };
            let at = completion.input_face_count + i;
            if let Some(tint) = self.tints.get_mut(at) {
                *tint = Some(colour.unwrap_or(NO_SOURCE));
            }
        }
    }

    fn tint_sources(&mut self, after: MeshView<'_>, completion: &Completion) {
        let input = completion.input_face_count.min(after.faces.len());
        let mut marks: Vec<Option<[u8; 3]>> = vec![None; after.vertices.len()];
        for (i, origin) in completion.origins.iter().enumerate() {
            if origin.is_nowhere() || origin.face as usize >= input {
                continue;
            }
            let Some(colour) = self.of_vertex(completion, i) else { continue };
            for v in after.faces.get(origin.face as usize) {
                marks[v as usize].get_or_insert(colour);
            }
        }
        for _ in 0..CLOSING {
            close(after, input, &mut marks);
        }
        for f in 0..input {
            let m = after.faces.get(f).map(|v| marks[v as usize]);
            if m.iter().all(Option::is_some) {
                self.tints[f] = if m[1] == m[2] { m[1] } else { m[0] };
            }
        }
    }

    /// What the colours mean, under the picture.
    pub fn legend(&self, completion: &Completion, shown: &[usize], width: usize) -> Image {
        let mut lines: Vec<(Option<[u8; 3]>, String)> = vec![(
            None,
            "each colour: a part of the fill, and the place on the object it continues".into(),
        )];
        let mut smooth = false;
        for hole in shown.iter().filter_map(|&h| completion.holes.get(h)) {
            if hole.status != HoleStatus::Filled {
                continue;
            }
            lines.push((None, format!("hole {}: {}", hole.hole, hole.summary())));
            let used = by_use(completion, hole);
            for &s in used.iter().take(LISTED) {
                let source = &hole.sources[s];
                let mirrored = if source.transform.is_mirrored() { ", mirrored" } else { "" };
                let share = 100.0 * source.weight;
                let text = format!("source {s}: weight {share:.0} in 100{mirrored}");
                lines.push((self.of_source[hole.hole][s], text));
            }
            if used.len() > LISTED {
                lines.push((None, format!("and {} more sources", used.len() - LISTED)));
            }
            let range = completion.origins.get(hole.vertices.clone()).unwrap_or_default();
            smooth |= range.iter().any(|o| o.source == NONE);
        }
        if smooth {
            lines.push((Some(NO_SOURCE), "no source: smooth".into()));
        }
        let mut legend = Image::new(width, lines.len() * font::LINE, [255; 3]);
        for (i, (colour, text)) in lines.iter().enumerate() {
            let (y, mut x) = (i * font::LINE, 0);
            if let Some(colour) = colour {
                legend.paste(&Image::new(SAMPLE, font::LINE - 6, *colour), font::ADVANCE, y);
                x = SAMPLE + 2 * font::ADVANCE;
            }
            font::write(&mut legend, x, y, text);
        }
        legend
    }
}

/// The sources that gave a hole's vertices their detail, the most used first.
pub(super) fn by_use(completion: &Completion, hole: &HoleReport) -> Vec<usize> {
    let mut uses = vec![0usize; hole.sources.len()];
    for origin in completion.origins.get(hole.vertices.clone()).unwrap_or_default() {
        if let Some(n) = uses.get_mut(origin.source as usize) {
            *n += 1;
        }
    }
    let mut used: Vec<usize> = (0..uses.len()).filter(|&s| uses[s] > 0).collect();
    used.sort_by_key(|&s| (std::cmp::Reverse(uses[s]), s));
    used
}

/// Marks vertices of the first `faces` faces most of whose neighbours are marked.
fn close(mesh: MeshView<'_>, faces: usize, marks: &mut [Option<[u8; 3]>]) {
    let mut around = vec![(0u32, 0u32, None); marks.len()];
    for f in 0..faces {
        let face = mesh.faces.get(f);
        for k in 0..3 {
            let near = &mut around[face[k] as usize];
            for other in [face[(k + 1) % 3], face[(k + 2) % 3]] {
                let mark = marks[other as usize];
                *near = (near.0 + u32::from(mark.is_some()), near.1 + 1, near.2.or(mark));
            }
        }
    }
    for (mark, (marked, all, colour)) in marks.iter_mut().zip(around) {
        if 2 * marked > all {
            *mark = mark.or(colour);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matching::rigid::Rigid;
    use crate::options::{Fairing, Method};
    use crate::result::{Origin, SourceReport};

    /// A strip of six triangles, and a fill of two vertices and three faces at its end: the first
    /// vertex copied from face 0, the second from nowhere.
    fn strip() -> (Vec<[f64; 3]>, Vec<[u32; 3]>, Completion) {
        let vertices: Vec<[f64; 3]> =
            (0..10).map(|i| [f64::from(i / 2), f64::from(i % 2), 0.0]).collect();
        let faces: Vec<[u32; 3]> = (0..8)
            .map(|i| if i % 2 == 0 { [i, i + 2, i + 1] } else { [i, i + 1, i + 2] })
            .chain([[6, 7, 0]])
            .collect();
        let source = |weight| SourceReport {
            transform: Rigid::IDENTITY,
            error: 0.0,
            weight,
            vertices: 1,
            coloured: 0,
        };
        let copied = Origin { face: 0, barycentric: [1.0, 0.0, 0.0], source: 1, confidence: 0.9 };
        let completion = Completion {
            input_vertex_count: 8,
            input_face_count: 6,
            vertices: vertices[8..].to_vec(),
            faces: faces[6..].to_vec(),
            vertex_hole: vec![0; 2],
            origins: vec![copied, Origin::NOWHERE],
            colour_origins: Vec::new(),
            loose: Default::default(),
            face_hole: vec![0; 3],
            holes: vec![HoleReport {
                hole: 0,
                loops: vec![0],
                status: HoleStatus::Filled,
                method: Method::Coherent,
                fairing: Fairing::C1,
                sources: vec![source(0.7), source(0.3)],
                seams: Vec::new(),
                ring: Vec::new(),
                candidates: 0,
                confidence: 0.9,
                coherence_error: None,
                vertices: 0..2,
                faces: 0..3,
                seconds: 0.0,
            }],
            seconds: 0.0,
            cpu_seconds: 0.0,
        };
        (vertices, faces, completion)
    }

    #[test]
    fn a_source_and_what_it_gave_have_one_colour() {
        let (vertices, faces, completion) = strip();
        let colours = Colours::new(MeshView::new(&vertices[..], &faces[..]), &completion, &[0]);
        // Source 0 gave no detail, so source 1 has the first colour.
        assert_eq!(by_use(&completion, &completion.holes[0]), [1]);
        let main = Some(PALETTE[0]);
        assert_eq!(colours.tints[0], main, "the face copied from");
        assert_eq!(colours.tints[4..6], [None, None], "faces far from it");
        assert_eq!(colours.tints[6], main, "a face with the copied vertex");
        assert_eq!(colours.tints[7], main, "both vertices: the one that has a source");
        assert_eq!(colours.tints[8], main, "rim vertices only: the most used source");
    }

    #[test]
    fn the_legend_has_a_line_for_each_thing() {
        let (vertices, faces, completion) = strip();
        let colours = Colours::new(MeshView::new(&vertices[..], &faces[..]), &completion, &[0]);
        // What it is about, the hole, its source, and what has none.
        let legend = colours.legend(&completion, &[0], 900);
        assert_eq!((legend.width, legend.height), (900, 4 * font::LINE));
        let sample = |line: usize| legend.pixels[(line * font::LINE + 4) * 900 + font::ADVANCE + 4];
        assert_eq!([sample(2), sample(3)], [PALETTE[0], NO_SOURCE]);
    }
}
