"""Open3D, `open3d.t.io.read_triangle_mesh`, the newer call."""

import open3d

from part import part

NAMES = {"normals": "normal", "colors": "colour", "texture_uvs": "uv"}


def read(path):
    mesh = open3d.t.io.read_triangle_mesh(path)
    by = lambda group, left: {NAMES.get(k, k): v.numpy() for k, v in group.items() if k not in left}
    vertex = by(mesh.vertex, ["positions"])
    triangles = mesh.triangle["indices"].numpy()
    corner = {name: values for name, values in by(mesh.triangle, ["indices"]).items() if values.ndim == 3}
    return open3d.__version__, [part(mesh.vertex["positions"].numpy(), triangles, vertex=vertex, corner=corner)]
