# What the scripts of this folder share; to be sourced.
# shellcheck shell=bash

step() { printf '\n== %s\n' "$*"; }

fail() {
    printf '%s: %s\n' "$0" "$*" >&2
    exit 1
}

# fetch SECONDS WHAT COMMAND…: runs what needs the network, at most so long, and says what failed.
fetch() {
    local seconds=$1 what=$2
    shift 2
    timeout --kill-after=10 "$seconds" "$@" || fail "$what cannot be had: \`$*\` ended with $?"
}

has_target() { [ -e "$(rustc --print target-libdir --target "$1")" ]; }

# add_target TARGET: its standard library from rustup; quietly none where rustup has no network, Debian may.
add_target() {
    if ! has_target "$1" && command -v rustup >/dev/null; then
        timeout --kill-after=10 180 rustup target add "$1" || true
    fi
}

# install_packages NAME…: those of Debian that are missing.
install_packages() {
    local package missing=()
    for package in "$@"; do
        dpkg -s "$package" >/dev/null 2>&1 || missing+=("$package")
    done
    [ ${#missing[@]} -gt 0 ] || return 0
    command -v apt-get >/dev/null || fail "please install ${missing[*]}: there is no apt-get"
    [ "$(id -u)" = 0 ] || fail "please install ${missing[*]}: only root may"
    export DEBIAN_FRONTEND=noninteractive
    local apt=(apt-get -q -o Acquire::Retries=2 -o Acquire::http::Timeout=30 -o Acquire::https::Timeout=30
        -o DPkg::Lock::Timeout=300)
    fetch 300 "the list of Debian packages" "${apt[@]}" update
    fetch 900 "${missing[*]}" "${apt[@]}" install -y --no-install-recommends "${missing[@]}"
}
