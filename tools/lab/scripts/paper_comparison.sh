#!/usr/bin/env bash
# Repeats the paper's comparison. Renders the composed scene from the paper's five views with
# textures of several sizes, uncompressed and compressed at 40 dB, and compares the views with
# direct ray tracing. Then does the same for the aliasing scenes, the poles and the waves.
# Uncompressed textures are baked only where a view needs them, so that large ones fit. Output:
# demo_output/paper_comparison/tables.md, and in corpus/ the two pictures of paper_comparison.md,
# which discusses the results.
#   tools/lab/scripts/paper_comparison.sh      takes 13 minutes on 2 shared cores and 403 MB of temporary disk space
#   TESSERA=build/bin/tessera tools/lab/scripts/paper_comparison.sh      uses an existing program
source "$(dirname "${BASH_SOURCE[0]}")/../../common.sh"

find_tool
OUT=demo_output/paper_comparison
rm -rf "$OUT"
mkdir -p "$OUT"
TABLES=$OUT/tables.md
RAYS=16 # per texel and per pixel

# row NAME FIELDS FILE [mean]: prints a row of a table from the output of `tessera render`: the
# given fields of each view and, with `mean`, their means.
row() {
    awk -v name="$1" -v fields="$2" -v with_mean="${4:-}" '
        BEGIN { count = split(fields, field, " ") }
        NF >= 3 && $2 ~ /^[0-9.]+$/ && $3 ~ /^[0-9.]+$/ {
            cell = ""
            for (i = 1; i <= count; ++i) {
                cell = cell (i > 1 ? "/" : "") $field[i]
                sum[i] += $field[i]
            }
            cells = cells " " cell " |"
            ++views
        }
        END {
            mean = ""
            for (i = 1; i <= count; ++i)
                mean = mean (i > 1 ? "/" : "") sprintf(i == 1 ? "%.2f" : "%.4f", sum[i] / views)
            print "| " name " |" cells (with_mean ? " " mean " |" : "")
        }' "$3"
}

# uncompressed SCENE SIZE NAME ARGUMENTS...: renders views of a texture that is never stored. Writes
# NAME.png, or NAME-1.png and so on for several views, and their figures to NAME.txt.
uncompressed() {
    local scene=$1 size=$2 name=$3
    shift 3
    $T render --scene "$scene" --size "$size" --spp "$RAYS" --truth "$scene" \
        --truth-spp "$RAYS" -o "$OUT/$name.png" "$@" >"$OUT/$name.txt"
}

VIEWS="| 10,0,0 | 10,0,-3 | 10,0,3 | 0,0,10 | 0,10,0 | mean |
|---|---|---|---|---|---|---|"

{
    echo "### Uncompressed against truth: PSNR in dB / SSIM"
    echo
    echo "| texture $VIEWS"
} >"$TABLES"
for size in 1024x512x128x128 512x256x64x64 512x256x32x32 256x128x64x64 128x64x128x128 64x32x256x256; do
    say "Uncompressed $size"
    uncompressed composed $size $size --views paper
    row $size "2 3" "$OUT/$size.txt" mean | tee -a "$TABLES"
done

{
    echo
    echo "### Compressed at 40 dB, against truth and against uncompressed: PSNR in dB"
    echo
    echo "| texture $VIEWS"
} >>"$TABLES"
for size in 512x256x32x32 256x128x64x64 128x64x128x128 64x32x256x256; do
    say "Compressed $size"
    $T bake composed --size $size --spp $RAYS -q -o "$OUT/raw.rgb"
    $T encode "$OUT/raw.rgb" --size $size --target-psnr 40 --proxy sphere:0,0,0,3.5 \
        --surface-map sphere-longitude-latitude --angular-map hemisphere-alpha-beta \
        -o "$OUT/$size.tess" | tee "$OUT/$size-encode.txt"
    $T render "$OUT/$size.tess" --original "$OUT/raw.rgb" --views paper --truth composed \
        --truth-spp $RAYS -o "$OUT/$size-compressed.png" >"$OUT/$size-compressed.txt"
    rm "$OUT/raw.rgb"
    bytes=$(stat -c %s "$OUT/$size.tess")
    {
        row "$size, $bytes bytes" 2 "$OUT/$size-compressed.txt" mean
        row "... uncompressed" 4 "$OUT/$size-compressed.txt" mean
        row "... compressed against uncompressed" 6 "$OUT/$size-compressed.txt" mean
    } | tee -a "$TABLES"
done

{
    echo
    echo "### The aliasing scenes from (5,0,0): PSNR in dB / SSIM"
    echo
    echo "| texture | near, (2,0,0) | far, (-5,0,0) |"
    echo "|---|---|---|"
} >>"$TABLES"
for size in 1024x512x32x32 256x128x32x32 1024x512x128x128 256x128x128x128; do
    say "Aliasing $size"
    for place in near far; do
        uncompressed aliasing-$place $size $place-$size --eye 5,0,0 --write-all
    done
    cat "$OUT/near-$size.txt" "$OUT/far-$size.txt" >"$OUT/both.txt"
    row $size "2 3" "$OUT/both.txt" | tee -a "$TABLES"
done
say "Aliasing with one ray per texel"
RAYS=1 uncompressed aliasing-far 1024x512x32x32 far-one-ray --eye 5,0,0

{
    echo
    echo "### Close to the equator and to the pole: PSNR in dB / SSIM"
    echo
    echo "| texture | from 6,0,0 | from 0,0,6 | from 0,6,0 | from 0.01,-6,0 |"
    echo "|---|---|---|---|---|"
} >>"$TABLES"
for size in 512x256x32x32 64x32x256x256; do
    say "Poles $size"
    : >"$OUT/both.txt"
    n=0
    for eye in 6,0,0 0,0,6 0,6,0 0.01,-6,0; do
        n=$((n + 1))
        uncompressed composed $size close-$n-$size --eye $eye --fov 30 --pixels 320x320 --write-all
        cat "$OUT/close-$n-$size.txt" >>"$OUT/both.txt"
    done
    row $size "2 3" "$OUT/both.txt" | tee -a "$TABLES"
done

{
    echo
    echo "### Waves: the camera moves in quarters of a texel of 64x32x256x256: PSNR in dB / SSIM"
    echo
    echo "| texture | 0 | 1/4 | 2/4 | 3/4 |"
    echo "|---|---|---|---|---|"
} >>"$TABLES"
for size in 512x256x32x32 64x32x256x256; do
    say "Waves $size"
    : >"$OUT/both.txt"
    for n in 0 1 2 3; do
        eye=$(awk "BEGIN { a = $n * 1.40625 * 3.14159265 / 180; printf \"%.5f,0,%.5f\", 10 * cos(a), -10 * sin(a) }")
        uncompressed composed $size wave-$n-$size --eye "$eye"
        cat "$OUT/wave-$n-$size.txt" >>"$OUT/both.txt"
    done
    row $size "2 3" "$OUT/both.txt" | tee -a "$TABLES"
done

say "Pictures"
pictures=()
labels=()
add() { pictures+=("$1"); labels+=(--label "$2"); }
for size in 1024x512x128x128 512x256x64x64 512x256x32x32 64x32x256x256; do
    uncompressed composed $size small-$size --views paper --pixels 256x192 --write-all
done
$T render "$OUT/512x256x32x32.tess" --views paper --pixels 256x192 -q -o "$OUT/small-compressed.png"
for n in 1 2 3 4 5; do add "$OUT/small-1024x512x128x128-$n-truth.png" "truth, view $n"; done
for size in 1024x512x128x128 512x256x64x64 512x256x32x32 compressed 64x32x256x256; do
    for n in 1 2 3 4 5; do
        add "$OUT/small-$size-$n.png" "${size/compressed/512x256x32x32 at 40 dB}"
    done
done
$T sheet "${pictures[@]}" "${labels[@]}" --columns 5 -o corpus/paper_comparison.png
pictures=()
labels=()
add "$OUT/far-1024x512x32x32-truth.png" "far: truth"
add "$OUT/far-one-ray.png" "1024x512x32x32, one ray"
add "$OUT/far-1024x512x32x32.png" "1024x512x32x32"
add "$OUT/far-256x128x128x128.png" "256x128x128x128"
add "$OUT/near-1024x512x32x32-truth.png" "near: truth"
add "$OUT/near-256x128x32x32.png" "256x128x32x32"
add "$OUT/near-1024x512x32x32.png" "1024x512x32x32"
add "$OUT/near-1024x512x128x128.png" "1024x512x128x128"
add "$OUT/close-3-512x256x32x32-truth.png" "over the pole: truth"
add "$OUT/close-3-512x256x32x32.png" "512x256x32x32"
add "$OUT/close-3-64x32x256x256.png" "64x32x256x256"
add "$OUT/close-4-512x256x32x32.png" "512x256x32x32, other pole"
for n in 0 1 2 3; do add "$OUT/wave-$n-64x32x256x256.png" "64x32x256x256, $n/4 texel on"; done
$T sheet "${pictures[@]}" "${labels[@]}" --columns 4 --middle 260 -o corpus/paper_comparison_details.png

cat "$TABLES"
say "Done. See corpus/paper_comparison.png, corpus/paper_comparison_details.png and $TABLES"
