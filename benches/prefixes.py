#!/usr/bin/env python3
"""How good the beginnings of a stream are, for each aim of `--optimize`, and how large the whole is.

    cargo build --release
    benches/prefixes.py MESH... > table.md

MESH: .obj or .ply, also as .zst. Quality is that of `lwc compare`: −20·log10(RMS / diagonal), the larger
of the two directions, at 5, 10, 20 and 50 % of the bytes of Draco's file of as many bits (-cl 10), or
of lwc's own file for `size` if draco_encoder is not installed.
"""
import argparse
import json
import pathlib
import subprocess

from common import LWC, draco_encoder, has_draco, unpacked

AIMS = ["size", "balanced", "prefix"]
SHARES = [0.05, 0.1, 0.2, 0.5]


def lwc(*arguments):
    done = subprocess.run([LWC, *map(str, arguments)], check=True, capture_output=True, text=True)
    return done.stdout


def draco_bytes(mesh, bits, folder):
    out = folder / "m.drc"
    subprocess.run(draco_encoder(mesh, bits, out), check=True, capture_output=True)
    return out.stat().st_size


def quality(mesh, stream, count):
    early = stream.with_name("early.lwc")
    early.write_bytes(stream.read_bytes()[:count])
    done = subprocess.run([LWC, "compare", mesh, early, "--json"], capture_output=True, text=True)
    return f"{json.loads(done.stdout)['db']:.1f}" if done.returncode == 0 else "–"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meshes", nargs="+", type=pathlib.Path)
    parser.add_argument("--bits", type=int, default=12)
    options = parser.parse_args()
    with_draco = has_draco()
    print("| mesh | Draco, bpv | aim | bpv | 5 % | 10 % | 20 % | 50 % |")
    print("|---|--:|---|--:|--:|--:|--:|--:|")
    for path in options.meshes:
        with unpacked(path) as (folder, mesh):
            whole = draco_bytes(mesh, options.bits, folder) if with_draco else None
            for aim in AIMS:
                stream = folder / f"{aim}.lwc"
                lwc("encode", mesh, "-q", options.bits, "--optimize", aim, "-o", stream, "--quiet")
                size = stream.stat().st_size
                vertices = json.loads(lwc("info", "--json", stream))["passes"][-1]["vertices"]
                whole = whole or size
                cells = [mesh.stem, f"{8 * whole / vertices:.2f}" if with_draco else "–", aim, f"{8 * size / vertices:.2f}"]
                cells += [quality(mesh, stream, int(share * whole)) for share in SHARES]
                print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
