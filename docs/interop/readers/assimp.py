"""assimp, by its command; without options it leaves the scene as its importer made it."""

import json

import numpy as np

from part import moved, part, turned
from readers.command import copy_in_a_folder, debian_version, run


def read(path):
    folder, copy = copy_in_a_folder(path)
    run("assimp", "export", copy.name, "out.json", "-fassjson", folder=folder)
    scene = json.loads((folder / "out.json").read_text())
    return debian_version("assimp-utils"), list(node_parts(scene, scene["rootnode"], np.eye(4)))


def node_parts(scene, node, above):
    matrix = above @ np.array(node["transformation"], float).reshape(4, 4)
    for index in node.get("meshes", []):
        yield mesh_part(scene, scene["meshes"][index], matrix, node["name"])
    for child in node.get("children", []):
        yield from node_parts(scene, child, matrix)


def mesh_part(scene, mesh, matrix, name):
    vertex = {}  # All arrays are flat.
    if "normals" in mesh:
        vertex["normal"] = turned(mesh["normals"], matrix)
    if mesh.get("texturecoords"):
        vertex["uv"] = np.reshape(mesh["texturecoords"][0], (-1, mesh["numuvcomponents"][0]))
    if mesh.get("colors"):
        vertex["colour"] = np.reshape(mesh["colors"][0], (-1, 4))
    properties = scene["materials"][mesh["materialindex"]]["properties"]
    material = next((p["value"] for p in properties if p["key"] == "?mat.name"), None)
    return part(moved(mesh["vertices"], matrix), mesh["faces"], vertex=vertex, object=name, material=material)
