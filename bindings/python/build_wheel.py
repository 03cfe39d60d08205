#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Makes a wheel that carries the stripped library: py3-none-PLATFORM.

    build_wheel.py [--library FILE] [--out DIR]

    --library FILE   the shared library; without it, cargo builds one
    --out DIR        where the wheel goes; default target/python/dist

Needs pip, and strip and readelf (binutils) on Linux. Windows and macOS are not tested.
"""

import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
NAMES = {"win32": "complete_mesh.dll", "darwin": "libcomplete_mesh.dylib"}
NAME = NAMES.get(sys.platform, "libcomplete_mesh.so")

# What PEP 600 lets a manylinux wheel expect of every system, as far as Rust may ask for it.
EVERYWHERE = re.compile(r"(libc|libm|libdl|librt|libpthread|libgcc_s|ld-linux.*)\.so\.\d+$")


def build_library() -> pathlib.Path:
    command = ["cargo", "build", "--release", "--lib", "--no-default-features", "--features", "capi"]
    subprocess.run(command, cwd=ROOT, check=True)
    return TARGET / "release" / NAME


def platform_tag(library: pathlib.Path) -> str:
    """The oldest systems that the library runs on: manylinux with the newest version of glibc that
    any of its symbols asks for, or plain linux if it needs a library that not every system has."""
    here = re.sub(r"[-.]", "_", sysconfig.get_platform())
    if not here.startswith("linux_"):
        return here
    text = readelf("--version-info", "--dynamic", library)
    needed = re.findall(r"\(NEEDED\).*\[(.*)\]", text)
    versions = re.findall(r"Name: GLIBC_(\d+)\.(\d+)", text)
    if not versions or not all(EVERYWHERE.match(name) for name in needed):
        return here
    major, minor = max((int(major), int(minor)) for major, minor in versions)
    return here.replace("linux_", f"manylinux_{major}_{minor}_", 1)


def readelf(*arguments: object) -> str:
    command = ["readelf", "--wide", *map(str, arguments)]
    environment = {**os.environ, "LC_ALL": "C"}
    return subprocess.run(command, env=environment, check=True, capture_output=True, text=True).stdout


def put_library(library: pathlib.Path, folder: pathlib.Path) -> None:
    """Copies the library without what only debuggers read: a fortieth of the size."""
    to = folder / NAME
    shutil.copyfile(library, to)
    if sys.platform.startswith("linux"):
        subprocess.run(["strip", "--strip-unneeded", to], check=True)
    elif sys.platform == "darwin":
        subprocess.run(["strip", "-x", to], check=True)


def put_package(folder: pathlib.Path, library: pathlib.Path) -> None:
    """The package as it is installed, library included. The Blender add-on carries it, too."""
    folder.mkdir(parents=True)
    for file in sorted((HERE / "complete_mesh").iterdir()):
        if file.suffix == ".py" or file.name == "py.typed":
            shutil.copyfile(file, folder / file.name)
    put_library(library, folder)


def main() -> None:
    arguments = argparse.ArgumentParser(description="Makes a wheel that carries the library.")
    arguments.add_argument("--library", type=pathlib.Path)
    arguments.add_argument("--out", type=pathlib.Path, default=TARGET / "python" / "dist")
    given = arguments.parse_args()

    library = given.library or build_library()
    stage = TARGET / "python" / "stage"
    shutil.rmtree(stage, ignore_errors=True)
    put_package(stage / "complete_mesh", library)
    for file in ("pyproject.toml", "setup.py"):
        shutil.copyfile(HERE / file, stage / file)
    for file in ("LICENSE-MIT", "LICENSE-APACHE"):
        shutil.copyfile(ROOT / file, stage / file)
    shutil.copyfile(ROOT / "docs" / "python.md", stage / "README.md")

    tag = platform_tag(stage / "complete_mesh" / NAME)
    given.out.mkdir(parents=True, exist_ok=True)
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", given.out]
    option = f"--config-settings=--build-option=--plat-name={tag}"
    subprocess.run([*map(str, command), option, str(stage)], check=True)
    print(next(given.out.glob(f"complete_mesh-*-py3-none-{tag}.whl")))


if __name__ == "__main__":
    main()
