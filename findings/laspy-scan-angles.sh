#!/usr/bin/env bash
# laspy.convert() sets all scan angles to zero between the old and the new point formats, and class 12 is not turned.
#
# Expected: formats 0 to 5 store the angle as whole degrees, 6 to 10 in steps of 0.006 degrees: 30 becomes 5000.
# Happens:  the fields have two names, scan_angle_rank and scan_angle, and convert() copies by name. The new one is
#           0, which means "straight down" and not "unknown", so filters by angle keep everything. Class 12, in old
#           formats the overlap points, is a reserved class in the new ones, where overlap is a flag: it stays class
#           12 and the flag stays 0. No warning; lost_dimensions() names the old field, if asked.
# Seen:     2026-12-01, laspy 2.7.0. LAS 1.4 R15, tables of point formats 0 and 6 and of their classes.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check laspy==2.7.0 numpy==2.4.6
cd "$work"
"$work/venv/bin/python" - <<'PY'
import warnings
from importlib.metadata import version

import laspy
import numpy as np

warnings.simplefilter("error")


def cloud(point_format, las_version):
    las = laspy.LasData(laspy.LasHeader(point_format=point_format, version=las_version))
    las.x = las.y = las.z = np.zeros(3)
    return las


old = cloud(1, "1.2")
old.scan_angle_rank = np.array([-30, 0, 30])
old.classification = np.array([2, 12, 2])
up = laspy.convert(old, point_format_id=6)
new = cloud(6, "1.4")
new.scan_angle = np.array([-5000, 0, 5000])
down = laspy.convert(new, point_format_id=1)

print("laspy", version("laspy"))
print("1 to 6: degrees -30 0 30 ->", np.array(up.scan_angle), "of 0.006 degrees")
print("        classes 2 12 2 ->", np.array(up.classification), "overlap", np.array(up.overlap))
print("6 to 1: -5000 0 5000 ->", np.array(down.scan_angle_rank), "degrees")
print("lost_dimensions(1, 6):", laspy.lost_dimensions(1, 6))
assert not np.array(up.scan_angle).any() and not np.array(down.scan_angle_rank).any()
assert np.array(up.classification).tolist() == [2, 12, 2] and not np.array(up.overlap).any()
assert laspy.lost_dimensions(1, 6) == ["scan_angle_rank"]
PY
