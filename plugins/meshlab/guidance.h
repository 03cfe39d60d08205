// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a fill comes from and where it passes: numbers and other layers of the document.
#ifndef GUIDANCE_H
#define GUIDANCE_H

#include "attributes.h"

// The layer that a parameter of layers names; nullptr if that is the current one.
const MeshModel* other_layer(const MeshDocument& document, const RichParameterList& parameters,
                             const char* name);

// Why the parameters cannot be, in words; empty if they can. Other layers lie as they are shown: by their
// matrices, seen from the current layer.
std::string set_guidance(const MeshDocument& document, const RichParameterList& parameters,
                         const Carried& carried, mesh_completion::Options& options);

#endif
