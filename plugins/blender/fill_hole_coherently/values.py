# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours and other numbers that the user's attributes give vertices: to the library, which completes
them with the shape, and back. The numbers of corners count as those of their vertex, their mean."""

from dataclasses import dataclass

import numpy as np

# (field of the data, how many numbers) by type. All of them are continuous.
FIELDS = {
    "FLOAT": ("value", 1),
    "FLOAT_VECTOR": ("vector", 3),
    "FLOAT_COLOR": ("color", 4),
    "BYTE_COLOR": ("color", 4),
}
# As bmesh calls their layers.
LAYERS = {
    "FLOAT": "float",
    "FLOAT_VECTOR": "float_vector",
    "FLOAT_COLOR": "float_color",
    "BYTE_COLOR": "color",
}
# Blender's own, which mark single vertices; and ours.
NOT_VALUES = {"position", "crease_vert", "bevel_weight_vert", "completion_confidence"}


def is_user_s(name):
    return not name.startswith(".") and name not in NOT_VALUES


@dataclass
class Attribute:
    """One attribute of a mesh."""

    name: str
    kind: str
    domain: str
    rows: np.ndarray
    """(vertices, numbers); bytes as 0 to 255."""

    @property
    def key(self):
        return self.name, self.kind, self.domain

    @property
    def is_colour(self):
        return self.kind in ("FLOAT_COLOR", "BYTE_COLOR")


@dataclass
class Values:
    """What is asked of the library: attributes side by side, those first that steer."""

    attributes: list
    arguments: dict
    """The library's own: see complete_mesh."""


def read(mesh):
    """The attributes of a mesh that is not in Edit Mode; the active colour is the first."""
    found = []
    for attribute in mesh.attributes:
        name, kind, domain = attribute.name, attribute.data_type, attribute.domain
        if kind not in FIELDS or domain not in ("POINT", "CORNER"):
            continue
        if not is_user_s(name):
            continue
        rows = _numbers(attribute)
        found.append(Attribute(name, kind, domain, _of_vertices(mesh, rows, domain)))
    active = mesh.color_attributes.active_color
    first = active.name if active else None
    return sorted(found, key=lambda attribute: (not attribute.is_colour, attribute.name != first))


def _numbers(attribute):
    field, width = FIELDS[attribute.data_type]
    numbers = np.empty(len(attribute.data) * width, np.float32)
    attribute.data.foreach_get(field, numbers)
    rows = numbers.reshape(-1, width).astype(float)
    if attribute.data_type == "BYTE_COLOR":
        rows = np.rint(255 * _encoded(rows))
    # The library takes none that is no number.
    return np.nan_to_num(rows, nan=0.0, posinf=0.0, neginf=0.0)


def _encoded(linear):
    """Blender shows bytes as linear colours; what is stored, and what files have, is sRGB. Alpha is
    alpha."""
    colour = np.clip(linear[:, :3], 0, 1)
    low = colour * 12.92
    high = 1.055 * colour ** (1 / 2.4) - 0.055
    return np.column_stack([np.where(colour < 0.0031308, low, high), linear[:, 3]])


def _of_vertices(mesh, rows, domain):
    if domain == "POINT":
        return rows
    vertices = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", vertices)
    count = np.bincount(vertices, minlength=len(mesh.vertices))
    sums = [np.bincount(vertices, column, len(mesh.vertices)) for column in rows.T]
    return np.stack(sums, 1) / np.maximum(count, 1)[:, None]


def ask(attributes, colours_steer, exemplars=(), alone=True):
    """Values of a mesh's attributes; with exemplars those that all of them have, too, by their names. If they
    have none of them and are not copied from alone: the mesh's own, of which those parts know nothing."""
    others = [{other.name: other for other in exemplar} for exemplar in exemplars]
    pairs = [(a, [_alike(a, own.get(a.name)) for own in others]) for a in attributes]
    shared = [(a, rows) for a, rows in pairs if all(own is not None for own in rows)]
    if shared or alone:
        attributes = [a for a, _ in shared]
    if not attributes:
        return Values([], {})
    arguments = {"vertex_values": np.column_stack([a.rows for a in attributes])}
    if exemplars and shared:
        arguments["exemplar_values"] = np.column_stack([np.concatenate(rows) for _, rows in shared])
    if colours_steer and attributes[0].is_colour:
        arguments["steering_channels"] = 3
    return Values(attributes, arguments)


def _alike(attribute, other):
    """The rows of another mesh's attribute in the unit of ours; None if they are something else."""
    if other is None or other.rows.shape[1] != attribute.rows.shape[1]:
        return None
    if other.kind == attribute.kind:
        return other.rows
    if not (other.is_colour and attribute.is_colour):
        return None
    if attribute.kind == "BYTE_COLOR":
        return np.rint(255 * _encoded(other.rows))
    return _decoded(other.rows / 255)


def _decoded(stored):
    """The inverse of _encoded."""
    colour = stored[:, :3]
    linear = np.where(colour < 0.04045, colour / 12.92, ((colour + 0.055) / 1.055) ** 2.4)
    return np.column_stack([linear, stored[:, 3]])


def rows_of(asked, new_values):
    """The new vertices' rows by the attribute's key, as bmesh takes them: bytes as 0 to 1."""
    rows, first = {}, 0
    for attribute in asked.attributes:
        width = attribute.rows.shape[1]
        own = new_values[:, first : first + width]
        rows[attribute.key] = own / 255 if attribute.kind == "BYTE_COLOR" else own
        first += width
    return rows
