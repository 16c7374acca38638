"""What the comparisons share: the program, Draco beside it, and meshes unpacked."""
import contextlib
import pathlib
import shutil
import subprocess
import tempfile

LWC = pathlib.Path(__file__).resolve().parent.parent / "target" / "release" / "lwc"


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
