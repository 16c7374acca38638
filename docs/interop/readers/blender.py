"""Blender as the module bpy, with the axes of the file (glTF is always turned to z up)."""

import bpy
import numpy as np

from part import moved, part, turned

OPERATORS = {
    "ply": lambda path: bpy.ops.wm.ply_import(filepath=path),
    "obj": lambda path: bpy.ops.wm.obj_import(filepath=path, forward_axis="Y", up_axis="Z"),
    "stl": lambda path: bpy.ops.wm.stl_import(filepath=path),
    "glb": lambda path: bpy.ops.import_scene.gltf(filepath=path),
}


def read(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    OPERATORS[path.rsplit(".", 1)[1]](path)
    objects = [o for o in bpy.data.objects if o.type == "MESH"]
    return bpy.app.version_string, [object_part(o) for o in objects]


def object_part(thing):
    mesh, matrix = thing.data, np.array(thing.matrix_world)
    mesh.calc_loop_triangles()
    triangles = [list(t.vertices) for t in mesh.loop_triangles]
    loops = np.array([list(t.loops) for t in mesh.loop_triangles]).ravel()
    corner = {"normal": turned([mesh.corner_normals[i].vector for i in loops], matrix)}
    if mesh.uv_layers:
        corner["uv"] = [mesh.uv_layers[0].data[i].uv for i in loops]
    for attribute in mesh.attributes:
        name = "colour" if attribute == mesh.color_attributes.active_color else attribute.name
        if attribute.data_type in ("FLOAT", "INT", "FLOAT_COLOR", "BYTE_COLOR") and attribute.domain in ("POINT", "CORNER"):
            if not name.startswith(".") and name not in ("sharp_edge", "material_index"):
                corner[name] = values(attribute, mesh, loops)
    slots = [slot.name for slot in mesh.materials]
    materials = [slots[t.material_index] if slots else None for t in mesh.loop_triangles]
    points = moved([v.co for v in mesh.vertices], matrix)
    return part(points, triangles, corner=corner, object=thing.name, material=materials)


def values(attribute, mesh, loops):
    """`color` is linear, whatever the type; `color_srgb` would be what the user sees in the picker."""
    key = "color" if attribute.data_type.endswith("COLOR") else "value"
    places = loops if attribute.domain == "CORNER" else [mesh.loops[i].vertex_index for i in loops]
    return [np.ravel(getattr(attribute.data[i], key)) for i in places]
