"""How the library is found, and that the layer says what the C header says."""

import ctypes
import os
import pathlib
import re
import shutil
import subprocess
import sys

import complete_mesh
import pytest
from complete_mesh import _abi
from conftest import ROOT

HEADER = (ROOT / "include" / "complete_mesh.h").read_text()
CODE = re.sub(r"//.*", "", HEADER)
LIBRARY = pathlib.Path(complete_mesh.library_path())
PACKAGE = pathlib.Path(complete_mesh.__file__).parent
FILL = """
import complete_mesh as m
r = m.complete_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2]])
print(m.library_path(), len(r.faces))
"""


def run(package, code=FILL, **variables):
    """Python in a process of its own, with a package from there."""
    environment = {k: v for k, v in os.environ.items() if not k.startswith("COMPLETE_MESH")}
    environment |= {"PYTHONPATH": str(package.parent), **variables}
    return subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False
    )


@pytest.fixture
def bare(tmp_path):
    """The package without the library beside it."""
    folder = tmp_path / "bare" / "complete_mesh"
    shutil.copytree(PACKAGE, folder, ignore=shutil.ignore_patterns("*.so", "__pycache__"))
    return folder


def test_beside_the_package():
    done = run(PACKAGE)
    assert done.stdout.split() == [str(LIBRARY), "4"], done.stderr
    assert LIBRARY.parent == PACKAGE


def test_named_by_the_variable(bare, tmp_path):
    other = tmp_path / "other.so"
    shutil.copyfile(LIBRARY, other)
    for package in (bare, PACKAGE):  # it wins over the one beside the package
        done = run(package, COMPLETE_MESH_LIBRARY=str(other))
        assert done.stdout.split() == [str(other), "4"], done.stderr


def test_on_the_system(bare, tmp_path):
    installed = tmp_path / f"libcomplete_mesh.so.{_abi.ABI_VERSION}"
    shutil.copyfile(LIBRARY, installed)
    done = run(bare, LD_LIBRARY_PATH=str(tmp_path))
    assert done.stdout.split() == [installed.name, "4"], done.stderr


def test_nowhere(bare):
    # Importing works: a host may want to show the trouble when it is used.
    assert run(bare, "import complete_mesh").returncode == 0
    done = run(bare)
    assert done.returncode == 1 and "LibraryNotFound" in done.stderr
    assert "COMPLETE_MESH_LIBRARY" in done.stderr


@pytest.mark.parametrize("what", ["missing", "text", "other library"])
def test_wrong_file(bare, tmp_path, what):
    path = tmp_path / "wrong.so"
    if what == "text":
        path.write_text("no library")
    elif what == "other library":
        path = pathlib.Path("libc.so.6")
    done = run(bare, COMPLETE_MESH_LIBRARY=str(path))
    assert done.returncode == 1 and "LibraryNotFound" in done.stderr and path.name in done.stderr


def test_other_abi(bare, tmp_path):
    source, path = tmp_path / "abi.c", tmp_path / "abi.so"
    source.write_text("unsigned complete_mesh_abi_version(void) { return 12345; }\n")
    subprocess.run(["cc", "-shared", "-o", path, source], check=True)
    done = run(bare, COMPLETE_MESH_LIBRARY=str(path))
    assert "LibraryNotFound" in done.stderr and "ABI 12345" in done.stderr


def test_versions_are_one():
    version = re.search(r'^version = "(.*)"', (ROOT / "Cargo.toml").read_text(), re.M)[1]
    assert complete_mesh.__version__ == complete_mesh.library_version() == version
    assert int(re.search(r"define COMPLETE_MESH_ABI_VERSION (\d+)", HEADER)[1]) == _abi.ABI_VERSION


ENUMS = {
    "complete_mesh_vertex_type": ("f32", "f64"),
    "complete_mesh_method": _abi.METHODS,
    "complete_mesh_fairing": _abi.FAIRINGS,
    "complete_mesh_sizing": _abi.SIZINGS,
    "complete_mesh_grouping": _abi.GROUPINGS,
    "complete_mesh_selection": _abi.SELECTIONS,
    "complete_mesh_hole_kind": _abi.HOLE_KINDS,
    "complete_mesh_hole_status": _abi.HOLE_STATUSES,
    "complete_mesh_element_kind": ("vertex", "edge", "face", "hole"),
    "complete_mesh_output": ("whole_mesh", "new_only"),
}


@pytest.mark.parametrize("name", ENUMS)
def test_enum_is_that_of_the_header(name):
    body = re.search(rf"enum {name} {{(.*?)}}", CODE, re.S)[1]
    values = re.findall(rf"{name.upper()}_(\w+) = (-?\d+)", body)
    assert [(word.lower(), int(number)) for word, number in values] == [
        (word, number) for number, word in enumerate(ENUMS[name])
    ]


def test_statuses_are_those_of_the_header():
    body = re.search(r"enum complete_mesh_status {(.*?)}", CODE, re.S)[1]
    values = {w: int(n) for w, n in re.findall(r"COMPLETE_MESH_STATUS_(\w+) = (-?\d+)", body)}
    assert values.pop("OK") == 0
    assert values == {status.name: int(status) for status in complete_mesh.Status}


C_TYPES = {
    "uint32_t": ctypes.c_uint32,
    "size_t": ctypes.c_size_t,
    "double": ctypes.c_double,
    "const uint32_t *": ctypes.c_void_p,
    "const uint8_t *": ctypes.c_void_p,
    "const double *": ctypes.c_void_p,
    "const void *": ctypes.c_void_p,
    "void *": ctypes.c_void_p,
    "complete_mesh_progress_fn": _abi.PROGRESS,
}
STRUCTS = {
    "complete_mesh_options": _abi.Options,
    "complete_mesh_hole": _abi.Hole,
    "complete_mesh_source": _abi.Source,
}


@pytest.mark.parametrize("name", STRUCTS)
def test_struct_is_that_of_the_header(name):
    body = re.search(rf"struct {name} {{(.*?)}}", CODE, re.S)[1]
    fields = re.findall(r"^\s*(.*?)(\w+)(?:\[(\d+)\])?;", body, re.M)
    said = [
        (field, C_TYPES[kind.strip()] * int(size) if size else C_TYPES[kind.strip()])
        for kind, field, size in fields
    ]
    assert said == STRUCTS[name]._fields_


def test_functions_are_in_the_header():
    declared = {name.removeprefix("complete_mesh").lstrip("_") for name in re.findall(r"(complete_mesh\w*)\(", CODE)}
    assert set(_abi.FUNCTIONS) <= declared
