#!/usr/bin/env python3
"""Sizes, times and memory of whole commands: lwc beside draco_encoder and draco_decoder.

    cargo build --profile dist
    benches/peers.py [--runs 5] MESH... > table.md

MESH: .obj or .ply, also as .zst (unpacked with `zstd` first, so that both programs read the same
file). Times are user + system CPU seconds of one process, the least of the runs, the programs taking
turns; lwc encodes with all cores and decodes with one. Memory is the peak of the resident set.
Draco runs with -cl 10 and the same number of bits, without normals and texture coordinates; colours it
cannot leave out, so give it meshes without. If it is not installed, its columns say so.
"""
import argparse
import contextlib
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

LWC = pathlib.Path(__file__).resolve().parent.parent / "target" / "dist" / "lwc"


def has_draco():
    return shutil.which("draco_encoder") is not None


def draco_encoder(mesh, bits, out):
    """The command: positions only, as small as it can."""
    skip = ["--skip", "NORMAL", "--skip", "TEX_COORD"]
    return ["draco_encoder", "-i", str(mesh), "-qp", str(bits), "-cl", "10", *skip, "-o", str(out)]


@contextlib.contextmanager
def unpacked(path):
    """A folder that goes away, and the mesh as a file that every program reads."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        mesh = path
        if path.suffix == ".zst":
            mesh = folder / path.stem
            subprocess.run(["zstd", "-q", "-d", path, "-o", mesh], check=True)
        yield folder, mesh


def run(command):
    """Wall seconds, CPU seconds and peak MiB of one command."""
    start = time.perf_counter()
    pid = os.posix_spawnp(command[0], command, os.environ, file_actions=[
        (os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0),
        (os.POSIX_SPAWN_OPEN, 2, os.devnull, os.O_WRONLY, 0),
    ])
    _, status, usage = os.wait4(pid, 0)
    if status:
        raise SystemExit(f"failed: {' '.join(map(str, command))}")
    return time.perf_counter() - start, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def best(runs):
    """Least of each figure over the runs."""
    return [min(column) for column in zip(*runs)]


def measure(mesh, bits, runs, folder, with_draco):
    lwc, drc, out = folder / "m.lwc", folder / "m.drc", folder / "out.ply"
    jobs = {
        "encode": [LWC, "encode", "--quiet", mesh, "-q", str(bits), "-o", lwc],
        "decode": [LWC, "decode", "--quiet", lwc, "-o", out],
    }
    if with_draco:
        jobs["draco encode"] = draco_encoder(mesh, bits, drc)
        jobs["draco decode"] = ["draco_decoder", "-i", drc, "-o", out]
    figures = {name: [] for name in jobs}
    for _ in range(runs):
        for name, command in jobs.items():
            figures[name].append(run([str(c) for c in command]))
    figures = {name: best(rows) for name, rows in figures.items()}
    info = subprocess.run([LWC, "info", "--json", lwc], capture_output=True, check=True, text=True)
    return figures, info.stdout, lwc.stat().st_size, drc.stat().st_size if with_draco else None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meshes", nargs="+", type=pathlib.Path)
    parser.add_argument("--bits", type=int, default=12)
    parser.add_argument("--runs", type=int, default=5)
    options = parser.parse_args()
    with_draco = has_draco()
    if not with_draco:
        print("draco_encoder is not installed: its columns are empty", file=sys.stderr)
    print("| mesh | vertices | lwc, bpv | Draco, bpv | size, ratio | encode, kv/s wall | CPU ratio to Draco "
          "| decode, kv/s CPU | CPU ratio to Draco | encoder, bytes/v | decoder, bytes/v |")
    print("|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|")
    for path in options.meshes:
        with unpacked(path) as (folder, mesh):
            figures, info, size, draco = measure(mesh, options.bits, options.runs, folder, with_draco)
            passes = json.loads(info)["passes"]
            vertices = passes[-1]["vertices"]
            wall, cpu_encode, mib_encode = figures["encode"]
            _, cpu_decode, mib_decode = figures["decode"]
            cells = [mesh.stem, f"{vertices:,}", f"{8 * size / vertices:.2f}"]
            if with_draco:
                cells += [f"{8 * draco / vertices:.2f}", f"{size / draco:.2f}"]
            else:
                cells += ["–", "–"]
            cells.append(f"{vertices / wall / 1e3:.0f}")
            cells.append(f"{cpu_encode / figures['draco encode'][1]:.1f}" if with_draco else "–")
            cells.append(f"{vertices / cpu_decode / 1e3:.0f}")
            cells.append(f"{cpu_decode / figures['draco decode'][1]:.1f}" if with_draco else "–")
            cells += [f"{mib * 2**20 / vertices:.0f}" for mib in (mib_encode, mib_decode)]
            print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
