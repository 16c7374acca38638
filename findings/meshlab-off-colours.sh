#!/usr/bin/env bash
# MeshLab writes coloured OFF files that it reads back with other colours.
#
# Expected: a file saved with default settings opens with the colours it was saved with.
# Happens:  normals are saved by default, made up where the mesh has none. The header is then NCOFF, and a vertex
#           is position, colour, normal; the reader takes NCOFF for position, normal, colour. The colours become the
#           normals, and the colours on the screen are what is left of alpha and normal: (200, 100, 50) is red with
#           alpha 1. save_vertex_normal=False gives a COFF file, which is right.
# Seen:     2026-12-01, PyMeshLab 2025.7.post1. Told of as early as 2017 in alextsui05/blender-off-addon#9.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pymeshlab==2025.7.post1 numpy==2.4.6
cd "$work"
"$work/venv/bin/python" - <<'PY'
from importlib.metadata import version

import numpy as np
import pymeshlab

points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], float)
colours = np.array([[200, 100, 50, 255], [1, 2, 3, 255], [255, 254, 253, 128]])


def saved_and_read(**options):
    source = pymeshlab.MeshSet()
    source.add_mesh(pymeshlab.Mesh(points, np.array([[0, 1, 2]]), v_color_matrix=colours / 255))
    source.save_current_mesh("mesh.off", **options)
    lines = open("mesh.off").read().split("\n")
    result = pymeshlab.MeshSet()
    result.load_new_mesh("mesh.off")
    read = np.round(result.current_mesh().vertex_color_matrix() * 255).astype(int)
    return lines[0], lines[2], read


print("pymeshlab", version("pymeshlab"), "colours", colours.tolist())
for options in ({}, {"save_vertex_normal": False}):
    header, vertex, read = saved_and_read(**options)
    print(options, "->", header, "|", vertex, "| read as", read.tolist())
    if options:
        assert header == "COFF" and (read == colours).all()
    else:
        assert header == "NCOFF" and vertex.startswith("0 0 0 200 100 50 255 ")
        assert (read[:, :3] == [[255, 0, 0], [255, 0, 0], [128, 0, 0]]).all()
PY
