// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the new elements carry: normals, colors, quality.
#ifndef ATTRIBUTES_H
#define ATTRIBUTES_H

#include <complete_mesh_attributes.hpp>

#include "fill.h"

// In the order of the filter's parameter.
enum class Coloring { shape = 0, rim = 1, provenance = 2, confidence = 3 };

// Color and quality of the vertices of a layer as far as it has them, as values that are completed with
// the shape; the color steers.
void give_values(const MeshModel& model, Coloring coloring, mesh_completion::Options& options);

class Attributes {
 public:
  using Faces = std::vector<std::array<std::uint32_t, 3>>;

  // Before the new elements are added.
  Attributes(const MeshModel& model, const mesh_completion::Result<Scalarm>& result,
             const Faces& faces);
  // Afterwards.
  void apply(MeshModel& model, Coloring coloring) const;

 private:
  void set_normals(CMeshO& mesh) const;
  void carry_from_rim(MeshModel& model) const;
  void take_values(MeshModel& model, Coloring coloring) const;
  void copy_face_attributes(MeshModel& model) const;
  void color_provenance(CMeshO& mesh) const;
  void color_confidence(CMeshO& mesh) const;

  const mesh_completion::Result<Scalarm>& result_;
  const Faces& faces_;
  mesh_completion::Carrier carrier_;
  // Vertices of the rim whose normal is that of their faces, and so goes with the new ones.
  std::vector<std::uint32_t> follow_;
};

#endif
