"""`read.py PROGRAM FILE` prints, as JSON, what a program makes of a file. Each call is a process: a crash ends one cell."""

import contextlib
import importlib
import json
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))


def main(program, path):
    with contextlib.redirect_stdout(sys.stderr):
        version, parts = importlib.import_module("readers." + program).read(path)
    print("\n@@@" + json.dumps({"version": version, "parts": parts}))


if __name__ == "__main__":
    main(*sys.argv[1:])
    sys.stdout.flush()
    os._exit(0)  # Some modules crash while they are unloaded, after all has been read.
