#!/usr/bin/env bash
# meshio reads bytes above 127 in a binary PLY file as negative numbers.
#
# Expected: `property uchar red` is 0 to 255, as it is in the same file as text.
# Happens:  uchar and uint8 are int8 in a binary file: 200 is -56. The text file gives 200. It has int8, too, where
#           meshio writes the file again: `property int8 red`, which other programs do not take for a colour.
# Seen:     2026-12-01, meshio 5.3.5. A fix has been waiting since 2022: nschloe/meshio#1320.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check meshio==5.3.5 numpy==2.4.6
cd "$work"
"$work/venv/bin/python" - <<'PY'
import struct
from importlib.metadata import version

import meshio

points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
reds = [200, 127, 128]
header = """ply
format {} 1.0
element vertex 3
property float x
property float y
property float z
property uchar red
element face 1
property list uchar int vertex_indices
end_header
"""
text = "".join(f"{x} {y} {z} {red}\n" for (x, y, z), red in zip(points, reds)) + "3 0 1 2\n"
binary = b"".join(struct.pack("<3fB", *p, red) for p, red in zip(points, reds)) + struct.pack("<B3i", 3, 0, 1, 2)
with open("text.ply", "w") as file:
    file.write(header.format("ascii") + text)
with open("binary.ply", "wb") as file:
    file.write(header.format("binary_little_endian").encode() + binary)

as_text, as_binary = (meshio.read(name).point_data["red"] for name in ("text.ply", "binary.ply"))
meshio.read("binary.ply").write("again.ply")
line = next(l for l in open("again.ply", "rb").read().split(b"\n") if l.endswith(b" red"))
print("meshio", version("meshio"), "red", reds)
print("text:", as_text.tolist(), "binary:", as_binary.tolist(), "written again:", line.decode())
assert as_text.tolist() == reds
assert as_binary.tolist() == [-56, 127, -128] and as_binary.dtype == "int8"
assert line == b"property int8 red"
PY
