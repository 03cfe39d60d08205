"""`blender --command extension ...` where there is no program blender but Python with bpy: the
program's own code for it is plain Python."""

import os
import runpy
import sys

import bpy

path = os.path.join(bpy.utils.system_resource("SCRIPTS"), "addons_core", "bl_pkg", "cli", "blender_ext.py")
sys.argv[0] = path
runpy.run_path(path, run_name="__main__")
