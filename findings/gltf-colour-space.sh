#!/usr/bin/env bash
# A grey of 0.5 in COLOR_0 of a glTF file is 187, 127 or 128 in the PLY file that a program makes of it.
#
# Expected: COLOR_0 is linear, as the glTF specification says, and PLY and its viewers count in sRGB: 188.
# Happens:  only Blender converts, and cuts 187.5. trimesh, Open3D and MeshLab copy the number (MeshLab cuts it, too),
#           so a model that went from glTF to PLY is dark, and one that went from PLY to glTF is pale in viewers that
#           keep to the specification. A round trip in one program shows nothing, and black and white are right in all.
# Seen:     2026-12-01, bpy 5.0.1, trimesh 5.2.0, Open3D 0.20.0, PyMeshLab 2025.7.post1.
#           glTF 2.0, section 3.9.2; three.js decided for sRGB in PLY and OBJ in mrdoob/three.js#23283.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check \
  bpy==5.0.1 trimesh==5.2.0 open3d-cpu==0.20.0 pymeshlab==2025.7.post1 numpy==1.26.4
cd "$work"
cat > source.py <<'PY'
"""Writes grey.glb: a triangle with COLOR_0 = 0.5 as floats."""
import json
import struct

data = struct.pack("<9f9f3H2x", 0, 0, 0, 1, 0, 0, 0, 1, 0, *[0.5] * 9, 0, 1, 2)
vec3 = {"componentType": 5126, "type": "VEC3", "count": 3}
scene = {
    "asset": {"version": "2.0"},
    "scene": 0,
    "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 1}, "indices": 2}]}],
    "accessors": [
        {"bufferView": 0, "min": [0, 0, 0], "max": [1, 1, 0]} | vec3,
        {"bufferView": 1} | vec3,
        {"bufferView": 2, "componentType": 5123, "type": "SCALAR", "count": 3},
    ],
    "bufferViews": [{"buffer": 0, "byteOffset": o, "byteLength": n} for o, n in ((0, 36), (36, 36), (72, 6))],
    "buffers": [{"byteLength": len(data)}],
}
text = json.dumps(scene).encode()
text += b" " * (-len(text) % 4)
chunk = lambda kind, body: struct.pack("<I4s", len(body), kind) + body
body = chunk(b"JSON", text) + chunk(b"BIN\0", data)
with open("grey.glb", "wb") as file:
    file.write(struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body)
PY
"$work/venv/bin/python" source.py
# One process a program: they bring libraries of the same names.
"$work/venv/bin/python" - > /dev/null <<'PY'
import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath="grey.glb")
bpy.ops.wm.ply_export(filepath="blender.ply")
PY
"$work/venv/bin/python" - <<'PY'
import open3d

open3d.io.write_triangle_mesh("open3d.ply", open3d.io.read_triangle_mesh("grey.glb"))
PY
"$work/venv/bin/python" - <<'PY'
import pymeshlab

meshes = pymeshlab.MeshSet()
meshes.load_new_mesh("grey.glb")
meshes.save_current_mesh("meshlab.ply")
PY
"$work/venv/bin/python" - <<'PY'
from importlib.metadata import version

import trimesh

trimesh.load_mesh("grey.glb").export("trimesh.ply")
grey = lambda name: int(trimesh.load(name + ".ply", process=False).visual.vertex_colors[0, 0])
found = {name: grey(name) for name in ("blender", "trimesh", "open3d", "meshlab")}
print({name: version(name) for name in ("bpy", "trimesh", "open3d-cpu", "pymeshlab")})
print("0.5 of glTF is in PLY:", found)
assert found == {"blender": 187, "trimesh": 128, "open3d": 128, "meshlab": 127}
PY
