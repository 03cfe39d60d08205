// SPDX-License-Identifier: GPL-3.0-or-later
//
// What there is to say of a call, and the layer's positions as the library reads them.
#ifndef REPORT_H
#define REPORT_H

#include <complete_mesh.hpp>

#include "fill.h"

// The positions where they lie.
mesh_completion::MeshView<Scalarm> view_of(CMeshO& mesh,
                                           const std::vector<std::array<std::uint32_t, 3>>& faces);

// The words of a failure; what is in the way is selected.
Outcome failed(CMeshO& mesh, const mesh_completion::Failure& failure);

// The log. kind: "vertices" or "points".
void report(const mesh_completion::Result<Scalarm>& result, const char* kind, Outcome& outcome);

#endif
