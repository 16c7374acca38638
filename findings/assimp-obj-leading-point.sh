#!/usr/bin/env bash
# assimp refuses OBJ files with numbers such as .5, though it takes -.5; Open3D, which uses it, reads an empty mesh.
#
# Expected: .5 is a number, as in C, in Fortran and in every other reader of OBJ.
# Happens:  before a line is read, its numbers are counted, and a number is what begins with a digit, + or -. So
#           `v 0 .5 0` has too few coordinates ("vertex index out of range") and `vt 0 .5` has one ("Invalid number of
#           components"): errors that name something else. Open3D prints the latter as a warning and returns a mesh
#           without vertices, which read_triangle_mesh() does for any failure.
# Seen:     2026-12-01, assimp_py 1.1.0, Open3D 0.20.0; assimp 5.2.5 too. The conversion itself knows .5 since
#           assimp/assimp#316; the count is the function of assimp/assimp#2428.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check assimp_py==1.1.0 open3d-cpu==0.20.0 numpy==1.26.4
cd "$work"
"$work/venv/bin/python" - <<'PY'
from importlib.metadata import version

import assimp_py
import open3d

open3d.utility.set_verbosity_level(open3d.utility.VerbosityLevel.Error)


def read(point, texcoord):
    with open("mesh.obj", "w") as file:
        file.write(f"v {point}\nv 1 0 0\nv 0 1 0\nvt {texcoord}\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n")
    try:
        result = f"{assimp_py.import_file('mesh.obj', 0).meshes[0].num_vertices} vertices"
    except Exception as error:
        result = str(error).rsplit(": ", 1)[1]
    count = len(open3d.io.read_triangle_mesh("mesh.obj").vertices)
    print(f"v {point} | vt {texcoord}: assimp {result}, Open3D {count} vertices")
    return result, count


print("assimp_py", version("assimp_py"), "Open3D", open3d.__version__)
assert read("0 0.5 0", "0 0.5") == ("3 vertices", 3)
assert read("0 -.5 0", "0 -.5") == ("3 vertices", 3)
assert read("0 .5 0", "0 0.5") == ("vertex index out of range", 0)
assert read("0 0.5 0", "0 .5") == ("Invalid number of components", 0)
PY
