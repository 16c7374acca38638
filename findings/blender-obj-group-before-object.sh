#!/usr/bin/env bash
# Blender gives the groups of an OBJ file to the wrong object when `g` stands before `o`.
#
# Expected: `g` and `o` are two independent states of the faces that follow, in any order.
# Happens:  `o` begins a new object, and the group named before it belongs to the object that ends there. With vertex
#           groups (import_vertex_groups) the first object has both groups, the second has none, and its vertices
#           have weights for group number 1, which is not there: a script that looks the name up raises IndexError.
#           With objects by group (use_split_groups) the objects take the names of `o`. In the order o, g all is well.
#           A material named before `o` does stay.
# Seen:     2026-12-01, bpy 5.0.1. The OBJ specification gives no order.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check bpy==5.0.1
cd "$work"
"$work/venv/bin/python" - <<'PY' | grep -v '^OBJ import\|^Info'
import bpy

POINTS = "".join(f"v {i % 3} {i // 3} 0\n" for i in range(6))
PARTS = [("hull", "iron", "f 1 2 4"), ("sail", "cloth", "f 2 3 5")]


def objects(order, **options):
    lines = lambda o, g, face: "\n".join([f"{key} {dict(o=o, g=g)[key]}" for key in order] + [face])
    with open("mesh.obj", "w") as file:
        file.write(POINTS + "\n".join(lines(*part) for part in PARTS) + "\n")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.obj_import(filepath="mesh.obj", **options)
    return [
        (o.name, [g.name for g in o.vertex_groups], sorted({g.group for v in o.data.vertices for g in v.groups}))
        for o in bpy.data.objects
    ]


print("Blender", bpy.app.version_string)
for order in ("og", "go"):
    print(order, "name, vertex groups, groups of the weights:", objects(order, import_vertex_groups=True))
    print(order, "split by group:", [name for name, _, _ in objects(order, use_split_groups=True)])
assert objects("og", import_vertex_groups=True) == [("hull", ["iron"], [0]), ("sail", ["cloth"], [0])]
assert objects("go", import_vertex_groups=True) == [("hull", ["iron", "cloth"], [0]), ("sail", [], [1])]
assert {o[0] for o in objects("og", use_split_groups=True)} == {"iron", "cloth"}
assert {o[0] for o in objects("go", use_split_groups=True)} == {"hull", "sail"}
PY
