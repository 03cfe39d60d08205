# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's meshes to arrays and back. What was there stays as it is: the fill is added."""

from contextlib import contextmanager
from dataclasses import dataclass

import bmesh
import bpy
import numpy as np

from . import looks, points, texture, values
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
    is_cloud: bool
    """Vertices alone, without an edge."""


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
        vertices.reshape(-1, 3),
        triangles.reshape(-1, 3),
        polygons,
        selected,
        of_polygon[polygons],
        not len(mesh.polygons) and not len(mesh.edges),
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

    def __init__(self, ob, arrays, colours_steer, others=(), alone=True):
        """`others`: the objects that are copied from, if they are others, and whether from them alone."""
        self._arrays, self._uvs = arrays, {}
        self.normals = None
        with settled(ob) as mesh:
            attributes = values.read(mesh)
            if mesh.uv_layers and not arrays.is_cloud:
                self._read_texture(mesh)
        if arrays.is_cloud:
            attributes, self.normals = points.take_normals(attributes)
        exemplars = []
        for other in others:
            with settled(other) as mesh:
                exemplars.append(values.read(mesh))
        self.asked = values.ask(attributes, colours_steer, exemplars, alone)

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


def vertices_of_group(ob, name, purpose):
    """(k,): the vertices in a vertex group."""
    group = ob.vertex_groups.get(name)
    if group is None:
        raise NothingToFill(f"Choose a vertex group to {purpose}: there is none called '{name}'")
    inside = [any(g.group == group.index and g.weight > 0 for g in v.groups) for v in ob.data.vertices]
    if not any(inside):
        raise NothingToFill(f"The vertex group '{name}' has no vertex to {purpose}")
    return np.flatnonzero(inside)


def faces_of_group(ob, arrays, name):
    """(m,) bool: the triangles whose vertices are all in a vertex group."""
    inside = np.zeros(len(arrays.vertices), bool)
    inside[vertices_of_group(ob, name, "copy from")] = True
    faces = inside[arrays.triangles].all(axis=1)
    if not faces.any():
        raise NothingToFill(f"The vertex group '{name}' has no face to copy from")
    return faces


def selected_faces(ob, arrays):
    """(m,) bool: the triangles of the polygons in the selection."""
    if ob.mode != "EDIT":
        raise NothingToFill("Select the faces to copy from in Edit Mode, and fill there")
    if not arrays.selected_faces.any():
        raise NothingToFill("Select the faces to copy from: no face is selected")
    return arrays.selected_faces


def initial(ob, arrays, other):
    """The library's arguments for what another object adds to the mesh: its first vertices and polygons must
    be those of the mesh, in its own coordinates, wherever it stands."""
    theirs = read(other)
    n, m = len(arrays.vertices), len(ob.data.polygons)
    new = theirs.polygons >= m
    if theirs.vertices[:n].tobytes() != arrays.vertices.tobytes() or not np.array_equal(
        _corners(other.data, m), _corners(ob.data, m)
    ):
        raise NothingToFill(
            f"'{other.name}' does not begin with the vertices and faces of the mesh: start from a duplicate "
            "whose holes were filled, and nothing else changed"
        )
    if not new.any():
        raise NothingToFill(f"'{other.name}' has no face more than the mesh: nothing to start from")
    return {"initial_vertices": theirs.vertices[n:], "initial_faces": theirs.triangles[new]}


def _corners(mesh, polygons):
    """The corners of the first polygons: where each begins, and their vertices."""
    starts, vertices = np.empty(len(mesh.polygons), np.int32), np.empty(len(mesh.loops), np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    mesh.loops.foreach_get("vertex_index", vertices)
    end = starts[polygons] if polygons < len(starts) else len(vertices)
    return np.concatenate([starts[:polygons], vertices[:end]])


def seen_from(ob, other):
    """(4, 4): from another object's coordinates to those of `ob`, as both stand in the scene."""
    return np.array(ob.matrix_world.inverted_safe() @ other.matrix_world)


def places_of(ob, other):
    """(n, 3): another object's vertices in the coordinates of `ob`."""
    matrix = seen_from(ob, other)
    return read(other).vertices @ matrix[:3, :3].T + matrix[:3, 3]


def object_sources(ob, arrays, others, alone):
    """Sources on other objects, alone or beside the mesh itself, in the sizes that they have in the scene.
    Their polygons are counted on from those of the mesh."""
    places, faces, polygons = [], [], [arrays.polygons]
    count, before = 0, len(ob.data.polygons)
    for other in others:
        theirs = read(other)
        if not len(theirs.triangles):
            raise NothingToFill(f"'{other.name}' has no faces to copy from")
        places.append(places_of(ob, other))
        # A mirrored object's faces run the other way round.
        mirrored = np.linalg.det(seen_from(ob, other)[:3, :3]) < 0
        faces.append((theirs.triangles[:, ::-1] if mirrored else theirs.triangles) + count)
        polygons.append(theirs.polygons + before)
        count += len(theirs.vertices)
        before += len(other.data.polygons)
    arrays.polygons = np.concatenate(polygons)
    sources = {
        "exemplar_vertices": np.concatenate(places).astype(np.float32),
        "exemplar_faces": np.concatenate(faces),
        "exemplar_only": alone,
    }
    if len(others) > 1:
        sources["exemplar_parts"] = [len(each) for each in places]
    return sources


def add_fill(ob, result, arrays, carried, write_attributes):
    """Adds the fill and selects it; gives the names of attributes that could not be written."""
    mesh, edit = ob.data, ob.mode == "EDIT"
    bm = bmesh.from_edit_mesh(mesh) if edit else bmesh.new()
    if not edit:
        bm.from_mesh(mesh)
        # With vertices, old faces between rim vertices would join in.
        bm.select_mode = {"VERT"} if arrays.is_cloud else {"FACE"}
    try:
        bm.verts.ensure_lookup_table()
        _deselect(bm)
        # Once they are there they must be right.
        elements = bm.verts if arrays.is_cloud else bm.faces
        missed = looks.make_layers(bm, mesh, elements) if write_attributes else looks.absent_layers(bm, elements)
        if arrays.is_cloud:
            points.add(bm, result, carried, missed)
        else:
            _add_faces(bm, result, arrays, carried, missed)
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


def _add_faces(bm, result, arrays, carried, missed):
    vertices, faces = _add_elements(bm, result)
    bm.faces.ensure_lookup_table()
    fill = looks.Fill(bm, result, vertices, faces)
    looks.copy_from_rim(fill)
    looks.match_rims(fill, result)
    looks.set_values(fill, values.rows_of(carried.asked, result.new_vertex_values))
    looks.set_texture(fill, carried.texture(result))
    looks.spread_weights(fill)
    looks.spread_keys(fill)
    triangles = result.new_vertex_source_faces
    sources = np.where(triangles >= 0, arrays.polygons[np.maximum(triangles, 0)], -1)
    looks.write_attributes(bm, faces, vertices, sources, result.new_vertex_confidences, missed)
    for face in faces:
        face.select_set(True)
    bm.select_flush_mode()
    bm.normal_update()


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
