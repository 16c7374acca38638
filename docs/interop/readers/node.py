"""The readers in JavaScript: `three.mjs` and `gltf_transform.mjs` print what they read as JSON."""

import json
import os

from part import part
from readers.command import HERE, WORK, run


def parts_of(script, path):
    # Modules are looked for beside the script, so it runs from the folder where they are.
    copy = WORK / "node" / script
    copy.write_text((HERE / script).read_text())
    result = json.loads(run("node", copy, os.path.abspath(path)).split("@@@", 1)[1])
    return [part(**p) for p in result["parts"]]
