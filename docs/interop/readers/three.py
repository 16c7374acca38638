"""three.js, by its four loaders."""

from readers.node import parts_of


def read(path):
    result = parts_of("three.mjs", path)
    return result["version"], result["parts"]
