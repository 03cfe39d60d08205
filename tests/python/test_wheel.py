"""The wheel that the tests run from."""

import importlib.metadata
import os
import pathlib
import re
import subprocess
import sys
import zipfile

import numpy as np
import pytest
from conftest import ROOT

WHEEL = pathlib.Path(os.environ["COMPLETE_MESH_WHEEL"])


def test_tag_is_honest():
    """As the tool says that looks after such wheels."""
    pytest.importorskip("auditwheel")
    said = subprocess.run(
        [sys.executable, "-m", "auditwheel", "show", WHEEL], capture_output=True, text=True, check=True
    ).stdout
    tag = re.search(r'platform\s+tag:\s+"(\w+)"', said)[1]
    assert WHEEL.name == f"complete_mesh-0.1.0-py3-none-{tag}.whl", said
    assert "linux" in tag


def test_contents():
    with zipfile.ZipFile(WHEEL) as wheel:
        names = wheel.namelist()
        source = ROOT / "bindings" / "python" / "complete_mesh"
        for file in [*source.glob("*.py"), source / "py.typed"]:
            assert wheel.read(f"complete_mesh/{file.name}") == file.read_bytes()
        library = wheel.read("complete_mesh/libcomplete_mesh.so")
        info = next(name for name in names if name.endswith("/WHEEL"))
        assert b"Root-Is-Purelib: false" in wheel.read(info)
        metadata = wheel.read(info.replace("/WHEEL", "/METADATA")).decode()
        for licence in ("LICENSE-MIT", "LICENSE-APACHE"):
            inside = info.replace("/WHEEL", f"/licenses/{licence}")
            assert wheel.read(inside) == (ROOT / licence).read_bytes()
    assert "License-Expression: MIT OR Apache-2.0" in metadata
    assert (ROOT / "docs" / "python.md").read_text().strip() in metadata
    assert library[:4] == b"\x7fELF" and len(library) < 12_000_000


def test_library_is_stripped(tmp_path):
    with zipfile.ZipFile(WHEEL) as wheel:
        library = wheel.extract("complete_mesh/libcomplete_mesh.so", tmp_path)
    sections = subprocess.run(["readelf", "-SW", library], capture_output=True, text=True, check=True)
    assert ".dynsym" in sections.stdout and ".debug_" not in sections.stdout
    assert ".symtab" not in sections.stdout


def test_installed_from_the_wheel():
    files = {str(file) for file in importlib.metadata.files("complete_mesh")}
    assert {"complete_mesh/libcomplete_mesh.so", "complete_mesh/py.typed"} <= files


def test_only_numpy_is_needed():
    assert importlib.metadata.requires("complete_mesh") == ["numpy>=1.22"]
    code = "import sys, complete_mesh; print(*sorted({m.split('.')[0] for m in sys.modules}))"
    done = subprocess.run([sys.executable, "-Sc", f"import sys; sys.path = {sys.path}\n{code}"],
                          capture_output=True, text=True, check=True)
    allowed = set(sys.stdlib_module_names) | {"numpy", "complete_mesh", "__main__", "mkl"}
    strange = {name for name in done.stdout.split() if name not in allowed and not name.startswith("_")}
    assert strange <= {"cython_runtime"}, strange
    assert np.__name__ == "numpy"


def test_types():
    pytest.importorskip("mypy")
    folder = ROOT / "bindings" / "python"
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--cache-dir", os.devnull, "--config-file", folder / "pyproject.toml"],
        cwd=folder, capture_output=True, text=True, check=False,
    )
    assert done.returncode == 0, done.stdout
