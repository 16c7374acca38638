"""glTF Transform, `NodeIO.read`."""

from readers.node import parts_of


def read(path):
    result = parts_of("gltf_transform.mjs", path)
    return result["version"], result["parts"]
