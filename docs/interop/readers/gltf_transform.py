"""glTF Transform, `NodeIO.read`."""

from readers.command import node_version
from readers.node import parts_of


def read(path):
    return node_version("@gltf-transform/core"), parts_of("gltf_transform.mjs", path)
