//! The numbers that options choose by.

/// The number type of the coordinates, of input and result alike.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CVertexType {
    /// float, 4 bytes. The default: what hosts and GPUs keep.
    F32 = 0,
    /// double, 8 bytes.
    F64 = 1,
}

/// How a fill is made.
#[repr(C)]
pub enum CMethod {
    /// Smooth completion: triangulation, refinement, fairing.
    Smooth = 0,
    /// Coherent completion: continues what the object shows. A hole for which nothing on the object
    /// serves gets a smooth fill; the method of its complete_mesh_hole says so.
    Coherent = 1,
    /// Coherent completion as Harary, Tal and Grinspun (2014) describe it, to compare with; slow.
    Harary = 2,
    /// Fragment-based inpainting (Bendels, Schnabel, Klein 2005): copies of fragments of the object, scale
    /// by scale.
    Fragment = 3,
    /// Completion for shape and appearance (Park, Guo, Shin, Qin 2006): the patch whose surroundings are the
    /// most similar is warped into the hole.
    Warp = 4,
}

/// The smooth surface that a hole is filled with, or that its coherent fill starts from.
#[repr(C)]
pub enum CFairing {
    /// The best of the others for each hole, chosen by what its surroundings show.
    Auto = 0,
    /// The refined triangulation as it is.
    None = 1,
    /// Membrane: meets the rim, with a crease.
    C0 = 2,
    /// Thin plate: continues the tangent planes at the rim.
    C1 = 3,
    /// Continues the curvature, too.
    C2 = 4,
    /// Least-squares mesh of the fill and a band of the surroundings.
    LeastSquares = 5,
    /// Thin plate through the smoothed surroundings: continues shape, not roughness.
    SmoothedPlate = 6,
}

/// The edge length that new triangles aim for.
#[repr(C)]
pub enum CSizing {
    /// The edge length of the surroundings, carried inward from the rim.
    Surroundings = 0,
    /// The same, times sizing_value (0.05 to 20).
    Scaled = 1,
    /// sizing_value everywhere, in mesh units, greater than 0.
    EdgeLength = 2,
    /// No refinement: no vertex is added but where a valid fill needs one.
    None = 3,
}

/// Which boundary loops are filled together, as one hole.
#[repr(C)]
pub enum CGrouping {
    /// Loops that face each other: islands inside a loop, the two ends of a missing band.
    Automatic = 0,
    /// Every loop is a hole of its own.
    Separate = 1,
    /// The lists of join_vertices; loops in no list are holes of their own.
    Join = 2,
}

/// Which holes are filled.
#[repr(C)]
pub enum CSelection {
    /// Every hole.
    All = 0,
    /// The holes whose ids are in selection_ids.
    Ids = 1,
    /// Holes of at most selection_max_edges boundary edges.
    MaxEdges = 2,
    /// Holes whose loops are together at most selection_length long.
    MaxCircumference = 3,
    /// Holes of at most selection_length diameter.
    MaxDiameter = 4,
    /// All but the hole with the greatest circumference: an open scan's own border.
    AllButLargest = 5,
    /// The one hole whose rim passes nearest to selection_point.
    NearPoint = 6,
    /// The holes whose rim contains a vertex of selection_ids; if there is none, the one hole
    /// whose rim passes nearest to these vertices.
    NearVertices = 7,
}

/// What arrays a result holds.
#[repr(C)]
pub enum COutput {
    /// The whole mesh (input first) and the new elements: one copy of the input.
    WholeMesh = 0,
    /// Only the new elements, for hosts that add to the mesh they have.
    NewOnly = 1,
}
