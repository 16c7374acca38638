#!/usr/bin/env bash
# VTK's OBJ reader makes one array of texture coordinates for each material, and takes the first material for none.
#
# Expected: one array of texture coordinates with the values of all vertices, and the names of all materials.
# Happens:  each material has an array of its own name, as long as the mesh, with -1 at the vertices of other
#           materials. GetTCoords() is one of them, so the rest of the mesh has (-1, -1) there. The faces of the first
#           material have the id of NO_MATERIAL, though its name is in the list. Names end at the first blank: "Red
#           paint" and "Red lead" share one array, with a warning of "unexpected data at end of line".
# Seen:     2026-12-01, VTK 9.7.2 (vtkOBJReader, and pyvista.read, which takes it).
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check vtk==9.7.2 numpy==2.4.6
cd "$work"
"$work/venv/bin/python" - <<'PY'
import vtk
from vtk.util.numpy_support import vtk_to_numpy


def read(first, second):
    with open("mesh.mtl", "w") as file:
        file.write(f"newmtl {first}\nKd 1 0 0\nnewmtl {second}\nKd 0 0 1\n")
    with open("mesh.obj", "w") as file:
        file.write("mtllib mesh.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n")
        file.write(f"usemtl {first}\nf 1/1 2/2 3/3\nusemtl {second}\nf 1/1 3/3 4/4\n")
    reader = vtk.vtkOBJReader()
    reader.SetFileName("mesh.obj")
    reader.Update()
    mesh = reader.GetOutput()
    data = mesh.GetPointData()
    arrays = {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)).tolist() for i in range(data.GetNumberOfArrays())}
    named = mesh.GetFieldData().GetAbstractArray("MaterialNames")
    names = [named.GetValue(i) for i in range(named.GetNumberOfValues())]
    of_faces = [names[i] for i in vtk_to_numpy(mesh.GetCellData().GetArray("MaterialIds"))]
    active = data.GetTCoords().GetName()
    print(f"{first}, {second}: arrays {arrays}, active {active}; names {names}, of the faces {of_faces}")
    return arrays, arrays[active], names, of_faces


print("VTK", vtk.vtkVersion().GetVTKVersion())
vtk.vtkObject.GlobalWarningDisplayOff()
arrays, active, names, of_faces = read("Iron", "Cloth")
assert set(arrays) == {"Cloth", "Iron"} and active.count([-1, -1]) == 1
assert "Iron" in names and of_faces == ["NO_MATERIAL", "Cloth"]
arrays, active, names, of_faces = read("Red paint", "Red lead")
assert set(arrays) == {"Red"} and "Red lead" not in names
PY
