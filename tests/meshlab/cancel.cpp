// SPDX-License-Identifier: GPL-3.0-or-later
//
// What meshlabserver cannot show. MeshLab's own callback never asks to stop; one that does is obeyed, and
// leaves the layer as it was. And what faces carry, which its files do not have.
#include <algorithm>
#include <map>

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

// Every face has a color and a quality of its own.
void mark_faces(MeshModel& model) {
  model.updateDataMask(MeshModel::MM_FACECOLOR | MeshModel::MM_FACEQUALITY);
  for (int i = 0; i < FACES; ++i) {
    CFaceO& face = model.cm.face[std::size_t(i)];
    face.C() = vcg::Color4b(static_cast<unsigned char>(i % 256), static_cast<unsigned char>(i / 256), 7, 255);
    face.Q() = Scalarm(i);
  }
}

// A new face at the rim is like the face beyond, the others like one at the rim; the old ones stay.
void check_faces(const CMeshO& mesh) {
  const auto number = [](const CFaceO& face) { return face.cC()[0] + 256 * face.cC()[1]; };
  std::map<std::pair<const CVertexO*, const CVertexO*>, int> beyond;
  int wrong = 0, at_rim = 0;
  for (std::size_t i = 0; i < FACES; ++i) {
    const CFaceO& face = mesh.face[i];
    wrong += number(face) != int(i) || face.cQ() != Scalarm(i);
    for (int k = 0; k < 3; ++k) beyond[{face.cV((k + 1) % 3), face.cV(k)}] = int(i);
  }
  for (std::size_t i = FACES; i < mesh.face.size(); ++i) {
    const CFaceO& face = mesh.face[i];
    std::vector<int> likes;
    for (int k = 0; k < 3; ++k) {
      const auto like = beyond.find({face.cV(k), face.cV((k + 1) % 3)});
      if (like != beyond.end()) likes.push_back(like->second);
    }
    const int like = number(face);
    at_rim += int(likes.size());
    if (!likes.empty()) wrong += std::find(likes.begin(), likes.end(), like) == likes.end();
    wrong += like < 0 || like >= FACES || face.cC()[2] != 7 || face.cC()[3] != 255;
    wrong += face.cQ() != Scalarm(like);
    vcg::Point3<Scalarm> normal = (face.cP(1) - face.cP(0)) ^ (face.cP(2) - face.cP(0));
    wrong += (normal.Normalize() - face.cN()).Norm() > 1e-4;
  }
  CHECK(at_rim == CAP_EDGES + PATCH_EDGES);
  CHECK(wrong == 0);
}

RichParameterList defaults(MeshDocument& document) {
  RichParameterList list;
  list.addParam(RichInt("MaxHoleSize", 0, "", ""));
  list.addParam(RichBool("Selected", false, "", ""));
  list.addParam(RichBool("NewFaceSelected", true, "", ""));
  list.addParam(RichEnum("Method", 1, QStringList() << "Coherent" << "Smooth", "", ""));
  list.addParam(RichFloat("EdgeScale", 1, "", ""));
  list.addParam(RichBool("SkipUnsafe", false, "", ""));
  list.addParam(RichEnum("Color", 0, QStringList() << "With the shape", "", ""));
  list.addParam(RichBool("Mirror", true, "", ""));
  list.addParam(RichInt("Candidate", 0, "", ""));
  list.addParam(RichEnum("SourceFaces", 0, QStringList() << "All", "", ""));
  list.addParam(RichMesh("Source", document.mm(), &document, "", ""));
  list.addParam(RichBool("VisibleLayers", false, "", ""));
  list.addParam(RichBool("AndMesh", false, "", ""));
  list.addParam(RichFloat("LeastScale", 1, "", ""));
  list.addParam(RichFloat("GreatestScale", 1, "", ""));
  list.addParam(RichEnum("Place", 0, QStringList() << "Searched for", "", ""));
  list.addParam(RichBool("Part", false, "", ""));
  list.addParam(RichBool("Loose", false, "", ""));
  list.addParam(RichMesh("Initial", document.mm(), &document, "", ""));
  list.addParam(RichMesh("Points", document.mm(), &document, "", ""));
  list.addParam(RichFloat("Softness", 0, "", ""));
  return list;
}

}  // namespace

int main() {
  MeshDocument document;
  MeshModel& model = *document.addNewMesh("", "ball");
  add_ball(model.cm);
  mark_faces(model);
  const RichParameterList parameters = defaults(document);
  bool finished = false;
  for (stop_at = 1; !finished && stop_at < 1000; ++stop_at) {
    calls = 0;
    const Outcome outcome = fill_holes(document, parameters, on_progress);
    finished = calls < stop_at;
    CHECK(outcome.error.empty() == finished);
    CHECK(finished || (calls == stop_at && outcome.error.find("cancel") != std::string::npos));
    CHECK(finished || (model.cm.vert.size() == VERTICES && model.cm.face.size() == FACES));
  }
  CHECK(finished && stop_at > 4);
  CHECK(model.cm.vert.size() > VERTICES && model.cm.face.size() > FACES);
  check_faces(model.cm);
  return finish();
}
