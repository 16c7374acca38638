#!/usr/bin/env python3
"""What each part of the coder gains: builds lwc with one part after the other switched off.

    benches/ablation.py [--only TEXT] MESH... > table.md

MESH: .obj, .ply or .stl, also as .zst. Every variant is a copy of the sources in which some words are
replaced (below), built in target/ablation, and checked: it is a codec of its own. Sizes are
the mean over the meshes of the change in per cent, with `--optimize size --levels 99` and with the default; dB the
mean change of the default's prefixes at 5, 10, 20 and 50 % of its whole file as it is. A part that is
off makes files larger and prefixes worse by so much.
"""
import argparse
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
TARGET = ROOT / "target" / "ablation"
SHARES = [0.05, 0.1, 0.2, 0.5]

GUESS = "src/passes/coordinate_prediction.rs"
SPECIALISTS = "src/entropy/specialists.rs"
PARTITION = "src/simplification/partition.rs"
THINNING = "src/simplification/vertex_selection.rs"
# What is switched off: file, words, other words.
PARTS = {
    "Prediction: true outer vertices, not those of the coarse mesh": [
        ("src/passes/coding_context.rs", r"if \(tip as usize\) < vertex \{", "if (tip as usize) < vertex && coarse == NO_CORNER {"),
    ],
    "Prediction: guesses moved along the tangent plane": [
        (GUESS, r"let slopes = slopes\(normal, axes\);", "let slopes = slopes(Lanes::ZERO, axes);"),
    ],
    "Prediction: a filter of its own across the surface": [
        (GUESS, r"weight\.0\[axes\[ACROSS\]\] = across\[i\];", "let _ = across;"),
        (GUESS, r"\[usize::from\(kind == ACROSS\)\]", "[0]"),
    ],
    "Prediction: the affine expert": [
        (GUESS, r"FIRST_TRUST: Lanes = Lanes\(\[.*\]\)", "FIRST_TRUST: Lanes = Lanes([0.0, 0.5, 0.5, 0.0])"),
        (GUESS, r"LEAST_TRUST: Lanes = Lanes\(\[.*\]\)", "LEAST_TRUST: Lanes = Lanes([0.0, 0.02, 0.02, 0.0])"),
    ],
    "Prediction: median and mode of simple guesses": [
        (GUESS, r"FIRST_TRUST: Lanes = Lanes\(\[.*\]\)", "FIRST_TRUST: Lanes = Lanes([1.0, 0.0, 0.0, 0.0])"),
        (GUESS, r"LEAST_TRUST: Lanes = Lanes\(\[.*\]\)", "LEAST_TRUST: Lanes = Lanes([0.02, 0.0, 0.0, 0.0])"),
    ],
    "Prediction: coordinates that neighbours repeat": [
        (GUESS, r"let weight = (models\.repeated\[.*\.weight);", r"let weight = 0.0 * \1;"),
    ],
    "Densities: experts weighed by how they did": [(GUESS, r"TRUST_RATE: f32 = .*;", "TRUST_RATE: f32 = 0.0;")],
    "Densities: scales learnt on the way": [(GUESS, r"SCALE_RATE: f32 = .*;", "SCALE_RATE: f32 = 0.0;")],
    "Residuals: the density as an input of the mixers": [
        ("src/entropy/residual.rs", r"\[tables\.stretch_real\([^\]]*\)\]", "[]"),
    ],
    "Mixing: what size adds, by max": [
        ("src/bitstream/profile.rs", r"Profile::Max => Mixing::Specialised", "Profile::Max => Mixing::Plain"),
    ],
    "Mixing: in max, weights of each value of a context": [(SPECIALISTS, r"SHARE: f32 = .*;", "SHARE: f32 = 0.0;")],
    "Mixing: in max, corrections behind": [
        (SPECIALISTS, r"\(\(sum / n as f32\) as u32\)", "{ let _ = sum; tables.squash(together) }"),
    ],
    "Mixing: in max, young counters weakened": [(SPECIALISTS, r"CAUTION: f32 = .*;", "CAUTION: f32 = 1.0;")],
    "Residuals: contexts of the neighbourhood beside it": [
        ("src/passes/coordinates.rs", r"contexts: \[\n[^\]]*\]", "contexts: [0, 0]"),
        ("src/passes/coordinates.rs", r"sign: 2 \* class \+ usize::from\(guess\.leans_down\)", "sign: 0"),
    ],
    "Connectivity: whether patches fit the rule, as a context": [
        ("src/passes/connectivity/contexts.rs", r"fits\.map\(\|fit\| fit as usize\)", "[fits[0], Fit::Unknown, Fit::Unknown].map(|fit| fit as usize)"),
    ],
    "Connectivity: holes closed in the reverse order of the walk": [
        (PARTITION, r"order\.into_iter\(\)\.rev\(\)\.partition", "order.into_iter().partition"),
    ],
    "Selection: next to what is removed already": [
        ("src/simplification/bucket_queue.rs", r"const WEIGHT: f64 = 0\.7;", "const WEIGHT: f64 = 0.0;"),
    ],
    "Schedule: precision that follows the error": [
        ("src/encoder/schedule.rs", r"let base_bits = if num_levels > 0 .*;", "let base_bits = quantization_bits;"),
    ],
    "Choice: errors against the original surface": [
        (THINNING, r"mut errors: Vec<f64>,", "errors: Vec<f64>,"),
        (THINNING, r"let num_vertices = errors\.len\(\);", "let num_vertices = errors.len(); let mut errors = vec![1.0; num_vertices];"),
    ],
    "Choice: the descriptor": [
        (THINNING, r"libm::exp2\(2\.0 \* rank - 1\.0\)", "{ let _ = rank; 1.0 }"),
    ],
    "Choice: creases stay where flat parts can go": [
        (THINNING, r"Some\(OUTLIER\)", "Some(OUTLIER).filter(|_| false)"),
    ],
    "Choice: holes closed close to the surface": [
        (PARTITION, r"thinning\.tolerance,", "f64::INFINITY,"),
    ],
    "Compensation: coarse meshes shown where they shrink less": [
        ("src/encoder/pass_writer.rs", r"let compensation = if is_last \{", "let compensation = if is_last || true {"),
    ],
}


def build(edits, folder):
    """Copies the sources, replaces, builds; the program."""
    folder = folder / "lwc"
    ignore = shutil.ignore_patterns(".git", "target", "node_modules", "dist", "corpus", "__pycache__")
    shutil.copytree(ROOT, folder, ignore=ignore)
    for file, words, others in edits:
        path = folder / file
        text, count = re.subn(words, others, path.read_text())
        if count == 0:
            raise SystemExit(f"{file} has no `{words}` any more")
        path.write_text(text)
    features = ["--no-default-features", "--features", "encoder,io,metrics"]
    command = ["cargo", "build", "--release", "--quiet", "--example", "measure", "--target-dir", TARGET, *features]
    subprocess.run(command, cwd=folder, check=True)
    program = folder / "program"
    shutil.copy(TARGET / "release" / "examples" / "measure", program)
    return program


def measure(program, meshes, budgets):
    """Per mesh: bytes for size, bytes by default, dB at the shares of the budget or of the own bytes."""
    figures = []
    for i, mesh in enumerate(meshes):
        budget = [str(budgets[i])] if budgets else []
        done = subprocess.run([program, mesh, *budget], check=True, capture_output=True, text=True)
        found = json.loads(done.stdout)
        figures.append((found["size"], found["usual"], found["db"]))
    return figures


def mean(values):
    values = [value for value in values if not math.isnan(value)]
    return sum(values) / len(values) if values else math.nan


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meshes", nargs="+", type=pathlib.Path)
    parser.add_argument("--only", default="", help="parts whose name has this in it")
    options = parser.parse_args()
    meshes = [mesh.resolve() for mesh in options.meshes]
    base = None
    columns = ["off", "size", "default", *(f"{100 * share:.0f} %" for share in SHARES)]
    print("| " + " | ".join(columns) + " |\n|---" + "|--:" * (len(columns) - 1) + "|")
    for name, edits in {"": [], **PARTS}.items():
        if options.only not in name and edits:
            continue
        print(name or "as it is", file=sys.stderr)
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            program = build(edits, folder)
            figures = measure(program, meshes, [row[1] for row in base] if base else None)
        if base is None:
            base = figures
            continue
        cells = [f"{100 * mean([new[k] / old[k] - 1 for new, old in zip(figures, base)]):+.2f} %" for k in (0, 1)]
        cells += [f"{mean([new[2][k] - old[2][k] for new, old in zip(figures, base)]):+.1f} dB" for k in range(len(SHARES))]
        print("| " + " | ".join([name, *cells]) + " |", flush=True)


if __name__ == "__main__":
    main()
