# SPDX-License-Identifier: GPL-3.0-or-later
"""What a fill is copied from and where it passes: the operator's properties for it, and what they ask of
the library."""

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from . import mesh_data
from .session import NothingToFill

OF_FACES = ("GROUP", "SELECTED")
OF_OTHERS = ("OBJECT", "COLLECTION")


class Guided:
    """Properties of the operator. Those that name something are not remembered: the next call may be for a
    mesh, or a file, without it."""

    source: EnumProperty(
        name="Copy From",
        items=[
            ("MESH", "Whole Mesh", "Continue what any place on the mesh shows"),
            ("GROUP", "Vertex Group", "Copy only from faces in a vertex group"),
            ("SELECTED", "Selected Faces", "Copy only from the faces that are selected in Edit Mode. "
             "Fills the holes that the selection touches, or all if it touches none"),
            ("OBJECT", "Another Object", "Copy only from another object, e.g. an intact twin, wherever it "
             "stands and however it is turned"),
            ("COLLECTION", "Collection", "Copy only from the mesh objects of a collection, from each what "
             "serves"),
        ],
        default="MESH",
        options={"SKIP_SAVE"},
    )
    source_group: StringProperty(name="Group", description="Vertex group to copy from")
    source_object: StringProperty(name="Object", description="Mesh object to copy from")
    source_collection: StringProperty(
        name="Collection", description="Collection whose mesh objects are copied from"
    )
    source_inverted: BoolProperty(
        name="All But These",
        description="Copy from all faces of the mesh but these",
        default=False,
        options={"SKIP_SAVE"},
    )
    source_and_mesh: BoolProperty(
        name="And the Mesh",
        description="Copy from the mesh itself, too",
        default=False,
        options={"SKIP_SAVE"},
    )
    place: EnumProperty(
        name="Place",
        items=[
            ("SEARCH", "Search", "Copy to the hole what fits it best"),
            ("STAND", "By Hand", "Copy what was put over the hole by hand, as it stands: another object, or "
             "the mesh itself as it would stand in the place of an object. Fill one hole at a time"),
            ("ALIGN", "By Hand, Aligned", "The same, moved so that it fits what is known around the hole"),
        ],
        default="SEARCH",
        options={"SKIP_SAVE"},
    )
    place_object: StringProperty(
        name="Like Object",
        description="The mesh is copied as if it stood where this object stands: a duplicate of it that was "
        "moved over the hole, or an Empty in the place of its origin",
        options={"SKIP_SAVE"},
    )
    candidate: IntProperty(
        name="Candidate",
        description="Copy from one place alone: 1 is the best, 2 the second. 0 for all of them together",
        default=0,
        min=0,
        soft_max=9,
    )
    least_scale: FloatProperty(
        name="Scale From",
        description="What is copied may be scaled by this factor or more. The wider the range, the slower; "
        "from 1 to 1 nothing is scaled",
        default=1.0,
        min=0.001,
        max=1000.0,
        soft_min=0.1,
        soft_max=10.0,
    )
    greatest_scale: FloatProperty(
        name="To",
        description="What is copied may be scaled by this factor or less",
        default=1.0,
        min=0.001,
        max=1000.0,
        soft_min=0.1,
        soft_max=10.0,
    )
    mirror: BoolProperty(
        name="Allow Mirroring",
        description="Copy mirrored places, too. Off: for lettering, and whatever has a handedness",
        default=True,
    )
    part: BoolProperty(
        name="Missing Part",
        description="For a part that is missing whole, as a hand or a foot: the fill is what lies over the "
        "hole of what is copied, its vertices and its faces",
        default=False,
        options={"SKIP_SAVE"},
    )
    loose_group: StringProperty(
        name="Loose Rim",
        description="Vertex group: at those of its vertices that lie on a rim the fill need only be joined to the rim, not continue the "
        "surface there. For an edge that was sharp, or a border to something else",
        options={"SKIP_SAVE"},
    )
    initial_object: StringProperty(
        name="Start From",
        description="Mesh object that is this one with its holes filled by other means, e.g. a duplicate "
        "filled with Grid Fill and sculpted: the fill starts from there, not from a smooth one",
        options={"SKIP_SAVE"},
    )
    points_object: StringProperty(
        name="Through Points",
        description="Mesh object whose vertices lie inside holes: the fill passes through them",
        options={"SKIP_SAVE"},
    )
    softness: FloatProperty(
        name="Softness",
        description="How far the fill may stay off the points, for noisy ones. 0: it passes through them. "
        "0.1: a bump over the whole hole comes out half as high",
        default=0.0,
        min=0.0,
        max=1.0,
    )

    def draw_guidance(self, context, layout):
        layout.prop(self, "source")
        if self.source == "GROUP" and context.active_object:
            layout.prop_search(self, "source_group", context.active_object, "vertex_groups")
        elif self.source == "OBJECT":
            layout.prop_search(self, "source_object", bpy.data, "objects")
        elif self.source == "COLLECTION":
            layout.prop_search(self, "source_collection", bpy.data, "collections")
        if self.source in OF_FACES:
            layout.prop(self, "source_inverted")
        elif self.source in OF_OTHERS and self.place == "SEARCH":
            layout.prop(self, "source_and_mesh")
        layout.prop(self, "place")
        if self.place == "SEARCH":
            layout.prop(self, "candidate")
            column = layout.column(align=True)
            column.prop(self, "least_scale")
            column.prop(self, "greatest_scale")
            layout.prop(self, "mirror")
        elif self.source not in OF_OTHERS:
            layout.prop_search(self, "place_object", bpy.data, "objects")
        layout.prop(self, "part")
        if context.active_object:
            layout.prop_search(self, "loose_group", context.active_object, "vertex_groups")
        layout.prop_search(self, "initial_object", bpy.data, "objects")
        layout.prop_search(self, "points_object", bpy.data, "objects")
        if self.points_object:
            layout.prop(self, "softness")

    @property
    def of_others_alone(self):
        """Whether other objects are copied from and the mesh is not. What was put over the hole by hand is the
        only copy."""
        return not self.source_and_mesh or self.place != "SEARCH"

    def others(self, ob):
        """The objects that are copied from, if they are not the mesh's own."""
        if self.source == "OBJECT":
            other = bpy.data.objects.get(self.source_object)
            if other is None or other.type != "MESH" or other.data == ob.data:
                raise NothingToFill("Choose another mesh object to copy from")
            return [other]
        if self.source == "COLLECTION":
            collection = bpy.data.collections.get(self.source_collection)
            if collection is None:
                raise NothingToFill("Choose a collection to copy from")
            others = [o for o in collection.all_objects if o.type == "MESH" and o.data != ob.data]
            if not others:
                raise NothingToFill(f"The collection '{collection.name}' has no other mesh object")
            return sorted(others, key=lambda other: other.name)
        return []

    def sources(self, ob, arrays, others):
        """The library's arguments for what may be copied from."""
        if others:
            return mesh_data.object_sources(ob, arrays, others, self.of_others_alone)
        if self.source not in OF_FACES:
            return {}
        if arrays.is_cloud:
            raise NothingToFill("Points have no faces to choose: copy from the whole mesh or another object")
        if self.source == "GROUP":
            faces = mesh_data.faces_of_group(ob, arrays, self.source_group)
        else:
            faces = mesh_data.selected_faces(ob, arrays)
        if self.source_inverted:
            faces = ~faces
            if not faces.any():
                raise NothingToFill("No face is left to copy from")
        return {"source_faces": faces}

    def guidance(self, ob, others):
        """The library's arguments for where it is copied to; for coherent fills."""
        part = {"part": True} if self.part else {}
        if self.place == "SEARCH":
            asked = {"candidate": self.candidate, **part}
            if (self.least_scale, self.greatest_scale) != (1.0, 1.0):
                asked["scale_range"] = (self.least_scale, self.greatest_scale)
            return asked
        if others:
            matrix = np.eye(3, 4)  # they are given as they stand
        else:
            like = bpy.data.objects.get(self.place_object)
            if like is None or like == ob:
                raise NothingToFill(
                    "Choose the object in whose place the mesh is to be copied: a duplicate that was moved "
                    "over the hole, or an Empty"
                )
            matrix = mesh_data.seen_from(ob, like)[:3]
        return {"placement": matrix, "refine": self.place == "ALIGN", **part}

    def rims(self, ob, arrays):
        """The library's arguments for where fills end and what they start from."""
        asked = {}
        if self.loose_group:
            asked["loose_vertices"] = mesh_data.vertices_of_group(ob, self.loose_group, "be loose")
        if self.initial_object:
            other = bpy.data.objects.get(self.initial_object)
            if other is None or other.type != "MESH" or other.data == ob.data:
                raise NothingToFill("Choose another mesh object to start from: this one, filled by other means")
            asked |= mesh_data.initial(ob, arrays, other)
        if arrays.is_cloud and (asked or self.part):
            raise NothingToFill("Points have no loose rim, no missing part and no mesh to start from")
        return asked

    def points(self, ob):
        """The library's arguments for what fills pass through."""
        if not self.points_object:
            return {}
        other = bpy.data.objects.get(self.points_object)
        if other is None or other.type != "MESH" or other == ob:
            raise NothingToFill("Choose another mesh object whose vertices the fill passes through")
        places = mesh_data.places_of(ob, other)
        if not len(places):
            raise NothingToFill(f"'{other.name}' has no vertex for the fill to pass through")
        return {"constraint_points": places, "softness": self.softness}
