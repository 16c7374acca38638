#!/bin/sh
# Fills fuzz/corpus/ with seeds: the golden streams in the forms that the targets take, small mesh
# files, and those of the mesh corpus in $LWC_CORPUS if that is set.
#
#   fuzz/seed.sh && cargo +nightly fuzz run decode -- -max_total_time=60 -rss_limit_mb=2048
set -eu
cd "$(dirname "$0")"

for target in decode split_independent round_trip range_coder read_obj read_ply read_stl; do
    mkdir -p "corpus/$target"
done

for stream in ../format/golden/*.lwc; do
    name=$(basename "$stream" .lwc)
    # First byte: 0 takes the bytes as they are, 1 repairs lengths and checksums.
    { printf '\000'; cat "$stream"; } > "corpus/decode/$name-as-is"
    { printf '\001'; cat "$stream"; } > "corpus/decode/$name-reframed"
    # 2 makes up the frames: the payloads are whatever follows.
    { printf '\002\013\007\004\004\000\003\002\000\000\000\003\001\040\040\020\040'; cat "$stream"; } \
        > "corpus/decode/$name-made-up"
    { printf '\001\002\003\004\005\006\007\010\001'; cat "$stream"; } > "corpus/split_independent/$name"
    cp "$stream" "corpus/round_trip/$name"
    cp "$stream" "corpus/range_coder/$name"
done

printf 'v 0 0 0\nv 1 0 0\nvt 0 1\nv 0 1.5e0 0 # c\nv 0 0 1\nf 1 2 3\nf -1/1 -2 -3 -4\n' \
    > corpus/read_obj/quad
printf 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' \
    > corpus/read_ply/ascii
printf 'ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty double x\nproperty double y\nproperty double z\nelement face 1\nproperty list uint8 uint32 vertex_index\nend_header\n\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\003\0\0\0\0\0\0\0\0\0\0\0\0' \
    > corpus/read_ply/binary
printf 'solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n' \
    > corpus/read_stl/ascii
{ head -c 80 /dev/zero; printf '\001\0\0\0'; head -c 50 /dev/zero; } > corpus/read_stl/binary

if [ -n "${LWC_CORPUS:-}" ]; then
    cp "$LWC_CORPUS"/bad/*.obj corpus/read_obj/
    cp "$LWC_CORPUS"/bad/*.ply corpus/read_ply/
fi
chmod -R u+w corpus
