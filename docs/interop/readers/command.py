"""Runs the programs that are no Python module."""

import json
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

WORK = Path(os.environ.get("INTEROP_WORK", "."))
HERE = Path(__file__).resolve().parent


def run(*words, folder=None):
    done = subprocess.run([str(w) for w in words], cwd=folder, capture_output=True, text=True, timeout=120)
    if done.returncode:
        raise RuntimeError(complaint(done.stdout + done.stderr) or f"{words[0]} ended with {done.returncode}")
    return done.stdout


def complaint(text):
    """The line that says what is wrong; Node prints its version after it."""
    lines = text.strip().splitlines()
    return next((line for line in lines if "Error" in line), lines[-1] if lines else None)


def debian_version(package):
    versions = dict(line.split() for line in (WORK / "debian-versions").read_text().splitlines())
    return versions.get(package, "as found")


def node_version(package):
    return json.loads((WORK / "node" / "node_modules" / package / "package.json").read_text())["version"]


def copy_in_a_folder(path):
    """Programs that write beside their input get a folder of their own."""
    folder = Path(tempfile.mkdtemp(dir=WORK))
    return folder, Path(shutil.copy(path, folder))
