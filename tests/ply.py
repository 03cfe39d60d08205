"""Reads, colours and compares PLY files for the tests of the hosts; needs nothing but Python 3.

    ply.py colour IN OUT          gives each vertex a colour that depends on where it is
    ply.py compare A B [OLD]      positions to the bit, faces up to which corner is first, and, where
                                  both files have colours, those within 1; with OLD, also that A has
                                  the vertices and faces of OLD first, in order
"""

import struct
import sys

TYPES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I",
         "float": "f", "double": "d", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H",
         "int32": "i", "uint32": "I", "float32": "f", "float64": "d"}


class Mesh:
    def __init__(self, path):
        self.data = open(path, "rb").read()
        self.columns = {}
        self.faces = []
        elements, ascii_file = self._header()
        self._tokens = iter(self.data[self.at:].split()) if ascii_file else None
        for name, count, properties in elements:
            for _ in range(count):
                row = {p: self._value(kind) for p, kind in properties}
                if name == "vertex":
                    for key, value in row.items():
                        self.columns.setdefault(key, []).append(value)
                elif name == "face":
                    self.faces.append(row.get("vertex_indices", row.get("vertex_index")))
        self.points = list(zip(*(self.columns[k] for k in "xyz")))
        self.colours = None
        if "red" in self.columns:
            self.colours = list(zip(*(self.columns[k] for k in ("red", "green", "blue"))))

    def _header(self):
        end = self.data.index(b"end_header")
        self.at = self.data.index(b"\n", end) + 1
        elements, ascii_file = [], False
        for line in self.data[:end].decode().split("\n"):
            words = line.split()
            if words[:1] == ["format"]:
                ascii_file = words[1] == "ascii"
                assert words[1] != "binary_big_endian"
            elif words[:1] == ["element"]:
                elements.append((words[1], int(words[2]), []))
            elif words[:2] == ["property", "list"]:
                elements[-1][2].append((words[4], (TYPES[words[2]], TYPES[words[3]])))
            elif words[:1] == ["property"]:
                elements[-1][2].append((words[2], TYPES[words[1]]))
        return elements, ascii_file

    def _value(self, kind):
        if isinstance(kind, tuple):
            return tuple(self._value(kind[1]) for _ in range(self._value(kind[0])))
        if self._tokens is not None:
            token = next(self._tokens)
            if kind == "f":  # as a reader that stores floats has it
                return struct.unpack("<f", struct.pack("<f", float(token)))[0]
            return float(token) if kind == "d" else int(token)
        value = struct.unpack_from("<" + kind, self.data, self.at)[0]
        self.at += struct.calcsize(kind)
        return value


def bits(point):
    return struct.pack("<3f", *point)


def turned(face):
    """A face from its smallest corner on: which corner is first does not matter."""
    k = face.index(min(face))
    return face[k:] + face[:k]


def colour(path, out):
    mesh = Mesh(path)
    low = [min(c) for c in zip(*mesh.points)]
    high = [max(c) for c in zip(*mesh.points)]
    with open(out, "wb") as f:
        f.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(mesh.points))
        f.write(b"".join(b"property float %c\n" % c for c in b"xyz"))
        f.write(b"".join(b"property uchar %s\n" % c for c in (b"red", b"green", b"blue", b"alpha")))
        f.write(b"element face %d\nproperty list uchar int vertex_indices\nend_header\n"
                % len(mesh.faces))
        for p in mesh.points:
            rgb = (int(20 + 200 * (x - a) / (b - a)) for x, a, b in zip(p, low, high))
            f.write(struct.pack("<3f4B", *p, *rgb, 255))
        for face in mesh.faces:
            f.write(struct.pack("<B3i", 3, *face))


def compare(path_a, path_b, old_path=None):
    a, b = Mesh(path_a), Mesh(path_b)
    assert len(a.points) == len(b.points), (len(a.points), len(b.points))
    wrong = [i for i, (p, q) in enumerate(zip(a.points, b.points)) if bits(p) != bits(q)]
    assert not wrong, f"{len(wrong)} positions differ, the first is vertex {wrong[0]}: " \
        f"{a.points[wrong[0]]} and {b.points[wrong[0]]}"
    assert len(a.faces) == len(b.faces), (len(a.faces), len(b.faces))
    wrong = [i for i, (f, g) in enumerate(zip(a.faces, b.faces)) if turned(f) != turned(g)]
    assert not wrong, f"{len(wrong)} faces differ, the first is {wrong[0]}"
    if a.colours and b.colours:
        wrong = [i for i, (c, d) in enumerate(zip(a.colours, b.colours))
                 if max(abs(x - y) for x, y in zip(c, d)) > 1]
        assert not wrong, f"{len(wrong)} colours differ, the first is vertex {wrong[0]}: " \
            f"{a.colours[wrong[0]]} and {b.colours[wrong[0]]}"
    if old_path:
        old = Mesh(old_path)
        n, m = len(old.points), len(old.faces)
        assert n < len(a.points) and m < len(a.faces), "nothing is new"
        assert list(map(bits, old.points)) == list(map(bits, a.points[:n]))
        assert list(map(turned, old.faces)) == list(map(turned, a.faces[:m]))
        if old.colours and a.colours:
            assert old.colours == a.colours[:n]
    print(f"{len(a.points)} vertices, {len(a.faces)} faces agree")


if __name__ == "__main__":
    {"colour": colour, "compare": compare}[sys.argv[1]](*sys.argv[2:])
