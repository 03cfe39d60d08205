"""The add-on in a real Blender, on real buffers. The same script for `blender -b -P` and for Python
with bpy; the folder with the built add-on is the last argument."""

import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, sys.argv[-1]]
sys.dont_write_bytecode = True

import bpy  # noqa: E402
import checks  # noqa: E402
import fill_hole_coherently as addon  # noqa: E402
import test_edit  # noqa: E402
import test_fill  # noqa: E402
import test_guidance  # noqa: E402
import test_modal  # noqa: E402
import test_painted  # noqa: E402
import test_points  # noqa: E402
import test_rims  # noqa: E402
import test_sources  # noqa: E402
import test_trouble  # noqa: E402
import test_undo  # noqa: E402
from checks import check  # noqa: E402
from fill_hole_coherently import menus  # noqa: E402


def drawn(menu):
    return menus.draw in getattr(bpy.types, menu)._dyn_ui_initialize()


def test_registered():
    check("operator is there", hasattr(bpy.types, "MESH_OT_fill_hole_coherently"))
    label = bpy.ops.mesh.fill_hole_coherently.get_rna_type().name
    check("F3 finds it by its name", label == "Fill Hole Coherently", label)
    check("sidebar panel is there", hasattr(bpy.types, "VIEW3D_PT_fill_hole_coherently"))
    for menu in menus.MENUS:
        check(f"in {menu}", drawn(menu))


def test_unregistered():
    addon.unregister()
    check("operator is gone", not hasattr(bpy.types, "MESH_OT_fill_hole_coherently"))
    check("panel is gone", not hasattr(bpy.types, "VIEW3D_PT_fill_hole_coherently"))
    for menu in menus.MENUS:
        check(f"not in {menu}", not drawn(menu))
    addon.register()
    check("operator is back", hasattr(bpy.types, "MESH_OT_fill_hole_coherently"))
    addon.unregister()


print(f"Blender {bpy.app.version_string}, Python {sys.version.split()[0]}", flush=True)
addon.register()
checks.run([test_registered])
for module in (
    test_fill,
    test_painted,
    test_points,
    test_sources,
    test_guidance,
    test_rims,
    test_edit,
    test_undo,
    test_trouble,
    test_modal,
):
    checks.run([f for name, f in vars(module).items() if name.startswith("test_")])
checks.run([test_unregistered])
sys.exit(checks.close())
