// SPDX-License-Identifier: GPL-3.0-or-later
//
// Layers without faces: new points for the holes of a cloud.
#ifndef POINTS_H
#define POINTS_H

#include "attributes.h"

// As fill_holes; options and carried are ready.
Outcome fill_points(MeshModel& model, const RichParameterList& parameters, const Carried& carried,
                    mesh_completion::Options options);

#endif
