"""trimesh, `trimesh.load_scene` with its defaults."""

import trimesh

from part import moved, part, turned


def read(path, **options):
    scene = trimesh.load_scene(path, **options)
    parts = []
    for node in scene.graph.nodes_geometry:
        matrix, name = scene.graph[node]
        parts.append(geometry_part(scene.geometry[name], matrix, node))
    return trimesh.__version__, parts


def geometry_part(mesh, matrix, name):
    visual = mesh.visual
    vertex = {"normal": turned(mesh.vertex_normals, matrix)}
    material = None
    if visual.kind == "texture":
        vertex["uv"] = visual.uv
        material = getattr(visual.material, "name", None)
        vertex |= {"colour" if k == "color" else k: v for k, v in visual.vertex_attributes.items()}
    elif visual.kind == "vertex":
        vertex["colour"] = visual.vertex_colors
    vertex |= {("colour" if k == "color" else k): v for k, v in mesh.vertex_attributes.items()}
    return part(moved(mesh.vertices, matrix), mesh.faces, vertex=vertex, object=name, material=material)
