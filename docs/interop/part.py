"""What a program makes of a file: a list of parts, one for each of its objects.

A part is a dictionary that JSON can hold: `points` and `triangles` in the program's own order, and values at the corners
of the triangles, since that is where programs agree on what a value belongs to.
"""

import numpy as np


def part(points, triangles, *, vertex=None, corner=None, object=None, material=None):
    """`vertex` and `corner` map names to values, one a vertex or three a triangle; a number of values that does not fit is told in
    `stray`. `object` and `material` are one name, or one a triangle."""
    points = np.asarray(points, float).reshape(-1, 3)
    triangles = np.asarray(triangles, int).reshape(-1, 3)
    vertex = {name: np.asarray(values) for name, values in (vertex or {}).items() if values is not None and np.size(values)}
    stray = {name: f"{len(values)} values for {len(points)} vertices" for name, values in vertex.items() if len(values) != len(points)}
    corners = {name: rows(values, len(points))[triangles] for name, values in vertex.items() if name not in stray}
    for name, values in (corner or {}).items():
        if values is not None and np.size(values):
            corners[name] = rows(values, 3 * len(triangles)).reshape(len(triangles), 3, -1)
    return {
        "points": points.tolist(),
        "triangles": triangles.tolist(),
        "corners": {name: np.asarray(values, float).tolist() for name, values in corners.items()},
        "object": per_triangle(object, len(triangles)),
        "material": per_triangle(material, len(triangles)),
        "stray": stray,
    }


def rows(values, count):
    return np.asarray(values, float).reshape(count, -1)


def per_triangle(name, count):
    return list(name) if isinstance(name, (list, tuple)) else [name] * count


def moved(points, matrix):
    points = np.asarray(points, float).reshape(-1, 3)
    return points @ np.asarray(matrix)[:3, :3].T + np.asarray(matrix)[:3, 3]


def turned(normals, matrix):
    return np.asarray(normals, float).reshape(-1, 3) @ np.linalg.inv(np.asarray(matrix)[:3, :3])
