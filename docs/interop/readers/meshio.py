"""meshio, `meshio.read`."""

from importlib.metadata import version

import meshio
import numpy as np

from part import part

VERSION = version("meshio")


def read(path):
    mesh = meshio.read(path)
    triangles = np.concatenate([block.data for block in mesh.cells if block.type == "triangle"])
    columns = {name: np.asarray(values) for name, values in mesh.point_data.items()}
    vertex = {}
    for ours, members in {"normal": ["nx", "ny", "nz"], "uv": ["s", "t"], "colour": ["red", "green", "blue", "alpha"]}.items():
        found = [columns.pop(member) for member in members if member in columns]
        if found:
            vertex[ours] = np.stack(found, axis=1)
    vertex |= {{"obj:vn": "normal", "obj:vt": "uv"}.get(k, k): v for k, v in columns.items() if len(v) == len(mesh.points)}
    if mesh.points.shape[1] == 6:  # Colours of OBJ count as coordinates.
        vertex["colour"] = mesh.points[:, 3:]
    corner = {}
    for name, blocks in mesh.cell_data.items():
        values = np.concatenate([np.asarray(b, float) for b in blocks])
        if name == "facet_normals":
            corner["normal"] = np.repeat(values, 3, axis=0)
    return VERSION, [part(mesh.points[:, :3], triangles, vertex=vertex, corner=corner)]
