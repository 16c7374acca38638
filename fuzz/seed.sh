#!/bin/sh
# Fills fuzz/corpus/ with seeds: the golden streams in the forms that the targets take, small mesh
# files, and those of the mesh corpus in $LWC_CORPUS if that is set.
#
#   fuzz/seed.sh && cargo +nightly fuzz run decode -- -max_total_time=60 -rss_limit_mb=2048
set -eu
cd "$(dirname "$0")"

for target in decode rearrange split_independent round_trip range_coder ans read_obj read_ply read_stl read_gltf read_las; do
    mkdir -p "corpus/$target"
done

for stream in ../format/golden/*.lwc ../format/golden/fast/*.lwc; do
    name=$(basename "$(dirname "$stream")")-$(basename "$stream" .lwc)
    # First byte: 0 takes the bytes as they are, 1 repairs lengths and checksums.
    { printf '\000'; cat "$stream"; } > "corpus/decode/$name-as-is"
    { printf '\001'; cat "$stream"; } > "corpus/decode/$name-reframed"
    # 2 makes up the frames: the payloads are whatever follows.
    { printf '\002\013\007\000\004\004\000\003\002\000\000\000\003\001\040\040\020\040'; cat "$stream"; } \
        > "corpus/decode/$name-made-up"
    { printf '\002\013\007\001\004\004\000\003\002\000\000\000\003\001\040\040\020\040'; cat "$stream"; } \
        > "corpus/decode/$name-made-up-fast"
    { printf '\001\002\003\004\005\006\007\010\001'; cat "$stream"; } > "corpus/split_independent/$name"
    # No change; a chunk moved, one doubled, one left out.
    { printf '\000'; cat "$stream"; } > "corpus/rearrange/$name-as-is"
    { printf '\003\000\005\003\001\004\006\002\007\000'; cat "$stream"; } > "corpus/rearrange/$name-changed"
    cp "$stream" "corpus/round_trip/$name"
    cp "$stream" "corpus/range_coder/$name"
    # Bytes as symbols, as tables, and as a base mesh.
    { printf '\000'; cat "$stream"; } > "corpus/ans/$name-symbols"
    { printf '\144'; cat "$stream"; } > "corpus/ans/$name-tables"
    { printf '\310\100\100'; cat "$stream"; } > "corpus/ans/$name-base"
done

printf 'v 0 0 0\nv 1 0 0\nvt 0 1\nv 0 1.5e0 0 # c\nv 0 0 1\nf 1 2 3\nf -1/1 -2 -3 -4\n' \
    > corpus/read_obj/quad
printf 'mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nvt 0 0\nvt 1 1 0\nvn 0 0 1\no a\ng b c\ns off\nusemtl d\nf 1/1/1 2/2/-1 3//1\nusemtl e\nf 3/-1 2/1 1\n' \
    > corpus/read_obj/rich
printf 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' \
    > corpus/read_ply/ascii
printf 'ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty double x\nproperty double y\nproperty double z\nelement face 1\nproperty list uint8 uint32 vertex_index\nend_header\n\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\003\0\0\0\0\0\0\0\0\0\0\0\0' \
    > corpus/read_ply/binary
printf 'solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n' \
    > corpus/read_stl/ascii
{ head -c 80 /dev/zero; printf '\001\0\0\0'; head -c 50 /dev/zero; } > corpus/read_stl/binary

printf 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty short q\nelement face 1\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nproperty int texnumber\nend_header\n0 0 0 0 0 1 1 2 3 -4\n1 0 0 0 0 1 1 2 3 -4\n0 1 0 0 0 1 1 2 3 -4\n3 0 1 2 6 0 0 1 0 1 1 7\n' \
    > corpus/read_ply/rich

printf '{"asset":{"version":"2.0"},"buffers":[{"byteLength":45,"uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAECAQIAAQIC"}],"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":9}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},{"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"},{"bufferView":1,"componentType":5121,"count":3,"type":"VEC3","normalized":true},{"componentType":5126,"count":3,"type":"VEC2","sparse":{"count":1,"indices":{"bufferView":1,"byteOffset":1,"componentType":5121},"values":{"bufferView":0,"byteOffset":8}}}],"materials":[{"name":"m"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"COLOR_0":2,"TEXCOORD_0":3},"indices":1,"material":0},{"attributes":{"POSITION":0},"indices":1,"mode":5},{"attributes":{"POSITION":2},"mode":6}]}],"nodes":[{"mesh":0,"scale":[2,1,-1]},{"name":"n","mesh":0,"children":[0]}],"scenes":[{"nodes":[1]}]}' \
    > corpus/read_gltf/text
cp ../tests/data/seam.glb corpus/read_gltf/seam
for cloud in ../tests/data/*.la[sz]; do
    # First byte: options.
    for choice in '\000' '\003' '\005'; do
        { printf "$choice"; cat "$cloud"; } > "corpus/read_las/$(basename "$cloud")-$(printf "$choice" | od -An -to1 | tr -d ' ')"
    done
done

# Streams and files that went wrong once.
if [ -n "${LWC_CASES:-}" ]; then
    for stream in "$LWC_CASES"/attack/*.lwc; do
        { printf '\000'; cat "$stream"; } > "corpus/decode/case-$(basename "$stream")"
        { printf '\000'; cat "$stream"; } > "corpus/rearrange/case-$(basename "$stream")"
    done
    cp "$LWC_CASES"/*.obj corpus/read_obj/
    cp "$LWC_CASES"/*.ply corpus/read_ply/
    cp "$LWC_CASES"/*.stl corpus/read_stl/
    cp "$LWC_CASES"/*.glb corpus/read_gltf/
    for cloud in "$LWC_CASES"/*.las; do
        { printf '\000'; cat "$cloud"; } > "corpus/read_las/case-$(basename "$cloud")"
    done
fi
if [ -n "${LWC_CORPUS:-}" ]; then
    cp "$LWC_CORPUS"/bad/*.obj corpus/read_obj/
    cp "$LWC_CORPUS"/bad/*.ply corpus/read_ply/
fi
chmod -R u+w corpus
