import os
import pathlib
import subprocess

import numpy as np
import pytest
from meshes import column

ROOT = pathlib.Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def broken():
    """A column with two holes."""
    return column()


@pytest.fixture(scope="session")
def program():
    """Runs the command line of this project; gives what it prints."""
    path = os.environ["COMPLETE_MESH_PROGRAM"]

    def run(*arguments):
        command = [path, *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


def pytest_unconfigure(config):
    reporter = config.pluginmanager.get_plugin("terminalreporter")
    if reporter is None:
        return

    def count(*names):
        return sum(len(reporter.stats.get(name, [])) for name in names)

    print(f"{count('passed')} passed, {count('failed', 'error')} failed, {count('skipped')} skipped")


def same(a, b):
    """Equal to the bit, in dtype and shape, too."""
    a, b = np.ascontiguousarray(a), np.ascontiguousarray(b)
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
