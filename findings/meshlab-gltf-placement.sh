#!/usr/bin/env bash
# MeshLab forgets where the nodes of a glTF scene stand when it saves a mesh.
#
# Expected: a mesh whose node stands at x = 100 is saved at x = 100, or a format without nodes is refused.
# Happens:  the importer keeps the place beside the mesh as its matrix. save_current_mesh() to PLY, OBJ and STL, and
#           vertex_matrix(), take the coordinates without it: the wheels of a car are all in the middle of it. No
#           warning. apply_matrix_freeze(), or generate_by_merging_visible_meshes(), puts the matrix in first.
# Seen:     2026-12-01, PyMeshLab 2025.7.post1.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pymeshlab==2025.7.post1 numpy==2.4.6
cd "$work"
"$work/venv/bin/python" - <<'PY'
import base64
import json
import struct
from importlib.metadata import version

import pymeshlab

data = struct.pack("<9f3H", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 2)
scene = {
    "asset": {"version": "2.0"},
    "scene": 0,
    "scenes": [{"nodes": [0, 1]}],
    "nodes": [{"mesh": 0}, {"mesh": 0, "translation": [100, 0, 0]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "accessors": [
        {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3, "min": [0, 0, 0], "max": [1, 1, 0]},
        {"bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": 3},
    ],
    "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
    "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
}
with open("scene.gltf", "w") as file:
    json.dump(scene, file)


def x_of(mesh):
    return sorted(mesh.vertex_matrix()[:, 0].tolist())


def saved(meshes, name):
    meshes.save_current_mesh(name)
    again = pymeshlab.MeshSet()
    again.load_new_mesh(name)
    return x_of(again.current_mesh())


meshes = pymeshlab.MeshSet()
meshes.load_new_mesh("scene.gltf")
meshes.set_current_mesh(1)
matrix = meshes.current_mesh().transform_matrix()
places = {name: saved(meshes, name) for name in ("mesh.ply", "mesh.obj", "mesh.stl")}
print("pymeshlab", version("pymeshlab"), "second node at x =", matrix[0, 3])
print("x after saving:", places)
assert matrix[0, 3] == 100
assert all(x == [0, 0, 1] for x in places.values())
meshes.apply_matrix_freeze()
frozen = saved(meshes, "frozen.ply")
print("x after apply_matrix_freeze():", frozen)
assert frozen == [100, 100, 101]
meshes.load_new_mesh("scene.gltf")
meshes.generate_by_merging_visible_meshes()
merged = sorted(set(x_of(meshes.current_mesh())))
print("x after merging:", merged)
assert merged == [0, 1, 100, 101]
PY
