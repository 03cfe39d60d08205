"""The examples of docs/python.md, as they stand there."""

import importlib.util
import re
import subprocess
import sys

import numpy as np
import pytest
from complete_mesh import complete_mesh
from conftest import ROOT
from meshes import column, write_ply

TEXT = (ROOT / "docs" / "python.md").read_text()
EXAMPLES = re.findall(r"```python\n(.*?)```", TEXT, re.S)


def imported(code):
    return re.findall(r"^(?:import|from) (\w+)", code, re.M)


@pytest.mark.parametrize("code", EXAMPLES, ids=lambda code: f"{imported(code)[0]}-{hash(code) % 997}")
def test_example(code, tmp_path):
    for name in imported(code):
        if importlib.util.find_spec(name) is None:
            pytest.skip(f"{name} is not installed")
    vertices, faces = column()
    vertices = vertices.astype(np.float32)
    write_ply(tmp_path / "scan.ply", vertices, faces)
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    if "whole.ply" in code:
        check_whole(tmp_path / "whole.ply", vertices, faces, example_is_double(code))
    else:
        assert done.stdout.strip()
    if "moved copies" in code:
        numbers = [float(n) for n in re.findall(r"[\d.]+(?:e-\d+)?", done.stdout)]
        assert 0 < numbers[0] < 0.1 and numbers[0] < numbers[1] < 0.25
    if "lowest source" in code:
        lowest, middle = (float(n) for n in re.findall(r"-?[\d.]+(?:e-\d+)?", done.stdout))
        assert lowest >= middle
    if "Cancelled" in code:
        assert done.stdout.splitlines()[-1] == "cancelled"


def example_is_double(code):
    """These keep positions as double, and so fill in double."""
    return "open3d" in code or "trimesh" in code


def check_whole(path, vertices, faces, double):
    import meshio

    written = meshio.read(path)
    reference = complete_mesh(vertices.astype(np.float64 if double else np.float32), faces)
    assert np.array_equal(written.cells_dict["triangle"], reference.faces)
    # trimesh writes float32 whatever it has.
    expected = reference.vertices.astype(written.points.dtype)
    assert np.array_equal(written.points, expected)
    assert np.array_equal(written.points[: len(vertices)], vertices)


def test_there_is_an_example_for_each_package():
    names = {name for code in EXAMPLES for name in imported(code)}
    assert {"trimesh", "open3d", "pyvista", "meshio"} <= names
