#!/usr/bin/env python3
"""The default weights of a base mesh in tables (format/SPEC.md, section 7.13): medians of those that are fitted to meshes.

    cargo build --release && benches/weights.py MESH...

Prints them as they are in src/passes/base_tables/weights.rs.
"""

import pathlib
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "format"))
import reference_decoder as reference


def weights(mesh, folder):
    stream = folder / "mesh.lwc"
    options = ["--profile", "fast", "--levels", "0", "--quiet"]
    subprocess.run([ROOT / "target/release/lwc", "encode", mesh, "-o", stream, *options], check=True)
    data, rows = stream.read_bytes(), []
    for kind, payload in reference.chunks(data, rows):
        if kind == "L":
            rows.extend(reference.read_table(payload, 30)[0])
        if kind == "B" and payload[0] == 1:
            reader = reference.Reader(payload[1:])
            base = reference.TableBase.__new__(reference.TableBase)
            base.read_weights(reference.RangeDecoder(reader.take(reader.varint())))
            return base.predictions, base.sizes
    return None


def median(values):
    """Of numbers, or of lists of the same shape place by place."""
    if isinstance(values[0], int):
        return round(statistics.median(values))
    return [median(list(same)) for same in zip(*values)]


def main():
    with tempfile.TemporaryDirectory() as folder:
        found = [weights(mesh, pathlib.Path(folder)) for mesh in sys.argv[1:]]
    for part in median([w for w in found if w]):
        print(*part, sep=",\n")


if __name__ == "__main__":
    main()
