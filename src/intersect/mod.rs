//! Exact tests: which faces of a fill meet each other or the rest of the mesh.
