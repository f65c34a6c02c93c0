#!/usr/bin/env bash
# Measures the loss when a texture is decoded and encoded several times: PSNR in dB against the
# original, and bytes.
#   tools/lab/scripts/generations.sh [GENERATIONS]     default 3; ten generations take five minutes on two cores
source "$(dirname "${BASH_SOURCE[0]}")/../../common.sh"
build build tessera
tessera=$PWD/build/bin/tessera
generations=${1:-3}
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
cd "$folder"

LC_ALL=C awk 'BEGIN { srand(1); for (i = 0; i < 196608; ++i) printf "%c", int(256 * rand()) }' > noise.rgb
"$tessera" bake composed --size 32x16x16x16 --spp 4 -o composed.rgb -q
"$tessera" bake lamps --size 32x16x16x16 --spp 4 -o lamps.exr -q

# row NAME ORIGINAL SIZE QUALITY [--reuse]: prints the result of each generation. Each encodes the
# decoded texture of the generation before it.
row() {
    local original=$2 size=() options=(--quality "$4") before=$2
    [[ -n $3 ]] && size=(--size "$3")
    printf '%s:' "$1${5:+ $5}"
    for ((i = 1; i <= generations; ++i)); do
        if ((i > 1)); then
            "$tessera" decode $((i - 1)).tess -o "again.${original##*.}" -q
            before=again.${original##*.}
            [[ -n ${5:-} ]] && options=(--reuse $((i - 1)).tess)
        fi
        "$tessera" encode "$before" "${size[@]}" "${options[@]}" -o $i.tess -q
        printf ' %.2f (%d)' "$("$tessera" compare "$original" $i.tess "${size[@]}" --no-ssim --json |
            sed -n 's/^  "psnr": \([0-9.]*\).*/\1/p')" "$(stat -c %s $i.tess)"
    done
    echo
}
for reuse in '' --reuse; do
    row "noise, quality 75" noise.rgb 16x16x16x16 75 $reuse
    row "composed, quality 60" composed.rgb 32x16x16x16 60 $reuse
    row "composed, quality 75" composed.rgb 32x16x16x16 75 $reuse
    row "lamps, quality 75" lamps.exr "" 75 $reuse
done
