"""Writes the mesh with everything: `source.py FILE.glb`.

Two boxes, both closed. Nothing in it is symmetric, so that each mistake of a reader has its own look:

- each vertex has a colour with alpha, a texture coordinate and a number `_temperature` of its own;
- the first box has hard edges and a seam at every edge, the second is smooth and has one chart;
- the second stands at a translation of its node, and touches the first in one point;
- objects and materials have names with a blank and a `#`.
"""

import json
import struct
import sys

import numpy as np

FLOAT, UBYTE, USHORT = 5126, 5121, 5123

CORNERS = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
SIDES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
# The order of the file: none that a reader would make by itself.
ORDER = [5, 2, 7, 0, 6, 1, 4, 3]


def colours(first):
    """Four bytes a vertex; red rises, green falls, and no two are alike."""
    k = np.arange(8)
    return np.stack([40 + 25 * k, 220 - 15 * k, first + 7 * k, 255 - 16 * (k % 3)], axis=1).astype(np.uint8)


def hard_box():
    """24 vertices: each side has its normal and its chart."""
    place = np.argsort(ORDER)
    corner = np.array([place[c] for side in SIDES for c in side])
    points = CORNERS[ORDER][corner]
    normals = np.repeat([np.cross(points[4 * s + 1] - points[4 * s], points[4 * s + 2] - points[4 * s]) for s in range(6)], 4, axis=0)
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) * [0.125, 0.25]
    texcoords = np.concatenate([square + [s / 8 + 1 / 64, s / 16 + 1 / 32] for s in range(6)])
    triangles = [(4 * s, 4 * s + a, 4 * s + a + 1) for s in range(6) for a in (1, 2)]
    return attributes(points, normals, texcoords, colours(10)[corner], 20.5 + corner, triangles)


def smooth_box():
    """8 vertices; the normals are those of a sphere around a point beside the middle, so no reader makes them up."""
    points = CORNERS[ORDER]
    normals = points - [0.4, 0.5, 0.6]
    texcoords = np.stack([np.arange(8) / 16 + 1 / 32, (np.arange(8) ** 2) / 128 + 1 / 64], axis=1)
    place = np.argsort(ORDER)
    triangles = [(place[s[0]], place[s[a]], place[s[a + 1]]) for s in SIDES for a in (1, 2)]
    return attributes(points * [2, 1, 0.5], normals, texcoords, colours(130), 60.25 + np.arange(8), triangles)


def attributes(points, normals, texcoords, rgba, temperature, triangles):
    unit = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    return {
        "POSITION": np.asarray(points, np.float32),
        "NORMAL": unit.astype(np.float32),
        "TEXCOORD_0": texcoords.astype(np.float32),
        "COLOR_0": rgba,
        "_temperature": np.asarray(temperature, np.float32),
        "indices": np.asarray(triangles, np.uint16).ravel(),
    }


def document(boxes, names, translations):
    """The JSON and the bytes of a GLB with one node, mesh and material a box."""
    gltf = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(boxes)))}],
        "nodes": [{"name": n, "mesh": i, "translation": t} for i, ((n, _), t) in enumerate(zip(names, translations))],
        "materials": [{"name": m, "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 1]}} for _, m in names],
        "meshes": [],
        "accessors": [],
        "bufferViews": [],
    }
    data = bytearray()
    for i, box in enumerate(boxes):
        accessors = {name: add_accessor(gltf, data, name, values) for name, values in box.items()}
        indices = accessors.pop("indices")
        primitive = {"attributes": accessors, "indices": indices, "material": i}
        gltf["meshes"].append({"name": names[i][0], "primitives": [primitive]})
    gltf["buffers"] = [{"byteLength": len(data)}]
    return gltf, bytes(data)


def add_accessor(gltf, data, name, values):
    kind = {np.dtype(np.float32): FLOAT, np.dtype(np.uint8): UBYTE, np.dtype(np.uint16): USHORT}[values.dtype]
    shape = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}[1 if values.ndim == 1 else values.shape[1]]
    view = {"buffer": 0, "byteOffset": len(data), "byteLength": values.nbytes}
    view["target"] = 34963 if name == "indices" else 34962
    accessor = {"bufferView": len(gltf["bufferViews"]), "componentType": kind, "type": shape, "count": len(values)}
    if kind == UBYTE:
        accessor["normalized"] = True
    if name == "POSITION":
        accessor |= {"min": values.min(0).tolist(), "max": values.max(0).tolist()}
    gltf["bufferViews"].append(view)
    gltf["accessors"].append(accessor)
    data += values.tobytes() + bytes(-values.nbytes % 4)
    return len(gltf["accessors"]) - 1


def glb(gltf, data):
    text = json.dumps(gltf).encode()
    text += b" " * (-len(text) % 4)
    size = 12 + 8 + len(text) + 8 + len(data)
    head = struct.pack("<4sII", b"glTF", 2, size)
    return head + struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data


if __name__ == "__main__":
    names = [("Left part", "Rough grey #1"), ("Right #2", "Glass")]
    with open(sys.argv[1], "wb") as file:
        file.write(glb(*document([hard_box(), smooth_box()], names, [[0, 0, 0], [1, 1, 1]])))
