"""gltfpack without quantization, keeping names and attributes: `-noq -kn -km -kv`."""

import truth
from readers.command import WORK, copy_in_a_folder, node_version, run


def read(path):
    folder, copy = copy_in_a_folder(path)
    program = WORK / "node" / "node_modules" / ".bin" / "gltfpack"
    run(program, "-i", copy, "-o", folder / "packed.glb", "-noq", "-kn", "-km", "-kv")
    return node_version("gltfpack"), truth.read(folder / "packed.glb")
