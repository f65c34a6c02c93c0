#!/usr/bin/env bash
# The main job, end to end. The paper's composed scene, baked straight into compressed files: on the
# surfaces of its things, in a layer of colours and one of highlights and mirror images, and on the paper's
# sphere around them; what an observer sees of both, beside the ray traced truth. Then the sphere's texture
# is decoded, compared with the texture itself, and drawn on the GPU, decoded there as the views ask for
# it; both end as pages for a browser. Output: demo_output/.
#   tools/demo.sh [UxVxSxT]      default 256x128x16x16
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
SIZE=${1:-256x128x16x16}

install_missing
build build tessera -- -DTESSERA_TESTS=OFF
T=build/bin/tessera
OUT=demo_output
mkdir -p "$OUT"

say "Baking the composed scene in layers on the surfaces of its things"
$T bake composed -o "$OUT/surface.tess" --proxy mesh --effort 2 --quality 50

say "Baking it on the paper's sphere, $SIZE at 16 samples a texel"
$T bake composed -o "$OUT/composed.tess" --size "$SIZE" --spp 16 --target-psnr 40

say "Drawing the paper's five views of both, and the scene itself ray traced"
for kind in surface composed; do
    $T render "$OUT/$kind.tess" -o "$OUT/$kind.png" --views paper --truth composed --write-all |
        tee "$OUT/$kind.txt"
done
$T sheet "$OUT/surface-1.png" "$OUT/composed-1.png" "$OUT/surface-1-truth.png" --columns 3 \
    --label "its own surfaces, $(stat -c %s "$OUT/surface.tess") bytes" \
    --label "sphere of the paper, $(stat -c %s "$OUT/composed.tess") bytes" \
    --label "ray traced" -o "$OUT/sharp.png"
say "Bytes of the whole file, and dB against the ray traced views"
for kind in surface composed; do
    awk -v kind="$kind" -v bytes="$(stat -c %s "$OUT/$kind.tess")" \
        '$1 ~ /,/ { sum += $2; views++ } END { printf "%-10s %8d bytes  %.2f dB\n", kind, bytes, sum / views }' \
        "$OUT/$kind.txt"
done

say "The same texture uncompressed, to compare with"
$T bake composed -o "$OUT/original.rgb" --size "$SIZE" --spp 16

say "Decoding the compressed file"
$T decode "$OUT/composed.tess" -o "$OUT/decoded.rgb"

say "Original against decoded"
$T compare "$OUT/original.rgb" "$OUT/composed.tess" --size "$SIZE"

say "What the files hold"
for kind in surface composed; do
    $T info "$OUT/$kind.tess"
done

say "Drawing views and angular images: original, decoded, difference"
$T sheet "$OUT/original.rgb" "$OUT/composed.tess" --size "$SIZE" -o "$OUT/sheet.png"

# The views on the GPU (Mesa's software one will do), or on the CPU where OpenGL 4.5 is missing.
views() {
    $T render "$OUT/composed.tess" -o "$OUT/view.png" --views paper --truth composed \
        --original "$OUT/original.rgb" --sheet "$OUT/views.png" --pixels 480x360 --via "$1"
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

say "Writing both as pages that a browser opens from disk"
for kind in surface composed; do
    code=0
    $T view "$OUT/$kind.tess" -o "$OUT/$kind.html" || code=$?
    [ $code = 0 ] || [ $code = 5 ] || stop "a page could not be written" # 5: built without the viewer
done

say "Done. Look at $ROOT/$OUT/sharp.png (surfaces, sphere, truth), views.png (the sphere in detail) and
   sheet.png (its texture) beside it; open surface.html and composed.html in Chromium or Firefox: drag turns,
   the wheel comes nearer"
ls -l "$OUT"
