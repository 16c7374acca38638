"""From trimesh and back: prints how close each prefix of the stream is.

    pip install trimesh scipy && python with_trimesh.py [MESH]
"""

import sys

import numpy as np
import trimesh

import lwc


def main(path: str | None = None) -> None:
    mesh = trimesh.load_mesh(path) if path else trimesh.creation.torus(2.0, 0.7, 96, 48)
    stream = lwc.encode(mesh.vertices, mesh.faces, descriptor="harris3d")
    print(f"{len(mesh.vertices)} vertices in {len(stream)} bytes")
    decoder = lwc.Decoder()
    for update in decoder.push(stream[: len(stream) // 4]):
        print(update)
    coarse = trimesh.Trimesh(*decoder.mesh(), process=False)
    whole = trimesh.Trimesh(*lwc.decode(stream), process=False)
    print(f"volume {coarse.volume:.4f} from a quarter, {whole.volume:.4f} from all, {mesh.volume:.4f} before")
    assert np.isclose(whole.volume, mesh.volume, rtol=1e-2)


if __name__ == "__main__":
    main(*sys.argv[1:])
