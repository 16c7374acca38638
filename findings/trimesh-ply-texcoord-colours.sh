#!/usr/bin/env bash
# trimesh splits the vertices of a PLY file at its seams, but not their colours, which are lost.
#
# Expected: texture coordinates by corner (the list `texcoord` of a face) make more vertices, and each of them has
#           the colour of the vertex that it comes from.
# Happens:  there are six vertices and four colours. Export to PLY leaves the colours out with a line in the log;
#           visual.to_color() is grey. There is no error on reading, with process=True or False. fix_texture=False keeps
#           the four vertices and their colours.
# Seen:     2026-12-01, trimesh 5.2.0. mikedh/trimesh#1880 explains the split.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check trimesh==5.2.0 numpy==2.4.6 pillow==12.0.0
cd "$work"
"$work/venv/bin/python" - <<'PY'
import io

import trimesh

text = b"""ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
property uchar red
property uchar green
property uchar blue
element face 2
property list uchar int vertex_indices
property list uchar float texcoord
end_header
0 0 0 10 20 30
1 0 0 40 50 60
1 1 0 70 80 90
0 1 0 100 110 120
3 0 1 2 6 0 0 .5 0 .5 .5
3 0 2 3 6 .5 .5 1 1 .5 1
"""
load = lambda **options: trimesh.load(io.BytesIO(text), file_type="ply", process=False, **options)
mesh = load()
colours = mesh.vertex_attributes["color"]
written = mesh.export(file_type="ply").split(b"end_header")[0].decode()
grey = mesh.visual.to_color().vertex_colors
print("trimesh", trimesh.__version__)
print(len(mesh.vertices), "vertices,", len(colours), "colours; red is written:", "red" in written, "; to_color():", grey[0])
assert len(mesh.vertices) == 6 and len(colours) == 4
assert "red" not in written and "color" not in written
assert len({tuple(c) for c in grey.tolist()}) == 1

whole = load(fix_texture=False)
print("fix_texture=False:", len(whole.vertices), "vertices,", len(whole.vertex_attributes["color"]), "colours")
assert len(whole.vertices) == len(whole.vertex_attributes["color"]) == 4
PY
