//! Triangulation, refinement and fairing of one hole.
