#!/usr/bin/env bash
# Makes the tables in docs/interop.md: what other programs read of the files that lwc writes.
#
#   docs/interop/run.sh [LWC]
#
# LWC is the program to test, by default $LWC or target/release/lwc. All other programs are installed into a temporary
# folder, in the versions below: 3 GB and five minutes. What cannot be installed has a row that says so.
# Needs Python 3.11 (for Blender), Node 20, and apt on Debian 12 or similar; no root. Not part of CI.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
lwc=$(realpath "${1:-${LWC:-$here/../../target/release/lwc}}")
"$lwc" --version
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export INTEROP_WORK=$work PYTHONDONTWRITEBYTECODE=1

python_packages=(
  bpy==5.0.1 open3d-cpu==0.20.0 trimesh==5.2.0 scipy==1.17.1 networkx==3.6.1 meshio==5.3.5 vtk==9.7.2 pyvista==0.49.2
  pymeshlab==2025.7.post1
)
node_packages=(
  three@0.187.0 @gltf-transform/core@4.5.1 @gltf-transform/extensions@4.5.1 draco3dgltf@1.5.7 gltfpack@1.3.0
)
debian_packages=(cloudcompare assimp-utils draco)
debian_programs=(CloudCompare assimp draco_encoder draco_decoder draco_transcoder)

install_python() {
  "${PYTHON:-python3}" -m venv "$work/venv"
  "$work/venv/bin/pip" install --quiet --disable-pip-version-check numpy==1.26.4
  for package in "${python_packages[@]}"; do
    "$work/venv/bin/pip" install --quiet --disable-pip-version-check "$package" numpy==1.26.4 ||
      echo "not installed: $package" >&2
  done
}

install_node() {
  mkdir "$work/node"
  (cd "$work/node" && npm install --silent --no-audit --no-fund "${node_packages[@]}") || echo "not installed: npm packages" >&2
}

# Debian's packages are unpacked, not installed, so that nothing outside the folder changes.
install_debian() {
  mkdir -p "$work/deb/archives" "$work/deb/root" "$work/bin"
  touch "$work/debian-versions"
  command -v apt-get > /dev/null || return 0
  cd "$work/deb/archives"
  apt-get install --simulate --reinstall --no-install-recommends "${debian_packages[@]}" 2> /dev/null |
    sed -n 's/^Inst \([^ ]*\).*/\1/p' | xargs --no-run-if-empty apt-get --quiet=2 download 2> /dev/null || true
  for archive in *.deb; do
    [ -e "$archive" ] || break
    dpkg -x "$archive" "$work/deb/root"
    dpkg-deb --show --showformat '${Package} ${Version}\n' "$archive" >> "$work/debian-versions"
  done
  cd - > /dev/null
  for program in "${debian_programs[@]}"; do
    [ -e "$work/deb/root/usr/bin/$program" ] && wrap "$program"
  done
  return 0
}

# A program in the folder finds its libraries there, and draws to no screen.
wrap() {
  local libraries=("$work"/deb/root/usr/lib/*-linux-gnu)
  cat > "$work/bin/$1" <<EOF
#!/bin/sh
export LD_LIBRARY_PATH=$libraries:$libraries/cloudcompare QT_PLUGIN_PATH=$libraries/qt5/plugins
export QT_QPA_PLATFORM=offscreen XDG_RUNTIME_DIR=$work HOME=$work
exec $work/deb/root/usr/bin/$1 "\$@"
EOF
  chmod +x "$work/bin/$1"
}

# Lossless and in the order of the source, so that each difference is made by the reader.
write_files() {
  mkdir "$work/files"
  "$work/venv/bin/python" "$here/source.py" "$work/files/source.glb"
  "$lwc" encode "$work/files/source.glb" -o "$work/model.lwc" --lossless --keep-order
  for ending in ply obj glb stl; do
    "$lwc" decode "$work/model.lwc" -o "$work/files/model.$ending"
  done
  if "$lwc" decode --help | grep -q -- --split-seams; then
    "$lwc" decode "$work/model.lwc" --split-seams -o "$work/files/split.ply"
    "$lwc" decode "$work/model.lwc" --split-seams -o "$work/files/split.obj"
  fi
}

install_python
install_node
install_debian
write_files
PATH=$work/bin:$PATH "$work/venv/bin/python" "$here/table.py" "$work/files" "$here/../interop.md"
