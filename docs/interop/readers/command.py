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
        lines = (done.stdout + done.stderr).strip().splitlines()
        raise RuntimeError(lines[-1] if lines else f"{words[0]} ended with {done.returncode}")
    return done.stdout


def debian_version(package):
    return dict(line.split() for line in (WORK / "debian-versions").read_text().splitlines())[package]


def node_version(package):
    return json.loads((WORK / "node" / "node_modules" / package / "package.json").read_text())["version"]


def copy_in_a_folder(path):
    """Programs that write beside their input get a folder of their own."""
    folder = Path(tempfile.mkdtemp(dir=WORK))
    return folder, Path(shutil.copy(path, folder))
