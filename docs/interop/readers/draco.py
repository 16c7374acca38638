"""draco_encoder and draco_decoder with the finest grid; draco_transcoder for glTF."""

import truth
from readers.command import copy_in_a_folder, debian_version, run
from readers.node import parts_of

FINE = ["-qp", "30", "-qt", "30", "-qn", "30"]


def read(path):
    folder, copy = copy_in_a_folder(path)
    if copy.suffix == ".glb":
        run("draco_transcoder", "-i", copy, "-o", folder / "coded.glb", *FINE, "-qc", "8", "-qg", "30")
        return debian_version("draco"), parts_of("gltf_transform.mjs", folder / "coded.glb")
    run("draco_encoder", "-i", copy, "-o", folder / "coded.drc", *FINE, "-qg", "30", "--metadata")
    run("draco_decoder", "-i", folder / "coded.drc", "-o", folder / "decoded.ply")
    return debian_version("draco"), truth.read(folder / "decoded.ply")
