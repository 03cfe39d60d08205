"""Reads, colours and compares PLY files for the tests of the hosts; needs nothing but Python 3.

    ply.py colour IN OUT          gives each vertex a colour, unless it has one, a quality and a normal
                                  that depend on where it is, or on its colour if it had one; the normal
                                  is not the surface's
    ply.py plain IN OUT           positions and faces alone
    ply.py points IN OUT          the same file without its faces
    ply.py scaled IN OUT F        positions times F and faces alone
    ply.py texture IN OUT         an OBJ of it with texture coordinates around the y axis in two charts,
                                  one above the other, each of which meets itself
    ply.py compare A B [OLD]      positions to the bit, faces up to which corner is first, and, where
                                  both files have them, colours within 1 and qualities within 0.0001 of
                                  their range; with OLD, also that A has the vertices and faces of OLD
                                  first, in order, and colours if OLD has some
    ply.py carried A OLD          qualities and normals of OLD are A's, to the bit; new qualities are
                                  between those of OLD, new normals have length 1
    ply.py normals A B [T]        normals agree in their directions, within T, 0.001 by default
    ply.py colouring KIND A P OLD colours of A's new vertices are those of its kind (provenance,
                                  confidence) by the provenance in P, a file of the command line
"""

import math
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
        f.write(b"".join(b"property float n%c\n" % c for c in b"xyz"))
        f.write(b"".join(b"property uchar %s\n" % c for c in (b"red", b"green", b"blue", b"alpha")))
        f.write(b"property float quality\n")
        f.write(b"element face %d\nproperty list uchar int vertex_indices\nend_header\n"
                % len(mesh.faces))
        for i, p in enumerate(mesh.points):
            rgb, quality = [int(20 + 200 * (x - a) / (b - a)) for x, a, b in zip(p, low, high)], p[2]
            if mesh.colours:
                rgb = mesh.colours[i]
                quality = sum(rgb) / 765
            axis = [0.0, 0.0, 0.0]
            axis[int(1000 * abs(p[0])) % 3] = 1.0
            f.write(struct.pack("<6f4Bf", *p, *axis, *rgb, 255, quality))
        for face in mesh.faces:
            f.write(struct.pack("<B3i", 3, *face))


def points(path, out):
    data = open(path, "rb").read()
    head, body = data[: data.index(b"end_header\n")], data[data.index(b"end_header\n") + 11 :]
    kept = head[: head.index(b"element face")]
    sizes = [struct.calcsize(TYPES[w[1]]) for w in map(str.split, kept.decode().split("\n")) if w[:1] == ["property"]]
    with open(out, "wb") as f:
        f.write(kept + b"end_header\n" + body[: len(Mesh(path).points) * sum(sizes)])


def plain(path, out, factor="1"):
    mesh = Mesh(path)
    with open(out, "wb") as f:
        f.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(mesh.points))
        f.write(b"".join(b"property float %c\n" % c for c in b"xyz"))
        f.write(b"element face %d\nproperty list uchar int vertex_indices\nend_header\n"
                % len(mesh.faces))
        f.write(b"".join(bits([float(factor) * x for x in p]) for p in mesh.points))
        f.write(b"".join(struct.pack("<B3i", 3, *face) for face in mesh.faces))


def texture(path, out):
    mesh = Mesh(path)
    turn = [math.atan2(z, x) / (2 * math.pi) for x, _, z in mesh.points]
    middle = sum(y for _, y, _ in mesh.points) / len(mesh.points)
    rows = {}  # once round, and in the other chart, another row
    with open(out, "w") as f:
        for p in mesh.points:
            f.write("v %r %r %r\n" % p)
        for face in mesh.faces:
            low = min(turn[v] for v in face)
            # Less than the size of a face: that they lie near each other does not make them one.
            jump = 0.002 * (sum(mesh.points[v][1] for v in face) / 3 > middle)
            keys = [(v, turn[v] - (turn[v] - low > 0.5) + jump, jump) for v in face]
            for key in keys:
                if key not in rows:
                    rows[key] = len(rows) + 1
                    f.write("vt %.6f %.6f\n" % (key[1], mesh.points[key[0]][1]))
            f.write("f " + " ".join("%d/%d" % (key[0] + 1, rows[key]) for key in keys) + "\n")


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
    if "quality" in a.columns and "quality" in b.columns:
        q, r = a.columns["quality"], b.columns["quality"]
        wrong = [i for i, (x, y) in enumerate(zip(q, r)) if abs(x - y) > 1e-4 * (max(r) - min(r))]
        assert not wrong, f"{len(wrong)} qualities differ, the first is vertex {wrong[0]}: " \
            f"{q[wrong[0]]} and {r[wrong[0]]}"
    if old_path:
        old = Mesh(old_path)
        n, m = len(old.points), len(old.faces)
        # A cloud gets points alone.
        assert n < len(a.points) and m < len(a.faces) + (m == 0), "nothing is new"
        assert list(map(bits, old.points)) == list(map(bits, a.points[:n]))
        assert list(map(turned, old.faces)) == list(map(turned, a.faces[:m]))
        if old.colours:
            assert a.colours and old.colours == a.colours[:n]
    print(f"{len(a.points)} vertices, {len(a.faces)} faces agree")


def carried(path, old_path):
    a, old = Mesh(path), Mesh(old_path)
    n = len(old.points)
    quality, old_quality = a.columns["quality"], old.columns["quality"]
    assert quality[:n] == old_quality
    assert len(quality) > n, "nothing is new"
    assert all(min(old_quality) <= q <= max(old_quality) for q in quality[n:])
    assert len(set(quality[n:])) > 1
    normals = list(zip(*(a.columns[k] for k in ("nx", "ny", "nz"))))
    assert normals[:n] == list(zip(*(old.columns[k] for k in ("nx", "ny", "nz"))))
    assert all(abs(sum(x * x for x in normal) - 1) < 1e-4 for normal in normals[n:])
    # A new vertex is on the same side as its faces.
    def sub(p, q):
        return [x - y for x, y in zip(p, q)]
    for face in a.faces[len(old.faces):]:
        p = [a.points[v] for v in face]
        u, w = sub(p[1], p[0]), sub(p[2], p[0])
        face_normal = [u[(k + 1) % 3] * w[(k + 2) % 3] - u[(k + 2) % 3] * w[(k + 1) % 3]
                       for k in range(3)]
        for v in face:
            assert v < n or sum(x * y for x, y in zip(normals[v], face_normal)) > 0, v


def normals(path_a, path_b, tolerance="0.001"):
    def directions(mesh):
        rows = zip(*(mesh.columns[k] for k in ("nx", "ny", "nz")))
        return [[x / sum(y * y for y in n) ** 0.5 for x in n] for n in rows]

    a, b = directions(Mesh(path_a)), directions(Mesh(path_b))
    assert len(a) == len(b)
    wrong = [i for i, (m, n) in enumerate(zip(a, b)) if max(abs(x - y) for x, y in zip(m, n)) > float(tolerance)]
    assert not wrong, f"{len(wrong)} normals differ, the first is vertex {wrong[0]}: " \
        f"{a[wrong[0]]} and {b[wrong[0]]}"


PALETTE = [(0, 158, 115), (204, 60, 140), (240, 228, 66), (120, 60, 160), (86, 180, 233),
           (200, 60, 0), (0, 114, 178)]


def ramp(t):
    return (220 if t < 0.5 else 440 * (1 - t), 400 * t if t < 0.5 else 200, 40)


def colouring(kind, path, provenance_path, old_path):
    a, p, old = Mesh(path), Mesh(provenance_path), Mesh(old_path)
    checked, n = 0, len(old.points)
    places = set()
    for i in range(n, len(a.points)):
        face = p.columns.get("source_face", p.columns.get("source_point"))[i]
        source = p.columns["source"][i]
        if kind == "confidence":
            expected = ramp(p.columns["confidence"][i])
        elif source < 0:
            expected = (150, 150, 150)
        else:
            expected = PALETTE[source % len(PALETTE)]  # one hole
            if face >= 0:
                places.update(old.faces[face] if old.faces else [face])
        checked += 1
        assert max(abs(x - y) for x, y in zip(a.colours[i], expected)) <= 1.01, \
            f"vertex {i} has {a.colours[i]} and should have {expected}"
    assert checked > 10
    assert kind != "provenance" or places
    for i in range(n):
        if i in places:
            assert a.colours[i] in PALETTE, i
        elif old.colours:
            assert a.colours[i] == old.colours[i], i


if __name__ == "__main__":
    commands = {"colour": colour, "plain": plain, "points": points,
                "scaled": plain, "texture": texture, "compare": compare, "carried": carried,
                "normals": normals, "colouring": colouring}
    commands[sys.argv[1]](*sys.argv[2:])
