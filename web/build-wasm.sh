#!/usr/bin/env bash
# Builds the decoder for WebAssembly into web/dist/lwc.wasm. With rustup:
#   rustup target add wasm32-unknown-unknown
# Where that target cannot be downloaded, Debian's rustc-web, cargo-web and rust-web-src build its
# standard library from source.
set -euo pipefail
cd "$(dirname "$0")"
target=wasm32-unknown-unknown
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/../target}/wasm"
export CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS="-C target-feature=+simd128 -C panic=abort"

if [ -e "$(rustc --print target-libdir --target $target)" ]; then
    cargo build -p lwc-wasm --target $target --release --locked
else
    rustc=$(dpkg -L rustc-web | grep -m1 '/bin/rustc$')
    cargo=$(dpkg -L cargo-web | grep -m1 '/bin/cargo$')
    export RUSTC="$rustc" RUSTC_BOOTSTRAP=1
    CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER="$(env -u RUSTC rustc --print sysroot)/lib/rustlib/$(
        rustc -vV | sed -n 's/^host: //p')/bin/rust-lld"
    export CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER
    "$cargo" build -Zbuild-std=std,panic_abort -p lwc-wasm --target $target --release --locked
fi

mkdir -p dist
npx --no-install wasm-opt -O3 --enable-simd --enable-bulk-memory --enable-nontrapping-float-to-int \
    --enable-sign-ext --enable-mutable-globals --strip-debug --strip-producers \
    "$CARGO_TARGET_DIR/$target/release/lwc_wasm.wasm" -o dist/lwc.wasm
printf 'lwc.wasm: %s bytes, %s gzip\n' "$(stat -c %s dist/lwc.wasm)" "$(gzip -9c dist/lwc.wasm | wc -c)"
