#!/usr/bin/env bash
# trimesh gives the colours of a PLY file's faces to other faces when triangles and quads are mixed.
#
# Expected: a quad becomes two triangles where it stood, and both get its colour.
# Happens:  triangles come first and the pieces of quads last, but the colours stay in the file's order, one a
#           polygon: three colours for four faces. The red quad is green or uncoloured and a triangle is red. No
#           warning, with process=False as well. The same file in binary is refused with ValueError.
# Seen:     2026-12-01, trimesh 5.2.0. Not documented; mikedh/trimesh#1471 tells of the constructor, where the
#           number of colours is wrong, too, but not their order.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check trimesh==5.2.0 numpy==2.4.6
"$work/venv/bin/python" - <<'PY'
import io
import struct

import trimesh

points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1)]
polygons = [((0, 1, 2, 3), (255, 0, 0)), ((0, 1, 4), (0, 255, 0)), ((1, 5, 4), (0, 0, 255))]
header = """ply
format {} 1.0
element vertex 6
property float x
property float y
property float z
element face 3
property list uchar int vertex_indices
property uchar red
property uchar green
property uchar blue
end_header
"""
line = lambda *numbers: " ".join(map(str, numbers)) + "\n"
text = header.format("ascii")
text += "".join(line(*p) for p in points)
text += "".join(line(len(corners), *corners, *colour) for corners, colour in polygons)
binary = header.format("binary_little_endian").encode()
binary += b"".join(struct.pack("<3f", *p) for p in points)
binary += b"".join(struct.pack(f"<B{len(c)}i3B", len(c), *c, *colour) for c, colour in polygons)

mesh = trimesh.load(io.BytesIO(text.encode()), file_type="ply", process=False)
faces = mesh.faces.tolist()
colours = mesh.visual.face_colors[:, :3].tolist()
print("trimesh", trimesh.__version__)
for i, face in enumerate(faces):
    print("face", face, "colour", colours[i] if i < len(colours) else None)
assert faces[0] == [0, 1, 4] and colours[0] == [255, 0, 0], "the green triangle was red"
assert set(faces[2]) | set(faces[3]) == {0, 1, 2, 3} and colours[2] == [0, 0, 255], "the red quad was blue"
assert len(faces) == 4 and len(colours) == 3

try:
    trimesh.load(io.BytesIO(binary), file_type="ply", process=False)
    raise SystemExit("the binary file was refused, and is read now")
except ValueError as error:
    print("the same in binary: ValueError:", error)
PY
