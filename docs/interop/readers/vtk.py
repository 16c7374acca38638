"""VTK, read through PyVista's `pyvista.read`, which takes VTK's readers."""

import pyvista
import vtk

from part import part

NAMES = {"Normals": "normal", "NORMAL": "normal", "RGB": "colour", "RGBA": "colour", "COLOR_0": "colour", "TEXCOORD_0": "uv"}


def read(path):
    data = pyvista.read(path)
    parts = [block_part(name, block) for name, block in leaves(data, None)]
    return f"{vtk.vtkVersion().GetVTKVersion()} (PyVista {pyvista.__version__})", parts


def leaves(data, name):
    if not isinstance(data, pyvista.MultiBlock):
        yield name, data
        return
    for i in range(data.n_blocks):
        if data[i] is not None:
            yield from leaves(data[i], data.get_block_name(i))


def block_part(name, mesh):
    names = dict(NAMES)
    texture = mesh.GetPointData().GetTCoords()
    if texture is not None:
        names[texture.GetName()] = "uv"
    vertex = {names.get(k, k): v for k, v in mesh.point_data.items()}
    corner = {}
    if "Normals" in mesh.cell_data:
        corner["normal"] = mesh.cell_data["Normals"].repeat(3, axis=0)
    material = None
    if "MaterialIds" in mesh.cell_data and "MaterialNames" in mesh.field_data:
        material = [str(mesh.field_data["MaterialNames"][i]) for i in mesh.cell_data["MaterialIds"]]
    return part(mesh.points, mesh.faces.reshape(-1, 4)[:, 1:], vertex=vertex, corner=corner, object=name, material=material)
