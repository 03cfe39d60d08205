# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's meshes to arrays and back. What was there stays as it is: the fill is added."""

from contextlib import contextmanager
from dataclasses import dataclass

import bmesh
import bpy
import numpy as np

from . import looks, texture, values
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


@contextmanager
def settled(ob):
    """The object's mesh, or in Edit Mode, where Python cannot read a mesh's attributes, a copy."""
    if ob.mode != "EDIT":
        yield ob.data
        return
    ob.update_from_editmode()
    copy = ob.data.copy()
    try:
        yield copy
    finally:
        bpy.data.meshes.remove(copy)


class Carried:
    """What the mesh carries beside its shape, read before it is filled."""

    def __init__(self, ob, arrays, colours_steer, other=None):
        """`other`: the object that is copied from, if it is another."""
        self._arrays, self._uvs = arrays, {}
        with settled(ob) as mesh:
            attributes = values.read(mesh)
            if mesh.uv_layers:
                self._read_texture(mesh)
        exemplar = None
        if other is not None:
            with settled(other) as mesh:
                exemplar = values.read(mesh)
        self.asked = values.ask(attributes, colours_steer, exemplar)

    def _read_texture(self, mesh):
        mesh.calc_loop_triangles()
        loops = np.empty(len(mesh.loop_triangles) * 3, np.int32)
        mesh.loop_triangles.foreach_get("loops", loops)
        vertices, starts = np.empty(len(mesh.loops), np.int32), np.empty(len(mesh.polygons), np.int32)
        mesh.loops.foreach_get("vertex_index", vertices)
        mesh.polygons.foreach_get("loop_start", starts)
        materials = np.empty(len(mesh.polygons), np.int32)
        mesh.polygons.foreach_get("material_index", materials)
        self._materials = materials[self._arrays.polygons[: len(mesh.loop_triangles)]]
        loops = loops.reshape(-1, 3)
        for layer in mesh.uv_layers:
            uv = np.empty(len(mesh.loops) * 2, np.float32)
            layer.data.foreach_get("uv", uv)
            uv = np.nan_to_num(uv.reshape(-1, 2).astype(float))
            charts = texture.charts(vertices, uv, starts)
            self._uvs[layer.name] = uv[loops], charts[loops[:, 0]]

    def texture(self, result):
        """What looks.set_texture asks for. Another material has another image: there is no source."""
        if not self._uvs:
            return None  # it will not ask
        places = texture.Places(result, self._arrays.vertices, self._arrays.triangles)

        def of_layer(name, materials):
            serves = self._materials[places.first] == np.asarray(materials)[places.faces]
            return places.faces[serves], places.coordinates(*self._uvs[name])[serves]

        return of_layer


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


def add_fill(ob, result, arrays, carried, write_attributes):
    """Adds the fill and selects it; gives the names of attributes that could not be written."""
    mesh, edit = ob.data, ob.mode == "EDIT"
    bm = bmesh.from_edit_mesh(mesh) if edit else bmesh.new()
    if not edit:
        bm.from_mesh(mesh)
        bm.select_mode = {"FACE"}  # with vertices, old faces between rim vertices would join in
    try:
        bm.verts.ensure_lookup_table()
        _deselect(bm)
        # Once they are there they must be right.
        missed = looks.make_layers(bm, mesh) if write_attributes else looks.absent_layers(bm)
        vertices, faces = _add_elements(bm, result)
        bm.faces.ensure_lookup_table()
        fill = looks.Fill(bm, result, vertices, faces)
        looks.copy_from_rim(fill)
        looks.match_rims(fill, result)
        looks.set_values(fill, values.rows_of(carried.asked, result))
        looks.set_texture(fill, carried.texture(result))
        looks.spread_weights(fill)
        looks.spread_keys(fill)
        looks.write_attributes(bm, result, arrays.polygons, vertices, faces, missed)
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
    return missed if write_attributes else []


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
