// SPDX-License-Identifier: GPL-3.0-or-later
//
// MeshLab's own callback never asks to stop; one that does is obeyed, and leaves the layer as it was.
#include "check.hpp"
#include "fill.h"

extern "C" {
#include "ball.h"
}

namespace {

int calls = 0, stop_at = 0;
bool on_progress(const int percent, const char* stage) {
  CHECK(percent >= 0 && percent <= 100 && stage && *stage);
  return ++calls != stop_at;
}

void add_ball(CMeshO& mesh) {
  static struct ball ball;
  make_ball(&ball, 1);
  vcg::tri::Allocator<CMeshO>::AddVertices(mesh, VERTICES);
  vcg::tri::Allocator<CMeshO>::AddFaces(mesh, FACES);
  for (int i = 0; i < VERTICES; ++i)
    for (int k = 0; k < 3; ++k) mesh.vert[std::size_t(i)].P()[k] = ball.vertices[i][k];
  for (int i = 0; i < FACES; ++i)
    for (int k = 0; k < 3; ++k) mesh.face[std::size_t(i)].V(k) = &mesh.vert[ball.faces[i][k]];
}

RichParameterList defaults() {
  RichParameterList list;
  list.addParam(RichInt("MaxHoleSize", 0, "", ""));
  list.addParam(RichBool("Selected", false, "", ""));
  list.addParam(RichBool("NewFaceSelected", true, "", ""));
  list.addParam(RichEnum("Method", 1, QStringList() << "Coherent" << "Smooth", "", ""));
  list.addParam(RichFloat("EdgeScale", 1, "", ""));
  list.addParam(RichBool("SkipUnsafe", false, "", ""));
  list.addParam(RichEnum("Color", 0, QStringList() << "From the rim", "", ""));
  return list;
}

}  // namespace

int main() {
  MeshDocument document;
  MeshModel& model = *document.addNewMesh("", "ball");
  add_ball(model.cm);
  const RichParameterList parameters = defaults();
  bool finished = false;
  for (stop_at = 1; !finished && stop_at < 1000; ++stop_at) {
    calls = 0;
    const Outcome outcome = fill_holes(model, parameters, on_progress);
    finished = calls < stop_at;
    CHECK(outcome.error.empty() == finished);
    CHECK(finished || (calls == stop_at && outcome.error.find("cancel") != std::string::npos));
    CHECK(finished || (model.cm.vert.size() == VERTICES && model.cm.face.size() == FACES));
  }
  CHECK(finished && stop_at > 4);
  CHECK(model.cm.vert.size() > VERTICES && model.cm.face.size() > FACES);
  return finish();
}
