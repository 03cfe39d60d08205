# SPDX-License-Identifier: MIT OR Apache-2.0
"""Finds and loads the shared library, on first use."""

from __future__ import annotations

import ctypes as c
import ctypes.util
import os
import sys
import threading
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _abi
from ._errors import Cancelled, CompleteMeshError, LibraryNotFound, Status

VARIABLE = "COMPLETE_MESH_LIBRARY"

_lock = threading.Lock()
_loaded: Library | None = None


class Library:
    """The functions of the header, by their names without the prefix; ``complete`` is the one
    that has no other name. The GIL is released while a call lasts."""

    def __init__(self, path: str) -> None:
        self.path = path
        try:
            dll = c.CDLL(path)
        except OSError as error:
            raise LibraryNotFound(f"cannot load the complete-mesh library {path}: {error}") from None
        try:
            abi = int(dll.complete_mesh_abi_version())
        except AttributeError:
            raise LibraryNotFound(f"{path} is not the complete-mesh library") from None
        if abi != _abi.ABI_VERSION:
            raise LibraryNotFound(
                f"{path} has ABI {abi}, but this package needs ABI {_abi.ABI_VERSION}: "
                "install package and library of one version"
            )
        for name, (result, arguments) in _abi.FUNCTIONS.items():
            function = getattr(dll, f"complete_mesh_{name}" if name else "complete_mesh")
            function.restype, function.argtypes = result, arguments
            setattr(self, name or "complete", function)

    def __getattr__(self, name: str) -> Any:  # set in __init__; this is for type checkers
        raise AttributeError(name)

    def check(self, status: int) -> None:
        """Raises what the last call on this thread complained about."""
        if status == 0:
            return
        message = self.last_error_message().decode()
        kind = Cancelled if status == Status.CANCELLED else CompleteMeshError
        raise kind(
            status,
            message or self.status_name(status).decode(),
            *(
                self.list(self.last_error_elements, element, width=1 + (element == _abi.EDGE))
                for element in (_abi.VERTEX, _abi.EDGE, _abi.FACE, _abi.HOLE)
            ),
        )

    def list(self, function: Any, *arguments: object, width: int = 1) -> NDArray[np.int64]:
        """An array whose length the function gives with it: (count,), or (count, width)."""
        count = c.c_size_t()
        address = function(*arguments, c.byref(count))
        numbers = copied(address, count.value * width, np.dtype(np.uint32)).astype(np.int64)
        return numbers if width == 1 else numbers.reshape(-1, width)

    def places(self, function: Any, handle: object) -> NDArray[np.float64]:
        """Points whose number the function gives with them: (count, 3)."""
        count = c.c_size_t()
        address = function(handle, c.byref(count))
        return copied(address, count.value * 3, np.dtype(np.float64)).reshape(-1, 3)


def copied(address: int | None, count: int, dtype: np.dtype[Any]) -> NDArray[Any]:
    """A copy of an array of the library; empty for NULL."""
    if not address or not count:
        return np.empty(0, dtype)
    size = count * dtype.itemsize
    # bytearray, not bytes: the array may be written to.
    return np.frombuffer(bytearray((c.c_char * size).from_address(address)), dtype)


def library() -> Library:
    """The library, loaded when it is first asked for."""
    global _loaded
    with _lock:
        if _loaded is None:
            _loaded = Library(_find())
        return _loaded


def library_path() -> str:
    """The path of the shared library in use."""
    return library().path


def library_version() -> str:
    """The version of the shared library in use, e.g. "0.1.0"."""
    version: bytes = library().version_string()
    return version.decode()


def file_name() -> str:
    """What the library is called on this system."""
    if sys.platform == "win32":
        return "complete_mesh.dll"
    return "libcomplete_mesh" + (".dylib" if sys.platform == "darwin" else ".so")


def _find() -> str:
    named = os.environ.get(VARIABLE)
    if named:
        return named
    beside = os.path.join(os.path.dirname(os.path.abspath(__file__)), file_name())
    if os.path.exists(beside):
        return beside
    system = ctypes.util.find_library("complete_mesh")
    if system is None and sys.platform.startswith("linux"):
        # find_library asks ldconfig and compilers, and neither looks at LD_LIBRARY_PATH.
        system = f"libcomplete_mesh.so.{_abi.ABI_VERSION}"
        try:
            c.CDLL(system)
        except OSError:
            system = None
    if system is None:
        raise LibraryNotFound(
            f"the complete-mesh library is not there: looked for {beside} and for "
            f"libcomplete_mesh on the system; {VARIABLE} may name the file"
        )
    return system
