"""The filter in pymeshlab, whose coordinates are doubles, against the C library.

    python pymeshlab_test.py FILTER LIBRARY MESH
"""

import ctypes
import os
import sys

import numpy as np
import pymeshlab

passed = failed = 0


def check(what, ok):
    global passed, failed
    if ok:
        passed += 1
    else:
        failed += 1
        print("FAILED:", what)


def complete_in_c(path, vertices, faces):
    """The library's own answer, by its default options with double vertices."""
    lib = ctypes.CDLL(path)
    options = ctypes.create_string_buffer(1024)  # zeros beyond what the library knows
    assert lib.complete_mesh_options_init(options, ctypes.c_size_t(1024)) == 0
    np.frombuffer(options, np.uint32)[1] = 1  # vertex_type
    result = ctypes.c_void_p()
    status = lib.complete_mesh(vertices.ctypes.data_as(ctypes.c_void_p), ctypes.c_size_t(len(vertices)),
                               faces.ctypes.data_as(ctypes.c_void_p), ctypes.c_size_t(len(faces)),
                               options, ctypes.byref(result))
    assert status == 0, status

    def array(name, count, kind):
        for function, answer in ((name, ctypes.c_void_p), (count, ctypes.c_size_t)):
            getattr(lib, function).restype = answer
        n = getattr(lib, count)(result)
        data = ctypes.cast(getattr(lib, name)(result), ctypes.POINTER(kind))
        return np.ctypeslib.as_array(data, (n, 3)).copy()
    return (array("complete_mesh_result_vertices", "complete_mesh_result_vertex_count", ctypes.c_double),
            array("complete_mesh_result_faces", "complete_mesh_result_face_count", ctypes.c_uint32))


def main(filter_path, library, mesh):
    pymeshlab.load_plugin(os.path.abspath(filter_path))
    name = "meshing_fill_holes_coherently"
    check("listed", name in pymeshlab.filter_list())
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.load_new_mesh(mesh)
    vertices = np.ascontiguousarray(meshes.current_mesh().vertex_matrix())
    faces = np.ascontiguousarray(meshes.current_mesh().face_matrix().astype(np.uint32))
    said = meshes.apply_filter(name)
    after = meshes.current_mesh()
    expected_vertices, expected_faces = complete_in_c(library, vertices, faces)
    check("something is new", len(expected_vertices) > len(vertices))
    check("positions to the bit", after.vertex_matrix().tobytes() == expected_vertices.tobytes())
    check("faces", np.array_equal(after.face_matrix(), expected_faces))
    check("input first", after.vertex_matrix()[:len(vertices)].tobytes() == vertices.tobytes())
    check("what it says", (said["holes"], said["closed_holes"], said["new_vertices"], said["new_faces"])
          == (1, 1, len(expected_vertices) - len(vertices), len(expected_faces) - len(faces)))
    check("new faces are selected", after.selected_face_number() == len(expected_faces) - len(faces))
    check("closed", meshes.apply_filter("get_topological_measures")["boundary_edges"] == 0)
    try:
        meshes.apply_filter(name, edgescale=100.0)
        check("an error is an exception", False)
    except pymeshlab.PyMeshLabException as error:
        check("an error is an exception with words", "0.05 to 20" in str(error))
    print(f"{passed} passed, {failed} failed")
    return failed > 0


sys.exit(main(*sys.argv[1:]))
