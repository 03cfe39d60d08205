#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the add-on's two archives for this platform, with the library inside:

    fill_hole_coherently-VERSION-PLATFORM-legacy.zip      Blender 3.4 to 4.1: Preferences > Add-ons > Install
    fill_hole_coherently-VERSION-PLATFORM-extension.zip   Blender 4.2 and later: drag it into the window

    build.py [--library FILE] [--out DIR]

    --library FILE   the shared library; without it, cargo builds one
    --out DIR        where the archives go; default target/blender/dist

The folder that Blender's own `extension build` takes is left beside them, as OUT/fill_hole_coherently.
"""

import argparse
import pathlib
import platform
import re
import shutil
import sys
import zipfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
NAME = "fill_hole_coherently"

sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "bindings" / "python"))
import build_wheel  # noqa: E402 - it builds the package that the add-on carries

SYSTEMS = {"linux": "linux", "darwin": "macos", "win32": "windows"}
MACHINES = {"x86_64": "x64", "amd64": "x64", "aarch64": "arm64", "arm64": "arm64"}


def this_platform() -> str:
    """As Blender calls it."""
    return f"{SYSTEMS[sys.platform]}-{MACHINES[platform.machine().lower()]}"


def put_addon(folder: pathlib.Path, library: pathlib.Path) -> str:
    """Everything that is installed; gives the version."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for file in sorted((HERE / NAME).glob("*.py")):
        shutil.copyfile(file, folder / file.name)
    shutil.copyfile(HERE / "LICENSE", folder / "LICENSE")
    manifest = (HERE / NAME / "blender_manifest.toml").read_text()
    manifest = re.sub(r"^platforms = .*$", f'platforms = ["{this_platform()}"]', manifest, flags=re.M)
    (folder / "blender_manifest.toml").write_text(manifest)
    build_wheel.put_package(folder / "complete_mesh", library)
    for file in ("LICENSE-MIT", "LICENSE-APACHE"):
        shutil.copyfile(ROOT / file, folder / "complete_mesh" / file)
    return re.search(r'^version = "(.*)"', manifest, re.M)[1]


def pack(folder: pathlib.Path, archive: pathlib.Path, top: str) -> None:
    """A zip with the same bytes whenever it is made from the same files."""
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as made:
        for file in sorted(folder.rglob("*")):
            if file.is_file():
                entry = zipfile.ZipInfo(top + file.relative_to(folder).as_posix())
                entry.external_attr = 0o644 << 16
                entry.compress_type = zipfile.ZIP_DEFLATED
                made.writestr(entry, file.read_bytes())


def main() -> None:
    arguments = argparse.ArgumentParser(description="Makes the add-on's two archives.")
    arguments.add_argument("--library", type=pathlib.Path)
    arguments.add_argument("--out", type=pathlib.Path, default=build_wheel.TARGET / "blender" / "dist")
    given = arguments.parse_args()
    folder = given.out / NAME
    version = put_addon(folder, given.library or build_wheel.build_library())
    # A legacy add-on is a folder in the archive; an extension has its manifest at the top.
    for kind, top in (("legacy", f"{NAME}/"), ("extension", "")):
        archive = given.out / f"{NAME}-{version}-{this_platform()}-{kind}.zip"
        pack(folder, archive, top)
        print(archive)


if __name__ == "__main__":
    main()
