#!/usr/bin/env bash
# assimp joins objects of an OBJ file whose names begin with the same word.
#
# Expected: "Left door" and "Left wing" are two objects, as in Blender and three.js.
# Happens:  a name ends at its first blank, so both are Left, and what follows a known name is added to that object: one
#           node, and one mesh if there is only one material. `usemtl Left paint` and `g` are kept whole, so the rule
#           is hard to guess from a file that works. No warning.
# Seen:     2026-12-01, assimp_py 1.1.0; assimp 5.2.5 too. Groups and materials once had the same fault:
#           assimp/assimp#55, assimp/assimp#545. That equal names are joined is assimp/assimp#4615.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check assimp_py==1.1.0 numpy==2.4.6
cd "$work"
"$work/venv/bin/python" - <<'PY'
from importlib.metadata import version

import assimp_py

OBJ = """mtllib mesh.mtl
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
{key} Left{blank}door
usemtl Left paint
f 1 2 3
{key} Left{blank}wing
usemtl {second}
f 1 3 4
"""


def read(key, blank, second):
    with open("mesh.obj", "w") as file:
        file.write(OBJ.format(key=key, blank=blank, second=second))
    scene = assimp_py.import_file("mesh.obj", 0)
    nodes = [(node.name, len(node.mesh_indices)) for node in scene.root_node.children]
    materials = [scene.materials[mesh.material_index]["NAME"] for mesh in scene.meshes]
    print(f"{key} Left{blank}door, {key} Left{blank}wing: nodes and their meshes {nodes}, materials {materials}")
    return nodes, materials


with open("mesh.mtl", "w") as file:
    file.write("newmtl Left paint\nKd 1 0 0\nnewmtl Left glass\nKd 0 0 1\n")
print("assimp_py", version("assimp_py"))
two = ["Left paint", "Left glass"]
assert read("o", "_", two[1]) == ([("Left_door", 1), ("Left_wing", 1)], two)
assert read("o", " ", two[1]) == ([("Left", 2)], two)
assert read("o", " ", two[0]) == ([("Left", 1)], two[:1])
assert read("g", " ", two[1]) == ([("Left door", 1), ("Left wing", 1)], two)
PY
