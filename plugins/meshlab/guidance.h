// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a fill comes from and where it passes: numbers and other layers of the document.
#ifndef GUIDANCE_H
#define GUIDANCE_H

#include "attributes.h"

// The layer that a parameter of layers names; nullptr if that is the current one.
const MeshModel* other_layer(const MeshDocument& document, const RichParameterList& parameters,
                             const char* name);

// The layers that are copied from, in their order; none if that is the current one.
std::vector<const MeshModel*> source_layers(const MeshDocument& document,
                                            const RichParameterList& parameters);

// Why the parameters cannot be, in words; empty if they can. Other layers lie as they are shown: by their
// matrices, seen from the current layer.
std::string set_guidance(const MeshDocument& document, const RichParameterList& parameters,
                         const std::vector<const MeshModel*>& sources, const Carried& carried,
                         mesh_completion::Options& options);

// The same of what is selected in the current layer, and of a layer to start from, which must be this one
// and more.
std::string set_rims(const MeshDocument& document, const RichParameterList& parameters,
                     mesh_completion::Options& options);

#endif
