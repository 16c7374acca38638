#!/usr/bin/env bash
# Blender darkens the colours of a PLY file by one step each time that it is imported and exported.
#
# Expected: bytes that were read are written again; Blender has floats between, so nothing forces a loss.
# Happens:  colours become linear floats on import, and sRGB again on export. The result is often a hair below the
#           byte that it was, and the exporter cuts it instead of rounding. 170 of the 256 values of each channel
#           lose one in the first round and one more in each further round, so a file that is edited every week
#           gets darker and darker. Alpha is not converted, and stays. With export_colors="LINEAR" the picture
#           would be much darker at once, so that is no way out.
# Seen:     2026-12-01, bpy 5.0.1. The same cut in MeshLab's OBJ reader is cnr-isti-vclab/meshlab#1271.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check bpy==5.0.1
cd "$work"
"$work/venv/bin/python" - <<'PY' | grep -v '^PLY \|^Info'
import bpy

values = list(range(256))
header = ["ply", "format ascii 1.0", "element vertex 256"]
header += [f"property float {name}" for name in "xyz"]
header += [f"property uchar {name}" for name in ("red", "green", "blue", "alpha")]
header += ["element face 254", "property list uchar int vertex_indices", "end_header"]
vertices = [f"{v} {v % 2} 0 {v} {v} {v} {v}" for v in values]
faces = [f"3 {v} {v + 1} {v + 2}" for v in values[:254]]
with open("mesh.ply", "w") as file:
    file.write("\n".join(header + vertices + faces) + "\n")


def once_through_blender():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.ply_import(filepath="mesh.ply")
    bpy.ops.wm.ply_export(filepath="mesh.ply", ascii_format=True)
    body = open("mesh.ply").read().split("end_header\n")[1].splitlines()[:256]
    return [[int(word) for word in line.split()[3:]] for line in body]


print("Blender", bpy.app.version_string)
for rounds in (1, 2, 3, 4):
    read = once_through_blender()
    lost = [v - colour[0] for v, colour in zip(values, read)]
    print(f"after {rounds}: {sum(map(bool, lost))} of 256 values changed, the worst by {max(lost)}; 15 is now {read[15]}")
    assert all(r == g == b and a == v for v, (r, g, b, a) in zip(values, read))
    assert max(lost) == rounds and min(lost) == 0 and sum(map(bool, lost)) == 170
PY
