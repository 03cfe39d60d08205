# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's meshes to arrays and back. What was there stays as it is: the fill is added."""

from dataclasses import dataclass

import bmesh
import numpy as np

from . import looks
from .session import NothingToFill


@dataclass
class Arrays:
    """A mesh as the library takes it: quads and n-gons as the triangles that they are drawn with."""

    vertices: np.ndarray
    """(n, 3) float32, local coordinates."""
    triangles: np.ndarray
    """(m, 3) int32."""
    polygons: np.ndarray
    """(m,) int32: the polygon of each triangle; those of another object's after them."""
    selected: np.ndarray
    """(n,) bool: vertices that the user has selected; none in Object Mode."""
    selected_faces: np.ndarray
    """(m,) bool: triangles of polygons that the user has selected; none in Object Mode."""


def read(ob):
    if ob.mode == "EDIT":
        ob.update_from_editmode()  # Edit Mode has a mesh of its own
    mesh = ob.data
    vertices = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", vertices)
    mesh.calc_loop_triangles()
    triangles = np.empty(len(mesh.loop_triangles) * 3, np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    polygons = np.empty(len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("polygon_index", polygons)
    selected, of_polygon = np.zeros(len(mesh.vertices), bool), np.zeros(len(mesh.polygons), bool)
    if ob.mode == "EDIT":
        mesh.vertices.foreach_get("select", selected)
        mesh.polygons.foreach_get("select", of_polygon)
    return Arrays(
        vertices.reshape(-1, 3), triangles.reshape(-1, 3), polygons, selected, of_polygon[polygons]
    )


def group_sources(ob, arrays, name):
    """Sources in a vertex group: the triangles whose vertices are all in it."""
    group = ob.vertex_groups.get(name)
    if group is None:
        raise NothingToFill(f"Choose a vertex group to copy from: there is none called '{name}'")
    inside = np.array(
        [any(g.group == group.index and g.weight > 0 for g in v.groups) for v in ob.data.vertices], bool
    )
    faces = inside[arrays.triangles].all(axis=1)
    if not faces.any():
        raise NothingToFill(f"The vertex group '{name}' has no face to copy from")
    return {"source_faces": faces}


def selected_sources(ob, arrays):
    """Sources in the selection: the triangles of the polygons in it."""
    if ob.mode != "EDIT":
        raise NothingToFill("Select the faces to copy from in Edit Mode, and fill there")
    if not arrays.selected_faces.any():
        raise NothingToFill("Select the faces to copy from: no face is selected")
    return {"source_faces": arrays.selected_faces}


def object_sources(ob, arrays, other):
    """Sources on another object alone, in the size that it has in the scene. Its polygons are
    counted on from those of the mesh."""
    if other is None or other.type != "MESH" or other.data == ob.data:
        raise NothingToFill("Choose another mesh object to copy from")
    theirs = read(other)
    matrix = np.array(ob.matrix_world.inverted_safe() @ other.matrix_world)
    places = theirs.vertices @ matrix[:3, :3].T + matrix[:3, 3]
    polygons = np.concatenate([arrays.polygons, theirs.polygons + len(ob.data.polygons)])
    arrays.polygons = polygons
    return {
        "exemplar_vertices": places.astype(np.float32),
        "exemplar_faces": theirs.triangles,
        "exemplar_only": True,
    }


def add_fill(ob, result, polygons, write_attributes):
    """Adds the fill and selects it; gives the names of attributes that could not be written."""
    mesh, edit = ob.data, ob.mode == "EDIT"
    spread = looks.Spread(result.new_faces, result.input_vertex_count, len(result.new_vertices))
    bm = bmesh.from_edit_mesh(mesh) if edit else bmesh.new()
    if not edit:
        bm.from_mesh(mesh)
        bm.select_mode = {"FACE"}  # with vertices, old faces between rim vertices would join in
    try:
        bm.verts.ensure_lookup_table()
        _deselect(bm)
        missed = looks.make_layers(bm, mesh) if write_attributes else []
        vertices, faces = _add_elements(bm, result)
        bm.faces.ensure_lookup_table()
        looks.match_rims(bm, result, vertices, faces)
        looks.spread_layers(bm, spread, vertices, faces)
        looks.spread_keys(bm, spread, vertices)
        if write_attributes:
            looks.write_attributes(bm, result, polygons, vertices, faces, missed)
        for face in faces:
            face.select_set(True)
        bm.select_flush_mode()
        bm.normal_update()
        if edit:
            bmesh.update_edit_mesh(mesh, loop_triangles=True, destructive=True)
        else:
            bm.to_mesh(mesh)
    finally:
        if not edit:
            bm.free()
    if not edit:
        mesh.update()
    return missed


def select(ob, vertices, edges, polygons):
    """Selects elements and nothing else, so that the user sees them."""
    mesh, edit = ob.data, ob.mode == "EDIT"
    bm = bmesh.from_edit_mesh(mesh) if edit else bmesh.new()
    if not edit:
        bm.from_mesh(mesh)
    for elements in (bm.verts, bm.edges, bm.faces):
        elements.ensure_lookup_table()
    _deselect(bm)
    if len(vertices) or len(edges):
        bm.select_mode = {"VERT"}  # with faces alone, vertices could not be seen
    for i in vertices:
        bm.verts[i].select_set(True)
    for a, b in edges:
        edge = bm.edges.get((bm.verts[a], bm.verts[b]))
        for part in (edge,) if edge else (bm.verts[a], bm.verts[b]):
            part.select_set(True)
    for i in polygons:
        bm.faces[i].select_set(True)
    bm.select_flush_mode()
    if edit:
        bmesh.update_edit_mesh(mesh, loop_triangles=False, destructive=False)
    else:
        bm.to_mesh(mesh)
        bm.free()
        mesh.update()


def _deselect(bm):
    for elements in (bm.faces, bm.edges, bm.verts):
        for element in elements:
            if element.select:
                element.select_set(False)


def _add_elements(bm, result):
    old = bm.verts[:]
    vertices = [bm.verts.new(co) for co in result.new_vertices.tolist()]
    all_vertices = old + vertices
    faces = [
        bm.faces.new((all_vertices[a], all_vertices[b], all_vertices[c]))
        for a, b, c in result.new_faces.tolist()
    ]
    bm.verts.index_update()
    bm.faces.index_update()
    bm.verts.ensure_lookup_table()
    return vertices, faces
