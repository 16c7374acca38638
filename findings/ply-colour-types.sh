#!/usr/bin/env bash
# PLY colours that are not `uchar` become noise, black or nothing in four programs, without a word.
#
# Expected: a property may have any type. 16 bits are divided by 65535 and floats are 0 to 1, or there is an error.
# Happens:  ushort: trimesh and VTK keep the low byte, so middle grey (32768) is black, and the rest is noise; Open3D
#           divides by 255 and has colours up to 257; MeshLab has no colours.
#           float:  VTK and Open3D take 0 to 1 for 0 to 255 and are black; MeshLab has no colours; trimesh is right.
#           There are no warnings. All four agree about uchar.
# Seen:     2026-12-01, trimesh 5.2.0, VTK 9.7.2, Open3D 0.20.0, PyMeshLab 2025.7.post1. Reports of single programs:
#           PDAL/PDAL#4493, assimp/assimp#1167.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check \
  trimesh==5.2.0 vtk==9.7.2 open3d-cpu==0.20.0 pymeshlab==2025.7.post1 numpy==1.26.4
cd "$work"
"$work/venv/bin/python" - <<'PY'
import struct

import numpy as np
import open3d
import pymeshlab
import trimesh
import vtk
from vtk.util.numpy_support import vtk_to_numpy

HEADER = """ply
format binary_little_endian 1.0
element vertex 3
property float x
property float y
property float z
property {0} red
property {0} green
property {0} blue
element face 1
property list uchar int vertex_indices
end_header
"""
POINTS = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]


def write(kind, code, colour):
    rows = b"".join(struct.pack("<3f3" + code, *p, *colour) for p in POINTS)
    with open("mesh.ply", "wb") as file:
        file.write(HEADER.format(kind).encode() + rows + struct.pack("<B3i", 3, 0, 1, 2))


def by_vtk():
    reader = vtk.vtkPLYReader()
    reader.SetFileName("mesh.ply")
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetArray("RGB"))[0]


def by_meshlab():
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh("mesh.ply")
    mesh = meshes.current_mesh()
    return mesh.vertex_color_matrix()[0, :3] * 255 if mesh.has_vertex_color() else None


READERS = {
    "trimesh": lambda: trimesh.load("mesh.ply", process=False).visual.vertex_colors[0, :3],
    "VTK": by_vtk,
    "Open3D": lambda: np.asarray(open3d.io.read_triangle_mesh("mesh.ply").vertex_colors)[0] * 255,
    "MeshLab": by_meshlab,
}


def read(kind, code, colour):
    write(kind, code, colour)
    found = {name: reader() for name, reader in READERS.items()}
    found = {name: None if c is None else [round(float(v), 2) for v in c] for name, c in found.items()}
    print(kind, colour, found)
    return found


print("trimesh", trimesh.__version__, "VTK", vtk.vtkVersion().GetVTKVersion(), "Open3D", open3d.__version__)
right = [200, 128, 1]
assert all(c == right for c in read("uchar", "B", right).values())
deep = read("ushort", "H", [51200, 32768, 257])
assert deep["trimesh"] == deep["VTK"] == [0, 0, 1], "51200 and 32768 had zeros in the low byte"
assert deep["Open3D"] == [51200, 32768, 257] and deep["MeshLab"] is None
floats = read("float", "f", [200 / 255, 128 / 255, 1 / 255])
assert floats["trimesh"] == right and floats["MeshLab"] is None
assert floats["VTK"] == [0, 0, 0] and max(floats["Open3D"]) < 1
PY
