// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the new elements carry: normals, colors, quality.
#ifndef ATTRIBUTES_H
#define ATTRIBUTES_H

#include <complete_mesh_attributes.hpp>
#include <functional>

#include "fill.h"

// In the order of the filter's parameter.
enum class Coloring { shape = 0, rim = 1, provenance = 2, confidence = 3 };

// Which values of the vertices are completed with the shape: red, green, blue and alpha, and quality, as
// far as the layer, and those that are copied from if they are others, have them. If those have neither and
// the layer itself is copied from, too: its own, of which they know nothing.
struct Carried {
  bool color, quality, of_sources;

  Carried(const MeshModel& model, const std::vector<const MeshModel*>& sources, bool and_mesh,
          Coloring coloring);
  void append(const CVertexO& vertex, std::vector<double>& values) const;
  // Those of a layer go into the options; the color steers.
  void give(const CMeshO& mesh, mesh_completion::Options& options) const;
  // Those that came back go to the new vertices.
  void take(CMeshO& mesh, const mesh_completion::Result<Scalarm>& result) const;
};

// Colors by provenance or confidence; nothing for the other colorings. places(i): vertices of the layer
// that new vertex i was copied from, none if it was from elsewhere.
using Places = std::function<std::vector<std::uint32_t>(std::size_t)>;
void color_by_result(MeshModel& model, const mesh_completion::Result<Scalarm>& result,
                     Coloring coloring, const Places& places);

class Attributes {
 public:
  using Faces = std::vector<std::array<std::uint32_t, 3>>;

  // Before the new elements are added.
  Attributes(const MeshModel& model, const mesh_completion::Result<Scalarm>& result,
             const Faces& faces);
  // Afterwards.
  void apply(MeshModel& model, const Carried& carried, Coloring coloring) const;

 private:
  void set_normals(CMeshO& mesh) const;
  void carry_from_rim(MeshModel& model) const;
  void copy_face_attributes(MeshModel& model) const;

  const mesh_completion::Result<Scalarm>& result_;
  const Faces& faces_;
  mesh_completion::Carrier carrier_;
  // Vertices of the rim whose normal is that of their faces, and so goes with the new ones.
  std::vector<std::uint32_t> follow_;
};

#endif
