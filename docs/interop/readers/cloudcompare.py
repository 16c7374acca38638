"""CloudCompare, by its command: what it read is what it writes again, colours as PLY, the rest as OBJ."""

import truth
from readers.command import copy_in_a_folder, debian_version, run

COMMAND = ["CloudCompare", "-SILENT", "-AUTO_SAVE", "OFF", "-NO_TIMESTAMP", "-O"]


def read(path):
    folder, copy = copy_in_a_folder(path)
    source = copy.rename(folder / ("in" + copy.suffix))
    for kind in ("PLY", "OBJ"):
        into = folder / kind
        into.mkdir()
        (into / source.name).hardlink_to(source)
        text = run(*COMMAND, source.name, "-M_EXPORT_FMT", kind, "-PLY_EXPORT_FMT", "ASCII", "-SAVE_MESHES", folder=into)
        if "[SAVING]" not in text:
            raise RuntimeError("no mesh in it")
    return debian_version("cloudcompare"), joined(folder / "PLY" / "in.ply", folder / "OBJ" / "in.obj")


def joined(ply, obj):
    coloured, named = truth.read(ply)[0], truth.read(obj)[0]
    if coloured["triangles"] != named["triangles"]:
        raise RuntimeError("its PLY and its OBJ differ")
    named["corners"].pop("colour", None)
    coloured["corners"].pop("normal", None)
    return [named | {"points": coloured["points"], "corners": coloured["corners"] | named["corners"]}]
