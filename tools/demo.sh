#!/usr/bin/env bash
# The main job, end to end: bakes the paper's composed scene straight into a compressed file, decodes
# it, compares it with the texture itself, and draws what an observer sees of both and of the scene
# itself: the compressed file on the GPU, decoded there as the views ask for it. Output: demo_output/.
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

# The views on the GPU (Mesa's software one will do), or on the CPU where OpenGL 4.5 is missing.
views() {
    $T render "$OUT/composed.tess" -o "$OUT/view.png" --views paper --truth composed \
        --original "$OUT/original.rgb" --sheet "$OUT/views.png" --size 480x360 --via "$1"
}
say "Drawing the paper's five views: truth, uncompressed, compressed, difference"
code=0
views feedback || code=$?
if [ $code = 5 ]; then
    say "No GPU that could do it: drawing on the CPU"
    views cpu
elif [ $code != 0 ]; then
    stop "the views could not be drawn"
fi

say "Done. Look at $ROOT/$OUT/views.png (what an observer sees) and $ROOT/$OUT/sheet.png (the texture)"
ls -l "$OUT"
