#!/usr/bin/env bash
# meshio takes the colours of an OBJ file for the fourth to sixth coordinate of its points.
#
# Expected: `v x y z r g b` gives points with three coordinates and a colour, or points and a warning.
# Happens:  mesh.points has six columns, so distances and bounding boxes count the colour, without a word. To write such
#           a mesh as STL or PLY ends in errors that name something else ("incompatible dimensions for cross
#           product", "list index out of range"). A VTK file is written, and is damaged: three points are declared and
#           eighteen numbers follow, and meshio itself cannot read it. OBJ is written without the colours.
# Seen:     2026-12-01, meshio 5.3.5; nschloe/meshio#1312 speaks of it. MeshLab, Blender and Open3D write such lines.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check meshio==5.3.5 numpy==2.4.6
cd "$work"
"$work/venv/bin/python" - <<'PY'
from importlib.metadata import version

import meshio

with open("mesh.obj", "w") as file:
    file.write("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n")
mesh = meshio.read("mesh.obj")
print("meshio", version("meshio"), "points", mesh.points.tolist(), "point_data", mesh.point_data)


def there_and_back(name):
    try:
        mesh.write(name)
    except (ValueError, IndexError) as error:
        return f"not written: {type(error).__name__}"
    try:
        return meshio.read(name).points.shape
    except Exception as error:
        return f"written, not read: {type(error).__name__}"


found = {name: there_and_back(name) for name in ("again.stl", "again.ply", "again.vtk", "again.obj")}
print(found)
assert mesh.points.shape == (3, 6) and not mesh.point_data
assert found["again.stl"] == "not written: ValueError" and found["again.ply"] == "not written: IndexError"
assert found["again.vtk"].startswith("written, not read") and found["again.obj"] == (3, 3)
PY
