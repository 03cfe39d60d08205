// SPDX-License-Identifier: GPL-3.0-or-later
//
// MeshLab's filter "Fill Holes Coherently". One source for two interfaces: ML_API 202009, that of
// MeshLab 2020.09 (Debian 12), and 202107, that of 2021.07 and later (tested with 2025.07).
#ifndef FILTER_FILL_COHERENTLY_H
#define FILTER_FILL_COHERENTLY_H

#if ML_API < 202100
#include <common/interfaces.h>
#define ML_BASE MeshFilterInterface
#define ML_IID MESH_FILTER_INTERFACE_IID
#define ML_ACTION QAction*
#define ML_CONST
#define ML_ID FilterIDType
#define ML_ARITY FILTER_ARITY
#define ML_DOCUMENT MeshDocument
#else
#include <common/plugins/interfaces/filter_plugin.h>
#define ML_BASE FilterPlugin
#define ML_IID FILTER_PLUGIN_IID
#define ML_ACTION const QAction*
#define ML_CONST const
#define ML_ID ActionIDType
#define ML_ARITY FilterArity
#define ML_DOCUMENT const MeshDocument
#endif

class FilterFillCoherently : public QObject, public ML_BASE {
  Q_OBJECT
  MESHLAB_PLUGIN_IID_EXPORTER(ML_IID)
  Q_INTERFACES(ML_BASE)

 public:
  enum { FP_FILL_COHERENTLY };

  FilterFillCoherently();
  QString pluginName() const override { return "FilterFillCoherently"; }
  QString filterName(ML_ID) const override { return "Fill Holes Coherently"; }
  QString filterInfo(ML_ID) const override;
  // Beside "Close Holes".
  FilterClass getClass(ML_ACTION) ML_CONST override { return FilterClass(ML_BASE::Remeshing); }
  ML_ARITY filterArity(ML_ACTION) const override { return SINGLE_MESH; }
  // A layer without faces is a cloud of points.
  int getPreConditions(ML_ACTION) const override { return MeshModel::MM_NONE; }
  int postCondition(ML_ACTION) const override;

#if ML_API < 202100
  using ML_BASE::initParameterSet;
  void initParameterSet(QAction*, MeshDocument& document, RichParameterList& parameters) override {
    add_parameters(document, parameters);
  }
  bool applyFilter(QAction*, MeshDocument& document, const RichParameterList& parameters,
                   vcg::CallBackPos* progress) override;
#else
  QString vendor() const override { return "complete-mesh"; }
  QString pythonFilterName(ML_ID) const override { return "meshing_fill_holes_coherently"; }
  using ML_BASE::initParameterList;
  RichParameterList initParameterList(const QAction*, const MeshDocument& document) override {
    RichParameterList parameters;
    add_parameters(document, parameters);
    return parameters;
  }
  std::map<std::string, QVariant> applyFilter(const QAction*, const RichParameterList& parameters,
                                              MeshDocument& document, unsigned int& post_condition,
                                              vcg::CallBackPos* progress) override;
#endif

 private:
  static void add_parameters(ML_DOCUMENT& document, RichParameterList& parameters);
  static void add_guidance(ML_DOCUMENT& document, RichParameterList& parameters);
};

#endif
