"""Installs an archive as a user does, fills, and takes it away again.

test_install.py legacy|extension ARCHIVE, with an empty user folder of Blender."""

import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
sys.dont_write_bytecode = True

import bpy  # noqa: E402, I001 - before addon_utils, which comes with it
import addon_utils  # noqa: E402
import checks  # noqa: E402
import numpy as np  # noqa: E402
import scenes  # noqa: E402
from checks import check  # noqa: E402

KIND, ARCHIVE = sys.argv[-2:]
NAME = "fill_hole_coherently"
MODULE = NAME if KIND == "legacy" else f"bl_ext.user_default.{NAME}"


def install():
    if KIND == "legacy":
        bpy.ops.preferences.addon_install(filepath=ARCHIVE, overwrite=True)
        return bpy.ops.preferences.addon_enable(module=NAME)
    return bpy.ops.extensions.package_install_files(
        filepath=ARCHIVE, repo="user_default", enable_on_install=True, overwrite=True
    )


def there():
    return hasattr(bpy.types, "MESH_OT_fill_hole_coherently")


def test_install():
    check("not there before", not there())
    check("installs", install() == {"FINISHED"})
    check("is enabled", MODULE in bpy.context.preferences.addons.keys())
    check("operator is there", there())
    module = sys.modules[MODULE]
    folder = os.environ["BLENDER_USER_SCRIPTS" if KIND == "legacy" else "BLENDER_USER_RESOURCES"]
    check("in the user's folder", module.__file__.startswith(folder), module.__file__)
    if KIND == "legacy":
        info = addon_utils.module_bl_info(module)
        check("says what it is", (info["name"], info["category"]) == ("Fill Hole Coherently", "Mesh"), info)


def test_fills():
    package = sys.modules[f"{MODULE}.complete_mesh"]
    library = package.library_path()
    check("uses the library that it carries", os.path.dirname(library) == os.path.dirname(package.__file__))
    ob = scenes.column()
    before = scenes.snapshot(ob)
    faces, _ = scenes.triangles(ob.data)
    rows, _ = scenes.values(ob.data)
    carried = {"vertex_values": rows, "steering_channels": 3}
    result = package.complete_mesh(scenes.positions(ob.data), faces, **carried)
    check("fills", bpy.ops.mesh.fill_hole_coherently() == {"FINISHED"})
    check("what was there is as it was", not scenes.kept(before, scenes.snapshot(ob)))
    places = scenes.positions(ob.data)[len(before["positions"]) :]
    check("new coordinates", len(places) > 100 and np.array_equal(places, result.new_vertices))


def test_remove():
    bpy.ops.preferences.addon_disable(module=MODULE)
    check("gone when it is disabled", not there())


checks.run([test_install, test_fills, test_remove])
sys.exit(checks.close())
