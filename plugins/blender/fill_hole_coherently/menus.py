# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the operator is found, beside F3."""

import bpy

OPERATOR = "mesh.fill_hole_coherently"
MENUS = ("VIEW3D_MT_edit_mesh_faces", "VIEW3D_MT_edit_mesh_clean", "VIEW3D_MT_object")


def draw(self, _context):
    self.layout.separator()
    # A menu may have another context, in which the operator would block the window.
    self.layout.operator_context = "INVOKE_DEFAULT"
    self.layout.operator(OPERATOR)


class VIEW3D_PT_fill_hole_coherently(bpy.types.Panel):
    bl_label = "Fill Hole Coherently"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Edit"

    @classmethod
    def poll(cls, context):
        return context.mode in {"OBJECT", "EDIT_MESH"}

    def draw(self, context):
        column = self.layout.column()
        column.operator_context = "INVOKE_DEFAULT"
        if context.mode == "EDIT_MESH":
            column.label(text="Holes at the selection,")
            column.label(text="or all if nothing is selected")
        else:
            column.label(text="All holes of the active object")
        column.operator(OPERATOR, icon="MOD_REMESH")
        if context.mode == "EDIT_MESH":
            # Where the selection touches no hole, no redo panel comes up in which to choose this.
            column.operator(OPERATOR, text="Fill From Selected Faces").source = "SELECTED"


def add():
    for menu in MENUS:
        getattr(bpy.types, menu).append(draw)


def remove():
    for menu in MENUS:
        getattr(bpy.types, menu).remove(draw)
