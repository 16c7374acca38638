"""Compares what a program has with what the file says, and says it in a few words a column.

Values are compared at the corners of triangles, which are found by the places of their corners. So neither the order nor
the number of vertices matters for a value; both have a column of their own.
"""

import numpy as np

import truth

COLUMNS = ["triangles", "vertices", "normals", "texcoords", "colours", "objects", "materials", "`_temperature`"]
STANDARD = ("normal", "uv", "colour")
NONE = "–"


def judge(path, parts):
    """One text for each of COLUMNS."""
    said = Soup(truth.read(path))
    found = Soup(in_order_of(said, parts))
    place, pairs = placed(path, said, found)
    if pairs is None:
        return ["%d triangles, other places" % len(found.corners)] + [NONE] * (len(COLUMNS) - 1)
    stray = {name: text for p in parts for name, text in p["stray"].items()}
    return [
        triangles(said, pairs, place),
        vertices(said, found),
        stray.get("normal") or normals(said, found, pairs),
        stray.get("uv") or texcoords(said, found, pairs),
        stray.get("colour") or colours(said, found, pairs),
        names(said.objects, found.objects, pairs),
        names(said.materials, found.materials, pairs),
        next((text for name, text in stray.items() if name not in STANDARD), None) or extra(said, found, pairs),
    ]


def in_order_of(said, parts):
    """A list of objects has no order that means something, so it takes that of the file."""
    place = {key(np.roll(c, -turn, axis=0)): i for i, c in enumerate(said.corners) for turn in range(3)}
    first = lambda part: min((place.get(key(c), len(place)) for c in Soup([part]).corners), default=0)
    return sorted(parts, key=first)


class Soup:
    """The triangles of all parts in one list, each with the values at its corners."""

    def __init__(self, parts):
        self.points = np.concatenate([np.reshape(p["points"], (-1, 3)) for p in parts])
        self.corners = np.concatenate([np.array(p["points"])[np.array(p["triangles"])] for p in parts])
        self.objects = [name for p in parts for name in p["object"]]
        self.materials = [name for p in parts for name in p["material"]]
        self.values = {}
        for name in dict.fromkeys(key for p in parts for key in p["corners"]):
            self.values[name] = stacked(parts, name)

    def moved(self, move):
        copy = object.__new__(Soup)
        copy.__dict__ |= self.__dict__ | {"points": move(self.points), "corners": move(self.corners)}
        if "normal" in self.values:
            copy.values = self.values | {"normal": move(self.values["normal"])}
        return copy


def stacked(parts, name):
    """NaN where a part has no such value."""
    width = max(np.shape(p["corners"][name])[-1] for p in parts if name in p["corners"])
    blocks = []
    for p in parts:
        block = np.full((len(p["triangles"]), 3, width), np.nan)
        if name in p["corners"]:
            values = np.array(p["corners"][name], float)
            block[:, :, : values.shape[-1]] = values
        blocks.append(block)
    return np.concatenate(blocks)


def placed(path, said, found):
    """How the program's triangles lie, and pairs of triangles (ours, theirs, rotation of corners)."""
    places = [("", said)]
    upright = lambda p: np.stack([p[..., 0], -p[..., 2], p[..., 1]], axis=-1)
    places.append(("turned to z up", said.moved(upright)))
    if str(path).endswith(".glb"):
        bare = Soup(truth.read_without_nodes(path))
        places += [("node translation ignored", bare), ("node translation ignored, turned to z up", bare.moved(upright))]
    best = max(places, key=lambda entry: len(matched(entry[1], found)))
    pairs = matched(best[1], found)
    said.__dict__ |= best[1].__dict__
    return best[0], pairs if len(pairs) > len(said.corners) / 2 else None


def matched(said, found):
    theirs = {}
    for index, corners in enumerate(found.corners):
        for turn in range(3):
            theirs[key(np.roll(corners, -turn, axis=0))] = (index, turn)
    return [(index, *theirs[key(corners)]) for index, corners in enumerate(said.corners) if key(corners) in theirs]


def key(corners):
    return tuple(np.round(corners.ravel(), 4) + 0.0)


def at_pairs(soup, name, pairs, ours):
    if name not in soup.values:
        return None
    if ours:
        return np.array([soup.values[name][i] for i, _, _ in pairs])
    return np.array([np.roll(soup.values[name][j], -turn, axis=0) for _, j, turn in pairs])


def triangles(said, pairs, place):
    words = ["yes" if len(pairs) == len(said.corners) else f"{len(pairs)} of {len(said.corners)}"]
    words += [place] if place else []
    return ", ".join(words)


def vertices(said, found):
    count = f"{len(found.points)}"
    if len(found.points) == len(said.points):
        if np.allclose(found.points, said.points, atol=1e-5):
            return f"{count}, same order"
        return f"{count}, other order"
    words = "merged" if len(found.points) < len(said.points) else "split"
    return f"{count} instead of {len(said.points)} ({words})"


def share(good):
    """`yes`, or how many of the corners."""
    return "yes" if good.all() else f"right at {good.sum()} of {good.size} corners"


def normals(said, found, pairs):
    ours, theirs = at_pairs(said, "normal", pairs, True), at_pairs(found, "normal", pairs, False)
    if theirs is None or np.isnan(theirs).all():
        return NONE
    close = lambda a, b: np.nan_to_num((unit(a) * unit(b)).sum(-1)) > 0.999
    flat = np.array([np.cross(t[1] - t[0], t[2] - t[0]) for t in (said.corners[i] for i, _, _ in pairs)])[:, None, :]
    if ours is not None and close(ours, theirs).mean() > 0.5:
        return share(close(ours, theirs))
    made = "flat" if close(flat, theirs).all() else "smooth" if np.isfinite(theirs).all() else "not numbers"
    made = "zeros" if np.abs(theirs).max() == 0 else made
    return f"made up, {made}" if ours is None else f"others, {made}"


def unit(v):
    with np.errstate(all="ignore"):
        return v / np.linalg.norm(v, axis=-1, keepdims=True)


def texcoords(said, found, pairs):
    ours, theirs = at_pairs(said, "uv", pairs, True), at_pairs(found, "uv", pairs, False)
    if theirs is None or np.isnan(theirs).all():
        return NONE
    if ours is None:
        return "made up"
    theirs = theirs[..., :2]
    same = np.isclose(ours, theirs, atol=1e-3).all(-1)
    turned = np.isclose(ours * [1, -1] + [0, 1], theirs, atol=1e-3).all(-1)
    return share(turned) + ", 1 − v" if turned.sum() > same.sum() else share(same)


def linear(c):
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def srgb(c):
    return np.where(c <= 0.0031308, c * 12.92, 1.055 * np.abs(c) ** (1 / 2.4) - 0.055)


def colours(said, found, pairs):
    ours, theirs = at_pairs(said, "colour", pairs, True), at_pairs(found, "colour", pairs, False)
    if theirs is None or np.isnan(theirs).all():
        return NONE
    if ours is None:
        return "made up, all alike" if len(np.unique(theirs[..., :3].reshape(-1, 3), axis=0)) == 1 else "made up"
    if np.nanmin(theirs) < 0:
        return "negative above 127"
    ours = ours / (255 if np.nanmax(ours) > 1 else 1)
    top = next(t for t in (1, 255, 65535, np.inf) if np.nanmax(theirs) <= t * 1.001)
    rgb = theirs[..., :3] / (top if np.isfinite(top) else 1)
    if not np.nan_to_num(rgb).any():
        return "black"
    ways = {"": ours[..., :3], "sRGB → linear": linear(ours[..., :3]), "linear → sRGB": srgb(ours[..., :3])}
    good = {way: np.isclose(values, rgb, atol=1.01 / 255).all(-1) for way, values in ways.items()}
    way = max(good, key=lambda w: good[w].sum())
    words = [share(good[way]), f"0–{top}"] + ([way] if way else [])
    return ", ".join(words + alpha(ours, theirs, top))


def alpha(ours, theirs, top):
    if ours.shape[-1] < 4:
        return []
    if theirs.shape[-1] < 4:
        return ["no alpha"]
    return [] if np.isclose(ours[..., 3], theirs[..., 3] / top, atol=1.01 / 255).all() else ["other alpha"]


def names(ours, theirs, pairs):
    if not any(ours):
        return NONE
    if all(ours[i] == theirs[j] for i, j, _ in pairs):
        return "yes"
    seen = list(dict.fromkeys(theirs[j] for _, j, _ in pairs))
    return NONE if not any(seen) else ", ".join(f"`{name}`" if name else "none" for name in seen)


def extra(said, found, pairs):
    name = next((n for n in said.values if n.lower().strip("_") == "temperature"), None)
    if name is None:
        return NONE
    ours = at_pairs(said, name, pairs, True)
    for other in found.values:
        if other not in STANDARD:
            theirs = at_pairs(found, other, pairs, False)[..., :1]
            if np.isclose(ours, theirs).mean() > 0.5:
                return share(np.isclose(ours, theirs)) + ("" if other == name else f", as `{other}`")
    return NONE
