"""Open3D, `open3d.io.read_triangle_mesh`, the call of its tutorials."""

import numpy as np
import open3d

from part import part


def read(path):
    mesh = open3d.io.read_triangle_mesh(path)
    vertex, corner = {}, {}
    if mesh.has_vertex_normals():
        vertex["normal"] = np.asarray(mesh.vertex_normals)
    if mesh.has_vertex_colors():
        vertex["colour"] = np.asarray(mesh.vertex_colors)
    if mesh.has_triangle_uvs():
        corner["uv"] = np.asarray(mesh.triangle_uvs)
    return open3d.__version__, [part(np.asarray(mesh.vertices), np.asarray(mesh.triangles), vertex=vertex, corner=corner)]
