#!/usr/bin/env python3
"""Bits per vertex of attributes: lwc beside Draco with the same bits.

    cargo build --release
    benches/attributes.py [--optimize balanced] [--lwc PATH] MESH... > table.md

MESH: .obj or .ply, also as .zst (unpacked with `zstd` first). Both programs get 12 bits for positions, 8 for normals on the
octahedron, 10 for texture coordinates and keep colours of 8 bits: `draco_encoder -cl 10 -qp 12 -qn 8 -qt 10`. What
attributes take is the difference to the same mesh without them. For that Draco gets the mesh anew from `lwc decode` of a
stream without attributes, on the same grid. Vertices are those of the finest level, repeated ones included.
"""
import argparse
import json
import pathlib
import subprocess

from peers import LWC, has_draco, unpacked


def size(command, out):
    """Bytes that a command writes."""
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return out.stat().st_size


def lwc(program, mesh, out, *options):
    """What `lwc encode --json` reports."""
    command = [program, "encode", mesh, "-o", out, "--json", "--quiet", *options]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)


def measure(program, path, optimize):
    """Vertices; bytes with and without attributes of lwc, of Draco; bytes of each attribute."""
    with unpacked(path) as (folder, mesh):
        ours = [lwc(program, mesh, folder / name, "--optimize", optimize, *options)
                for name, options in [("full.lwc", []), ("bare.lwc", ["--no-attributes"])]]
        info = subprocess.run([program, "info", "--json", folder / "full.lwc"], check=True, stdout=subprocess.PIPE)
        parts = {a["name"]: a["bytes"] for a in json.loads(info.stdout)["attributes"]}
        theirs = None
        if has_draco():
            bare = folder / "bare.obj"
            subprocess.run([program, "decode", folder / "bare.lwc", "-o", bare, "--quiet"], check=True)
            bits = ["-cl", "10", "-qp", "12", "-qn", "8", "-qt", "10"]
            theirs = [size(["draco_encoder", "-i", source, "-o", folder / "x.drc", *bits], folder / "x.drc")
                      for source in (mesh, bare)]
        return ours[0]["vertices"], [run["bytes"] for run in ours], theirs, parts


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("meshes", nargs="+", type=pathlib.Path)
    parser.add_argument("--optimize", default="balanced")
    parser.add_argument("--lwc", default=LWC)
    arguments = parser.parse_args()
    print("| mesh | vertices | lwc | of that attributes | each | Draco | of that attributes | lwc / Draco |")
    print("|---|--:|--:|--:|---|--:|--:|--:|")
    for path in arguments.meshes:
        vertices, ours, theirs, parts = measure(arguments.lwc, path, arguments.optimize)
        bits = lambda count: "%.2f" % (8 * count / vertices)
        each = ", ".join("%s %s" % (name, bits(count)) for name, count in parts.items())
        row = [path.name, "{:,}".format(vertices), bits(ours[0]), bits(ours[0] - ours[1]), each]
        row += [bits(theirs[0]), bits(theirs[0] - theirs[1]), "%.3f" % (ours[0] / theirs[0])] if theirs else ["–"] * 3
        print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()
