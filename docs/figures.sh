#!/usr/bin/env bash
# Makes the pictures in docs/ anew, from models of this repository. Charts of the experiment are not among
# them: they come from `lwc experiment`, see docs/paper.md. Those in docs/rates/ come from benches/compare.
set -euo pipefail
cd "$(dirname "$0")/.."
cargo build --release --bin lwc --example figure_models
bin="${CARGO_TARGET_DIR:-target}/release"
lwc() { "$bin/lwc" --quiet "$@"; }
models() { "$bin/examples/figure_models" "$@"; }
work="$(mktemp -d)"
trap 'rm -r "$work"' EXIT
view="--size 480x360"

# Levels of the knot.
lwc encode tests/data/knot.ply -o "$work/knot.lwc"
lwc render "$work/knot.lwc" -o docs/levels.png --montage --levels 0,2,4,6,8,10,12,15 --columns 4 \
    --size 260x250 --view front --shading flat
lwc render "$work/knot.lwc" -o docs/strip.png --montage --levels 0,4,8,15 --columns 4 \
    --size 260x220 --view front --shading flat
lwc info "$work/knot.lwc" --plot docs/rate.svg
lwc describe tests/data/knot.ply -d harris3d -o docs/heat.png --clip 1 $view --view front

# Bands of the tube.
tube="$work/tube.ply"
models tube "$tube"
side="--size 560x160 --view 90,0"
lwc filter "$tube" --gain 15..=0 -o "$work/smooth.ply"
lwc filter "$tube" --gain 16..19=2 -o "$work/bold.ply"
lwc render "$tube" -o docs/filter-original.png $side
lwc render "$work/smooth.ply" -o docs/filter-smooth.png $side
lwc render "$work/bold.ply" -o docs/filter-bold.png $side

# Noise.
models noise "$tube" "$work/noisy.ply"
lwc filter "$work/noisy.ply" --denoise -o "$work/clean.ply"
lwc render "$work/noisy.ply" -o docs/denoise-before.png $side
lwc render "$work/clean.ply" -o docs/denoise-after.png $side

# A bent coarse level.
lwc encode "$tube" -o "$work/tube.lwc"
lwc decode "$work/tube.lwc" --level 8 -o "$work/coarse.ply"
models bend "$work/coarse.ply" "$work/bent-coarse.ply"
lwc edit "$work/tube.lwc" "$work/bent-coarse.ply" -o "$work/bent.ply"
lwc render "$work/bent-coarse.ply" -o docs/edit-coarse.png $view --view top --wireframe --shading flat
lwc render "$work/bent.ply" -o docs/edit-bent.png $view --view top

# A load beside other codecs, from figures that are there.
python3 docs/chain.py
