"""three.js, by its four loaders."""

from readers.command import node_version
from readers.node import parts_of


def read(path):
    return node_version("three"), parts_of("three.mjs", path)
