// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FILL_H
#define FILL_H

#if ML_API < 202100
#include <common/interfaces.h>
#else
#include <common/plugins/interfaces/filter_plugin.h>
#endif
#include <string>
#include <vector>

// What there is to say of a run.
struct Outcome {
  std::string error;  // empty: it went well
  std::vector<std::string> log;
  int holes = 0, filled = 0, new_vertices = 0, new_faces = 0;
};

// Fills holes of the current layer, as the filter's parameters say. After an error the layer is as it was
// but for its selection, which shows what is in the way. Other layers are only read.
Outcome fill_holes(MeshDocument& document, const RichParameterList& parameters,
                   vcg::CallBackPos* progress);

#endif
