#!/usr/bin/env bash
# Builds the decoder for WebAssembly into web/dist/lwc.wasm, and with attributes into lwc-assets.wasm. With rustup:
#   rustup target add wasm32-unknown-unknown
# Where that target cannot be downloaded, Debian's rustc-web, cargo-web and rust-web-src build its
# standard library from source.
set -euo pipefail
cd "$(dirname "$0")"
target=wasm32-unknown-unknown
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/../target}/wasm"
rustflags="-C target-feature=+simd128 -C panic=abort"
# Where this machine keeps its packages and its library is nothing to ship.
rustflags+=" --remap-path-prefix=$(rustc --print sysroot)/lib/rustlib/src/rust=rust"
for packages in "${CARGO_HOME:-$HOME/.cargo}"/registry/src/*/; do
    rustflags+=" --remap-path-prefix=$packages="
done
export CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS="$rustflags"

cargo=cargo flags=()
if [ ! -e "$(rustc --print target-libdir --target $target)" ]; then
    rustc=$(dpkg -L rustc-web | grep -m1 '/bin/rustc$')
    cargo=$(dpkg -L cargo-web | grep -m1 '/bin/cargo$')
    flags=(-Zbuild-std=std,panic_abort)
    export RUSTC="$rustc" RUSTC_BOOTSTRAP=1
    CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER="$(env -u RUSTC rustc --print sysroot)/lib/rustlib/$(
        rustc -vV | sed -n 's/^host: //p')/bin/rust-lld"
    export CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER
fi

# make NAME FLAGS...: the module dist/NAME
make() {
    local name=$1
    shift
    "$cargo" build ${flags[@]+"${flags[@]}"} -p lwc-wasm --target $target --profile dist --locked "$@"
    npx --no-install wasm-opt -O3 --converge --enable-simd --enable-bulk-memory --enable-nontrapping-float-to-int \
        --enable-sign-ext --enable-mutable-globals --strip-debug --strip-producers \
        "$CARGO_TARGET_DIR/$target/dist/lwc_wasm.wasm" -o "dist/$name"
    printf '%s: %s bytes, %s gzip\n' "$name" "$(stat -c %s "dist/$name")" "$(gzip -9c "dist/$name" | wc -c)"
}

mkdir -p dist
make lwc.wasm
# With attributes and scenes, for pages that ask for them.
make lwc-assets.wasm --features assets
