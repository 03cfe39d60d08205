//! What can go wrong, each case naming the element and what to do about it.

/// The result of every fallible call of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// Why a call returned nothing. The input is never touched.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// There is no face, so there is no boundary either.
    #[error("the mesh has no faces: give at least one triangle")]
    Empty,
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not finite: remove or repair it")]
    NonFinite {
        /// Index of the vertex.
        vertex: usize,
    },
    /// A point's coordinate is infinite, or only some of them are NaN.
    #[error("point {point} has a coordinate that is not finite: remove or repair it")]
    NonFinitePoint {
        /// Index of the point.
        point: usize,
    },
    /// A surface takes more points than there are.
    #[error("{count} points that differ are too few for a surface: give at least 4")]
    TooFewPoints {
        /// How many there are, less doubles, outliers and missing ones.
        count: usize,
    },
    /// The points lie on one line, or at one place.
    #[error("all {count} points lie on one line: there is no surface to complete")]
    PointsOnALine {
        /// How many there are.
        count: usize,
    },
    /// No triangle fits through the points.
    #[error("the {count} points lie on no surface: they are too uneven, or fill a volume")]
    NoSurface {
        /// How many there are.
        count: usize,
    },
    /// A face names a vertex that does not exist.
    #[error("face {face} names vertex {index}, but there are only {vertex_count} vertices")]
    IndexOutOfRange {
        /// Index of the face.
        face: usize,
        /// The index it names.
        index: usize,
        /// How many vertices there are.
        vertex_count: usize,
    },
    /// More elements than 32-bit indices can name.
    #[error("{count} {what} are too many: at most {limit} can be indexed")]
    TooLarge {
        /// "vertices" or "faces".
        what: &'static str,
        /// How many were given.
        count: usize,
        /// How many are allowed.
        limit: usize,
    },
    /// The selection names a hole that is not there.
    #[error("there is no hole {hole}: the mesh has {count}; list them with `holes`")]
    NoSuchHole {
        /// The id asked for.
        hole: usize,
        /// How many holes were found.
        count: usize,
    },
    /// A selected hole cannot be filled safely.
    #[error("hole {hole} cannot be filled safely: {problem}; repair it, or skip unsafe holes")]
    UnsafeHole {
        /// Id of the hole.
        hole: usize,
        /// What is wrong, with the elements.
        problem: Problem,
    },
    /// No fill that keeps the contract was found for a hole.
    #[error("hole {hole} could not be filled: {reason}; skip it, or choose another fairing")]
    HoleFailed {
        /// Id of the hole.
        hole: usize,
        /// What stood in the way.
        reason: String,
    },
    /// An option is out of its range.
    #[error("option {name}: {reason}")]
    InvalidOption {
        /// Name of the option.
        name: &'static str,
        /// What is wrong and what is allowed.
        reason: String,
    },
    /// Something this version does not do.
    #[error("{what} is not supported by this version")]
    Unsupported {
        /// What was asked for.
        what: String,
    },
    /// The caller's progress function asked to stop.
    #[error("cancelled")]
    Cancelled,
}

/// Why a hole cannot be filled safely. Vertices are indices into the input.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// More than one boundary edge leaves a vertex: loops touch, or one loop touches itself.
    #[error("boundary loops touch at vertex {}{}", .vertices[0], more(.vertices.len()))]
    TouchingLoops {
        /// The vertices where they touch.
        vertices: Vec<u32>,
    },
    /// The rim runs through an edge with more than two faces.
    #[error("the rim touches the non-manifold edge {}-{}{}", .edges[0][0], .edges[0][1], more(.edges.len()))]
    NonManifoldEdge {
        /// The edges.
        edges: Vec<[u32; 2]>,
    },
    /// Two faces at the rim disagree about which side is out.
    #[error("the faces at edge {}-{}{} are oriented against each other", .edges[0][0], .edges[0][1], more(.edges.len()))]
    InconsistentOrientation {
        /// The edges both of whose faces run the same way.
        edges: Vec<[u32; 2]>,
    },
}

fn more(n: usize) -> String {
    if n > 1 {
        format!(" (and {} more)", n - 1)
    } else {
        String::new()
    }
}
