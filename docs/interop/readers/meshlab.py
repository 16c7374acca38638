"""MeshLab as the module pymeshlab."""

from importlib.metadata import version

import pymeshlab

from part import moved, part, turned

VERSION = version("pymeshlab")


def read(path):
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(path)
    return VERSION, [mesh_part(mesh) for mesh in meshes]


def mesh_part(mesh):
    matrix = mesh.transform_matrix()
    vertex = {"normal": turned(mesh.vertex_normal_matrix(), matrix)}
    corner = {}
    if mesh.has_vertex_color():
        vertex["colour"] = mesh.vertex_color_matrix()
    if mesh.has_vertex_tex_coord():
        vertex["uv"] = mesh.vertex_tex_coord_matrix()
    if mesh.has_wedge_tex_coord():
        corner["uv"] = mesh.wedge_tex_coord_matrix()
    if mesh.has_vertex_scalar():
        vertex["vertex scalar"] = mesh.vertex_scalar_array()
    return part(moved(mesh.vertex_matrix(), matrix), mesh.face_matrix(), vertex=vertex, corner=corner, object=mesh.label())
