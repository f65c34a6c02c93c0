#!/usr/bin/env bash
# The main job, end to end: bakes the paper's composed scene straight into a compressed file, decodes
# it, compares it with the texture itself, and draws both. Output: demo_output/.
#   tools/demo.sh [UxVxSxT]      default 256x128x16x16
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
SIZE=${1:-256x128x16x16}

install_missing
build build tessera -- -DTESSERA_TESTS=OFF
T=build/bin/tessera
OUT=demo_output
mkdir -p "$OUT"

say "Baking the composed scene, $SIZE at 16 samples a texel, straight into a compressed file"
$T bake composed -o "$OUT/composed.tess" --size "$SIZE" --spp 16 --target-psnr 40

say "The same texture uncompressed, to compare with"
$T bake composed -o "$OUT/original.rgb" --size "$SIZE" --spp 16

say "Decoding the compressed file"
$T decode "$OUT/composed.tess" -o "$OUT/decoded.rgb"

say "Original against decoded"
$T compare "$OUT/original.rgb" "$OUT/composed.tess" --size "$SIZE"

say "What the file holds"
$T info "$OUT/composed.tess"

say "Drawing views and angular images: original, decoded, difference"
$T sheet "$OUT/original.rgb" "$OUT/composed.tess" --size "$SIZE" -o "$OUT/sheet.png"

say "Done. Look at $ROOT/$OUT/sheet.png"
ls -l "$OUT"
