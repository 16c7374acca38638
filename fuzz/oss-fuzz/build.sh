#!/bin/bash -eu
# Builds all fuzz targets into $OUT, each with its seeds as NAME_seed_corpus.zip. OSS-Fuzz sets SRC and OUT.
cd "$SRC/lwc"

# The C of zstd comes from another compiler than the sanitizer of Rust: it reports arrays there that are fine.
export CFLAGS="${CFLAGS:-} -fno-sanitize=all"
export CXXFLAGS="${CXXFLAGS:-} -fno-sanitize=all"

sh fuzz/seed.sh
cargo fuzz build -O --debug-assertions

built="${CARGO_TARGET_DIR:-fuzz/target}/x86_64-unknown-linux-gnu/release"
for target in $(cargo fuzz list); do
    cp "$built/$target" "$OUT/"
    zip -q -j -r "$OUT/${target}_seed_corpus.zip" "fuzz/corpus/$target"
    # As .ci/run: inputs that take long or much are findings.
    printf '[libfuzzer]\nrss_limit_mb = 3000\ntimeout = 20\n' > "$OUT/$target.options"
done
