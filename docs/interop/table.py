"""Reads each file in each program, and puts the tables into `docs/interop.md`, between its markers.

`table.py FOLDER PAGE`: the folder has `source.glb`, `model.ply` and so on.
"""

import datetime
import json
import re
import subprocess
import sys
from pathlib import Path

from judge import COLUMNS, NONE, judge
import truth

HERE = Path(__file__).resolve().parent
ALL = ("ply", "obj", "glb", "stl")
PROGRAMS = [  # The reader, its name in the table, the formats that it reads.
    ("blender", "Blender", ALL),
    ("meshlab", "MeshLab (pymeshlab)", ALL),
    ("cloudcompare", "CloudCompare", ("ply", "obj", "stl")),
    ("open3d_legacy", "Open3D, `io`", ALL),
    ("open3d_tensor", "Open3D, `t.io`", ALL),
    ("trimesh_default", "trimesh", ALL),
    ("trimesh_unprocessed", "trimesh, unprocessed", ALL),
    ("meshio", "meshio", ("ply", "obj", "stl")),
    ("vtk", "VTK (PyVista)", ALL),
    ("assimp", "assimp", ALL),
    ("three", "three.js", ALL),
    ("gltf_transform", "glTF Transform", ("glb",)),
    ("gltfpack", "gltfpack", ("obj", "glb")),
    ("draco", "Draco", ALL),
]
FILES = [
    ("model.ply", "PLY"),
    ("split.ply", "PLY with `--split-seams`"),
    ("model.obj", "OBJ"),
    ("split.obj", "OBJ with `--split-seams`"),
    ("model.glb", "GLB"),
    ("model.stl", "STL"),
]


def main(folder, page):
    text = f"Made on {datetime.date.today().isoformat()} by `docs/interop/run.sh`.\n"
    for name, title in FILES:
        path = Path(folder) / name
        if path.exists():
            text += f"\n### {title}\n\n{table(path)}"
    page = Path(page)
    pattern = re.compile(r"(<!-- table begin -->\n).*?(<!-- table end -->)", re.S)
    page.write_text(pattern.sub(lambda m: m[1] + "\n" + text + "\n" + m[2], page.read_text()))


def table(path):
    rows = [["program", "version"] + COLUMNS, ["---"] * (2 + len(COLUMNS))]
    rows.append(["*the file*", ""] + in_the_file(path))
    for reader, name, formats in PROGRAMS:
        if path.suffix[1:] in formats:
            print(path.name, name, file=sys.stderr, flush=True)
            rows.append([name] + row(reader, path))
    return "".join("| " + " | ".join(cells) + " |\n" for cells in rows)


def in_the_file(path):
    """What there is to arrive, compared with the source; all other rows are compared with the file."""
    return judge(path.parent / "source.glb", truth.read(path))


def row(reader, path):
    """Version and cells; a program that is not there or reads nothing says so in its first cell."""
    dash = [NONE] * (len(COLUMNS) - 1)
    try:
        done = subprocess.run([sys.executable, HERE / "read.py", reader, path], capture_output=True, text=True, timeout=300)
    except subprocess.TimeoutExpired:
        return [NONE, "no answer in five minutes"] + dash
    if "@@@" not in done.stdout:
        return [NONE, failure(done)] + dash
    result = json.loads(done.stdout.split("@@@", 1)[1])
    return [result["version"]] + judge(path, result["parts"])


MISSING = re.compile(r"ModuleNotFoundError|ERR_MODULE_NOT_FOUND|FileNotFoundError.*(assimp|CloudCompare|draco_|node|gltfpack)")


def failure(done):
    last = (done.stderr.strip().splitlines() or [""])[-1]
    if MISSING.search(last):
        return "not installed here"
    return "refused: " + last[:120].replace("|", "\\|") if done.returncode > 0 else f"crashed (signal {-done.returncode})"


if __name__ == "__main__":
    main(*sys.argv[1:])
