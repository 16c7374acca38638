#!/usr/bin/env bash
# Draco gives a point cloud back with fewer points, in another order, unless it is told to keep the order.
#
# Expected: quantization moves points, and the default may sort them, but their number is that of the input.
# Happens:  points equal in all that is stored are one point afterwards: a second return at the same place, a scan
#           that was stored twice, a frame with a hundred zeros for "no echo". With colours a point stays where its
#           colour differs. A list kept beside the stream (labels, times, poses) has then another length. In meshes
#           vertices without a face go, and two triangles that run along their edge in the same direction (one of
#           them is turned over) make 6 vertices out of 4.
#           preserve_order=True keeps number and order in all cases.
# Seen:     2026-12-01, DracoPy 1.7.0 and its defaults. Of meshes: google/draco#684, google/draco#841.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check DracoPy==1.7.0 numpy==2.4.6
cd "$work"
"$work/venv/bin/python" - <<'PY'
from importlib.metadata import version

import DracoPy
import numpy as np

frame = np.array([[0, 0, 0], [1, 1, 1], [0, 0, 0], [2, 2, 2], [0, 0, 0]], float)
colours = np.array([[9, 9, 9], [1, 1, 1], [9, 9, 9], [2, 2, 2], [8, 8, 8]], np.uint8)
square = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], float)
cases = {
    "cloud": (dict(points=frame), 3),
    "cloud with colours": (dict(points=frame, colors=colours), 4),
    "square": (dict(points=square, faces=np.array([[0, 1, 2], [1, 3, 2]])), 4),
    "square, one triangle turned over": (dict(points=square, faces=np.array([[0, 1, 2], [1, 2, 3]])), 6),
    "triangle and a loose vertex": (dict(points=square, faces=np.array([[0, 1, 2]])), 3),
}
print("DracoPy", version("DracoPy"))
for name, (mesh, expected) in cases.items():
    number = len(mesh["points"])
    decoded = len(DracoPy.decode(DracoPy.encode(**mesh)).points)
    ordered = DracoPy.decode(DracoPy.encode(**mesh, preserve_order=True)).points
    print(f"{name}: {number} -> {decoded}, with preserve_order {len(ordered)}")
    assert decoded == expected and len(ordered) == number
    assert abs(ordered - mesh["points"]).max() < 0.001
first = DracoPy.decode(DracoPy.encode(frame)).points
print("order of the cloud:", np.round(first).tolist())
assert np.round(first).tolist() == [[1, 1, 1], [2, 2, 2], [0, 0, 0]]
PY
