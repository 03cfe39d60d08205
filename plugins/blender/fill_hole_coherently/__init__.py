# SPDX-License-Identifier: GPL-3.0-or-later
"""Fill Hole Coherently: fills holes of a mesh so that the fill continues what the object shows."""

# Read by Blender before 4.2; later ones read blender_manifest.toml.
bl_info = {
    "name": "Fill Hole Coherently",
    "description": "Fill holes so that the fill continues what the object shows",
    "author": "The complete-mesh developers",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Edit Mode > Face and Mesh > Clean Up, Object Mode > Object, Sidebar > Edit",
    "category": "Mesh",
}

import bpy  # noqa: E402 - bl_info must come first: Blender reads it without running the file

from . import menus, operator, session


@bpy.app.handlers.persistent  # or Blender takes it away when it has loaded a file
def forget(*_):
    """Another file: what was kept for the meshes of this one goes."""
    session.forget()


CLASSES = (operator.MESH_OT_fill_hole_coherently, menus.VIEW3D_PT_fill_hole_coherently)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    menus.add()
    bpy.app.handlers.load_pre.append(forget)


def unregister():
    bpy.app.handlers.load_pre.remove(forget)
    menus.remove()
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
    session.forget()
