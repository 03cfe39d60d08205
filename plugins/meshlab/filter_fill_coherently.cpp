// SPDX-License-Identifier: GPL-3.0-or-later
//
// What MeshLab asks of a filter: names, help, parameters, log. The work is in fill.cpp.
#include "filter_fill_coherently.h"

#include "fill.h"

FilterFillCoherently::FilterFillCoherently() {
#if ML_API < 202100
  typeList << FP_FILL_COHERENTLY;
  for (const ML_ID type : types()) actionList << new QAction(filterName(type), this);
#else
  typeList = {FP_FILL_COHERENTLY};
  for (const ML_ID type : types()) actionList.push_back(new QAction(filterName(type), this));
#endif
}

QString FilterFillCoherently::filterInfo(ML_ID) const {
  // Short: the dialog below it is long.
  return "Fill holes so that the fill continues what the rest of the object shows; where nothing on "
         "it serves, the fill is a smooth surface. The mesh itself stays as it is: only new vertices "
         "and faces are added; to a layer without faces, new points. Cannot be cancelled: MeshLab has "
         "no button for that.<br>"
         "<i>G. Harary, A. Tal, E. Grinspun</i>: <b>Context-based Coherent Surface Completion</b>, ACM "
         "Transactions on Graphics 33(1), 2014; the smooth surface: <i>P. Liepa</i>: <b>Filling Holes in "
         "Meshes</b>, Symposium on Geometry Processing, 2003";
}

int FilterFillCoherently::postCondition(ML_ACTION) const {
  return MeshModel::MM_GEOMETRY_AND_TOPOLOGY_CHANGE | MeshModel::MM_VERTCOLOR |
         MeshModel::MM_FACEFLAGSELECT | MeshModel::MM_VERTFLAGSELECT;
}

// Names and words of "Close Holes" where the meaning is the same.
void FilterFillCoherently::add_parameters(ML_DOCUMENT& document, RichParameterList& parameters) {
  const CMeshO& mesh = document.mm()->cm;
  const bool selected = mesh.fn > 0 ? mesh.sfn > 0 : mesh.svn > 0;
  parameters.addParam(RichInt("MaxHoleSize", 0, "Max size to be closed",
                              "The size is expressed as number of edges composing the hole boundary. "
                              "0: holes of any size."));
  parameters.addParam(RichBool("Selected", selected, "Close holes with selected faces",
                               "Only the holes with at least one of the boundary faces selected are "
                               "closed. Of a point layer: those with a selected point at the rim, the "
                               "outer border among them."));
  parameters.addParam(RichBool("NewFaceSelected", true, "Select the newly created faces",
                               "The faces that have been created are left selected, of a point layer "
                               "the points. Any previous selection is lost."));
  parameters.addParam(RichEnum("Method", 0,
                               QStringList() << "Coherent" << "Smooth" << "Harary et al. 2014",
                               "Method",
                               "Coherent: continues what the object shows. Smooth: a smooth surface. "
                               "Harary et al. 2014: the paper as written, to compare with; slow."));
  parameters.addParam(RichFloat("EdgeScale", 1, "Size of the new triangles",
                                "Edge length of the new triangles, as a factor on that of the "
                                "surroundings: 0.05 to 20."));
  parameters.addParam(RichBool("SkipUnsafe", false, "Leave holes open that cannot be closed",
                               "Off: a hole that cannot be closed safely is an error and nothing is "
                               "changed; its vertices and faces are selected. On: it stays open and "
                               "the others are closed."));
  parameters.addParam(
      RichEnum("Color", 0,
               QStringList() << "With the shape" << "From the rim" << "By provenance"
                             << "By confidence",
               "Color of the new vertices",
               "With the shape: colors help to find the place that is copied, and are copied with its "
               "shape as far as the surroundings bear them out. From the rim: the rim's colors are "
               "continued, and the shape alone decides. (Both only if the mesh has vertex colors.) By "
               "provenance: each source of a fill has a color, and so has its place on the object. By "
               "confidence: from red (invention) over yellow (plausible) to green (convincing)."));
  add_guidance(document, parameters);
}

// Layers that are the current one stand for none: a list of layers has no empty line.
void FilterFillCoherently::add_guidance(ML_DOCUMENT& document, RichParameterList& parameters) {
#if ML_API < 202100
  MeshModel* current = document.mm();
#else
  const unsigned int current = document.mm()->id();
#endif
  parameters.addParam(RichBool("Mirror", true, "Copy mirrored places, too",
                               "Off: for lettering, and whatever has a handedness."));
  parameters.addParam(RichInt("Candidate", 0, "Candidate",
                              "Copy from one place alone: 1 is the best that was found, 2 the second. 0: "
                              "from all of them together. The log says how many there are."));
  parameters.addParam(RichEnum("SourceFaces", 0,
                               QStringList() << "All" << "The selected ones"
                                             << "All but the selected ones",
                               "Faces to copy from",
                               "Of the mesh itself. To close holes that no selected face touches, too, "
                               "switch off \"Close holes with selected faces\"."));
  parameters.addParam(RichMesh("Source", current, &document, "Copy from layer",
                               "The current layer: copy from the mesh itself. Another layer: copy from "
                               "that alone, e.g. an intact twin, in any position."));
  parameters.addParam(RichBool("VisibleLayers", false, "Copy from all other visible layers",
                               "Several layers at once, from each what serves; but not those to pass "
                               "through or to start from."));
  parameters.addParam(RichBool("AndMesh", false, "Copy from the mesh itself, too",
                               "On: from other layers and from the mesh itself. Off: from them alone."));
  parameters.addParam(RichFloat("LeastScale", 1, "Least scale of the source",
                                "What is copied may be scaled by this factor or more, 0.001 to 1000. The "
                                "wider the range, the slower; with 1 and 1 nothing is scaled."));
  parameters.addParam(RichFloat("GreatestScale", 1, "Greatest scale of the source",
                                "What is copied may be scaled by this factor or less."));
  parameters.addParam(RichEnum("Place", 0,
                               QStringList() << "Searched for" << "As the layers lie"
                                             << "As the layers lie, then aligned",
                               "Place of the source",
                               "Where the other layer is copied to. Searched for: wherever it fits. As the "
                               "layers lie: it was put over the hole by hand, with the manipulators or "
                               "the alignment tool. Then aligned: that is improved by what is known "
                               "around the hole. Close one hole at a time."));
  parameters.addParam(RichBool("Part", false, "Missing part",
                               "For a part that is missing whole, as a hand or a foot: the fill is what lies "
                               "over the hole of what is copied, its vertices and its faces."));
  parameters.addParam(RichBool("Loose", false, "Loose rim at selected vertices",
                               "Where they lie on a rim the fill need only be joined, not continue the surface "
                               "there: for an edge that was sharp, or a border to something else."));
  parameters.addParam(RichMesh("Initial", current, &document, "Start from layer",
                               "The current layer: start from a smooth fill. Another layer: a duplicate "
                               "whose holes were closed by other means; the fill starts from there."));
  parameters.addParam(RichMesh("Points", current, &document, "Pass through points of layer",
                               "The current layer: none. Another layer: its points lie inside holes, and "
                               "fills pass through them."));
  parameters.addParam(RichFloat("Softness", 0, "Softness",
                                "How far fills may stay off those points, for noisy ones: 0 (they pass "
                                "through) to 1; 0.1 halves the height of a bump over the whole hole."));
}

#if ML_API < 202100

bool FilterFillCoherently::applyFilter(QAction*, MeshDocument& document,
                                       const RichParameterList& parameters,
                                       vcg::CallBackPos* progress) {
  const Outcome outcome = fill_holes(document, parameters, progress);
  for (const std::string& line : outcome.log) Log(line);
  if (!outcome.error.empty()) {
    errorMessage = QString::fromStdString(outcome.error);
    // meshlabserver does not print the error message.
    Log(GLLogStream::FILTER, "Fill Holes Coherently: " + outcome.error);
  }
  return outcome.error.empty();
}

#else

std::map<std::string, QVariant> FilterFillCoherently::applyFilter(
    const QAction*, const RichParameterList& parameters, MeshDocument& document, unsigned int&,
    vcg::CallBackPos* progress) {
  const Outcome outcome = fill_holes(document, parameters, progress);
  for (const std::string& line : outcome.log) log(line);
  if (!outcome.error.empty()) throw MLException(QString::fromStdString(outcome.error));
  return {{"holes", outcome.holes},
          {"closed_holes", outcome.filled},
          {"new_vertices", outcome.new_vertices},
          {"new_faces", outcome.new_faces}};
}

#endif

MESHLAB_PLUGIN_NAME_EXPORTER(FilterFillCoherently)
