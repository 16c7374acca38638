#!/usr/bin/env python3
"""Draws docs/chain.svg: what a viewer has of horse after so many bytes, with lwc, with Draco and with a chain of
levels of detail. The figures come from the charts and tables of this folder:

    rates/horse.svg   the curve of `lwc balanced` and the two single files
    results.md        the best single file of each size

Run it after either has changed. Needs nothing but Python 3.
"""
import math
import pathlib
import re

DOCS = pathlib.Path(__file__).resolve().parent
WIDTH, HEIGHT = 760, 400
LEFT, RIGHT, TOP, BOTTOM = 58, 740, 40, 348
SHARES = (0.05, 0.10, 0.20, 0.50)
LWC, DRACO, CHAIN = "#266496", "#1e1e1e", "#d2781e"


def rate_chart(path):
    """Curves of a chart of benches/compare by label: lists of (bytes, dB)."""
    svg = path.read_text()
    ticks = [(int(x), int(y), float(t)) for x, y, t in
             re.findall(r'<text x="(\d+)" y="(\d+)"[^>]*>\s*([\d.]+)\s*</text>', svg)]
    x_ticks = [(x, math.log10(t)) for x, y, t in ticks if y == max(t[1] for t in ticks)]
    y_ticks = [(y, t) for x, y, t in ticks if x == min(t[0] for t in ticks)]

    def along(scale, at):
        (a, low), (b, high) = scale[0], scale[-1]
        return low + (at - a) / (b - a) * (high - low)

    lines = re.findall(r'<polyline fill="none"[^>]*stroke="(#\w+)"[^>]*points="([^"]*)"', svg)
    labels = re.findall(r'<text x="119" y="\d+"[^>]*>\s*([^<]*?)\s*</text>', svg)
    keys = [colour for colour, points in lines if points.startswith("95,")]
    assert len(labels) == len(keys)
    curves = {}
    for label, colour in zip(labels, keys):
        points = next(p for c, p in lines if c == colour and not p.startswith("95,"))
        pairs = [tuple(map(int, pair.split(","))) for pair in points.split()]
        curves[label] = [(10 ** along(x_ticks, x), along(y_ticks, y)) for x, y in pairs]
    return curves


def best_files(path):
    """dB of the best single file of horse at each of SHARES."""
    rows = [line.split("|") for line in path.read_text().splitlines() if line.startswith("|")]
    at = next(i for i, row in enumerate(rows) if [c.strip() for c in row[1:3]] == ["horse", "balanced"])
    row = next(row for row in rows[at:] if row[2].strip() == "best file")
    return [float(cell) for cell in row[3:7]]


def x(share):
    return LEFT + share / 2 * (RIGHT - LEFT)


def y(db):
    return BOTTOM - (db - 30) / 65 * (BOTTOM - TOP)


def steps(points):
    """A path that keeps the last quality until the next one is there."""
    path = f"M{x(points[0][0]):.1f},{y(30):.1f}"
    for share, db in points:
        path += f" H{x(share):.1f} V{y(db):.1f}"
    return path


def main():
    curves = rate_chart(DOCS / "rates/horse.svg")
    draco_bytes, whole = curves["Draco"][0]
    lwc = [(size / draco_bytes, db) for size, db in curves["lwc balanced"]]
    chain, sent = [], 0.0
    for share, db in zip((*SHARES, 1.0), (*best_files(DOCS / "results.md"), whole)):
        sent += share
        chain.append((sent, db))

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" '
           f'viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="13" fill="#282828">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#fff"/>',
           f'<text x="{LEFT}" y="22" font-size="15">horse, 48,485 vertices, 12 bits: quality while it loads</text>']
    for db in range(30, 91, 10):
        out.append(f'<path d="M{LEFT},{y(db):.1f} H{RIGHT}" stroke="#e1e1e1"/>'
                   f'<text x="{LEFT - 8}" y="{y(db) + 4:.1f}" text-anchor="end">{db}</text>')
    for percent in range(0, 201, 25):
        out.append(f'<text x="{x(percent / 100):.1f}" y="{BOTTOM + 18}" text-anchor="middle">{percent}</text>')
    out.append(f'<text x="{(LEFT + RIGHT) / 2}" y="{BOTTOM + 40}" text-anchor="middle">'
               "bytes received, % of Draco's file</text>")
    out.append(f'<text transform="translate(16,{(TOP + BOTTOM) / 2}) rotate(-90)" text-anchor="middle">'
               "dB (RMS distance, of the diagonal)</text>")
    out.append(f'<path d="M{LEFT},{TOP} V{BOTTOM} H{RIGHT}" fill="none" stroke="#282828"/>')
    for points, colour, dash in ((chain, CHAIN, "6 3"), ([(1.0, whole)], DRACO, "2 3"), (lwc, LWC, "")):
        out.append(f'<path d="{steps(points)}" fill="none" stroke="{colour}" stroke-width="2.2" '
                   f'stroke-dasharray="{dash}"/>')
        share, db = points[-1]
        out.append(f'<circle cx="{x(share):.1f}" cy="{y(db):.1f}" r="4" fill="{colour}"/>')
    for share, db, colour, text in (
            (0.22, 83, LWC, "lwc"),
            (1.02, 46, DRACO, "Draco: nothing before the end"),
            (1.27, 76.5, CHAIN, "a chain of five Draco files")):
        out.append(f'<text x="{x(share):.1f}" y="{y(db):.1f}" fill="{colour}" font-weight="bold">{text}</text>')
    for share, colour, anchor in ((1.0, DRACO, "end"), (lwc[-1][0], LWC, "start"), (chain[-1][0], CHAIN, "middle")):
        out.append(f'<text x="{x(share):.1f}" y="{y(whole) - 10:.1f}" fill="{colour}" text-anchor="{anchor}">'
                   f"complete at {100 * share:.0f} %</text>")
    (DOCS / "chain.svg").write_text("\n".join([*out, "</svg>", ""]))


if __name__ == "__main__":
    main()
