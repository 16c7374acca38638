"""Reads what a file says, by the text of its format: a small reader for the files of this test, and no other."""

import json
import struct
from pathlib import Path

import numpy as np

from part import moved, part, turned

PLY_TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4", "double": "f8"}
GLTF_TYPES = {5120: "i1", 5121: "u1", 5122: "i2", 5123: "u2", 5125: "u4", 5126: "f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


def read(path):
    return {".ply": ply, ".obj": obj, ".glb": glb, ".stl": stl}[Path(path).suffix](path)


def read_without_nodes(path):
    """The meshes of a GLB where they are without the transforms of their nodes."""
    return glb(path, placed=False)


def ply(path):
    elements, take = ply_header(Path(path).read_bytes())
    columns = {element: ply_rows(properties, count, take) for element, (count, properties) in elements.items()}
    vertex, face = columns["vertex"], columns["face"]
    points = np.stack([vertex.pop(c) for c in "xyz"], axis=1)
    triangles = face.pop("vertex_indices", None)
    triangles = face.pop("vertex_index") if triangles is None else triangles
    values = group(vertex, "normal", ["nx", "ny", "nz"]) | group(vertex, "uv", ["s", "t"]) | group(vertex, "uv", ["u", "v"])
    values |= group(vertex, "uv", ["texture_u", "texture_v"])
    values |= group(vertex, "colour", ["red", "green", "blue", "alpha"]) or group(vertex, "colour", ["red", "green", "blue"])
    values |= vertex
    corner = {"uv": face["texcoord"]} if "texcoord" in face else {}
    return [part(points, triangles, vertex=values, corner=corner)]


def group(columns, name, members):
    if not all(member in columns for member in members):
        return {}
    return {name: np.stack([columns.pop(member) for member in members], axis=1)}


def ply_header(data):
    head, body = data.split(b"end_header\n", 1)
    elements = {}
    for line in head.decode().splitlines():
        words = line.split()
        if words[0] == "element":
            properties = []
            elements[words[1]] = (int(words[2]), properties)
        elif words[0] == "property":
            properties.append(words[1:])
    text = b"format ascii" in head
    numbers = iter(body.split()) if text else None
    position = 0

    def take(kind, count):
        nonlocal position
        if text:
            return np.array([float(next(numbers)) for _ in range(count)])
        values = np.frombuffer(body, "<" + PLY_TYPES[kind], count, position)
        position += values.nbytes
        return values

    return elements, take


def ply_rows(properties, count, take):
    columns = {words[-1]: [] for words in properties}
    for _ in range(count):
        for words in properties:
            if words[0] == "list":
                columns[words[-1]].append(take(words[2], int(take(words[1], 1)[0])))
            else:
                columns[words[-1]].append(take(words[0], 1)[0])
    return {name: np.array(values, float) for name, values in columns.items()}


def obj(path):
    tables = {"v": [], "vt": [], "vn": []}
    faces, objects, materials = [], [], []
    state = {"o": None, "usemtl": None, "g": None}
    for line in Path(path).read_text().splitlines():
        key, _, rest = line.partition(" ")
        if key in tables:
            tables[key].append([float(number) for number in rest.split()])
        elif key in state:
            state[key] = rest
        elif key == "f":
            corners = [(word.split("/") + ["", ""])[:3] for word in rest.split()]
            for a in range(1, len(corners) - 1):
                faces.append([corners[0], corners[a], corners[a + 1]])
                objects.append(state["o"] or state["g"])
                materials.append(state["usemtl"])
    points = np.array(tables["v"])
    index = lambda k: np.array([[int(corner[k]) - 1 for corner in face] for face in faces])
    has = lambda k: faces[0][0][k] != ""
    vertex = {"colour": points[:, 3:]} if points.shape[1] > 3 else {}
    corner = {}
    if has(1):
        corner["uv"] = np.array([t[:2] for t in tables["vt"]])[index(1)]
    if has(2):
        corner["normal"] = np.array(tables["vn"])[index(2)]
    return [part(points[:, :3], index(0), vertex=vertex, corner=corner, object=objects, material=materials)]


def stl(path):
    data = Path(path).read_bytes()
    if data.lstrip()[:5] == b"solid" and b"facet" in data:
        words = [line.split() for line in data.decode().splitlines()]
        corners = np.array([w[1:] for w in words if w and w[0] == "vertex"], float)
        normals = np.array([w[2:] for w in words if w and w[0] == "facet"], float)
    else:
        count = struct.unpack_from("<I", data, 80)[0]
        records = np.frombuffer(data, np.dtype([("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")]), count, 84)
        corners, normals = records["v"].reshape(-1, 3), records["n"]
    return [part(corners, np.arange(len(corners)).reshape(-1, 3), corner={"normal": np.repeat(normals, 3, axis=0)})]


def glb(path, placed=True):
    data = Path(path).read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    gltf, binary = json.loads(data[20 : 20 + size]), data[28 + size :]
    parts = []
    for node, matrix in nodes(gltf, gltf["scenes"][gltf.get("scene", 0)]["nodes"], np.eye(4), None):
        for primitive in gltf["meshes"][node["mesh"]]["primitives"]:
            parts.append(glb_part(gltf, binary, primitive, matrix if placed else np.eye(4), node["found_name"]))
    return parts


def nodes(gltf, indices, above, name):
    for i in indices:
        node = dict(gltf["nodes"][i])
        node["found_name"] = node.get("name", name)
        matrix = above @ local(node)
        if "mesh" in node:
            yield node, matrix
        yield from nodes(gltf, node.get("children", []), matrix, node["found_name"])


def local(node):
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])
    turn = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])
    matrix = np.eye(4)
    matrix[:3, :3] = turn * node.get("scale", [1, 1, 1])
    matrix[:3, 3] = node.get("translation", [0, 0, 0])
    return matrix


def glb_part(gltf, binary, primitive, matrix, name):
    values = {key: accessor(gltf, binary, i) for key, i in primitive["attributes"].items()}
    standard = {"normal": "NORMAL", "uv": "TEXCOORD_0", "colour": "COLOR_0"}
    points = moved(values.pop("POSITION"), matrix)
    vertex = {ours: values.pop(theirs) for ours, theirs in standard.items() if theirs in values}
    if "normal" in vertex:
        vertex["normal"] = turned(vertex["normal"], matrix)
    triangles = accessor(gltf, binary, primitive["indices"]).astype(int) if "indices" in primitive else np.arange(len(points))
    material = gltf["materials"][primitive["material"]].get("name") if "material" in primitive else None
    return part(points, triangles, vertex=vertex | values, object=name, material=material)


def accessor(gltf, binary, index):
    entry = gltf["accessors"][index]
    view = gltf["bufferViews"][entry["bufferView"]]
    kind, width = np.dtype("<" + GLTF_TYPES[entry["componentType"]]), WIDTHS[entry["type"]]
    stride = view.get("byteStride") or kind.itemsize * width
    start = view.get("byteOffset", 0) + entry.get("byteOffset", 0)
    rows = [np.frombuffer(binary, kind, width, start + i * stride) for i in range(entry["count"])]
    values = np.array(rows)
    if entry.get("normalized"):
        values = np.maximum(values.astype(float) / np.iinfo(kind).max, -1)
    return values if width > 1 else values[:, 0]
