#!/usr/bin/env bash
# Bakes textures up to the paper's largest, 1024x512x128x128 (8.6 billion texels, 25.8 GB raw),
# directly into files. Measures bytes, time, peak memory, and the PSNR of a random 1 % of the tiles,
# which it bakes again. Then validates the largest texture, decodes it to a folder, compares it with
# the folder, encodes it again from the folder, and reads it over HTTP. Output:
# demo_output/full_size/tables.md. tests/regression/full_size.md discusses the results.
#   tools/lab/scripts/full_size.sh           takes 45 minutes on 2 cores and up to 30 GB of temporary disk space
#   tools/lab/scripts/full_size.sh --quick   stops at 512x256x64x64: a few minutes
#   TESSERA=build/bin/tessera tools/lab/scripts/full_size.sh      uses an existing program
source "$(dirname "${BASH_SOURCE[0]}")/../../common.sh"
[ -x /usr/bin/time ] || apt-get install -y -qq time >/dev/null || stop "GNU time is needed (apt-get install time)"

find_tool
OUT=demo_output/full_size
rm -rf "$OUT"
mkdir -p "$OUT"
TABLES=$OUT/tables.md
SIZES="128x64x32x32 256x128x32x32 256x128x64x64 512x256x64x64 1024x512x64x64 1024x512x128x128"
TEXEL=880:881,192:193,66:67,71:72 # shows an object
if [ "${1:-}" = --quick ]; then
    SIZES="128x64x32x32 256x128x32x32 256x128x64x64 512x256x64x64"
    TEXEL=440:441,96:97,33:34,35:36
fi

# timed COMMAND...: runs the command without output and prints "SECONDS PEAK_KB".
timed() {
    /usr/bin/time -f "%e %M" -o "$OUT/time" "$@" >"$OUT/last.txt"
    cat "$OUT/time"
}

say "Baking with one ray per texel, effort 1, quality 62 and coarse levels"
{
    echo "| texture | texels | bytes | bits per texel | PSNR, 1 % of tiles baked again | seconds | ns per texel | peak memory |"
    echo "|---|---|---|---|---|---|---|---|"
} >"$TABLES"
for size in $SIZES; do
    file=$OUT/$size.tess
    read -r seconds peak <<<"$(timed "$T" bake composed -o "$file" --size "$size" --spp 1 --effort 1 --quality 62 --layers)"
    psnr=$("$T" compare "$file" --bake composed --sample 0.01 | awk '$1 == "PSNR" { print $2 == "no" ? "exact" : $2 " dB" }')
    awk -v size="$size" -v bytes="$(stat -c %s "$file")" -v psnr="$psnr" -v s="$seconds" -v kb="$peak" 'BEGIN {
        split(size, n, "x"); texels = n[1] * n[2] * n[3] * n[4]
        printf "| %s | %.1f M | %d | %.4f | %s | %.1f | %.1f | %.0f MiB |\n", size, texels / 1e6, bytes,
            8 * bytes / texels, psnr, s, 1e9 * s / texels, kb / 1024 }' | tee -a "$TABLES"
done

LARGEST=$OUT/${SIZES##* }.tess
say "Using the largest texture with the default memory limit of 1 GiB"
{
    echo
    echo "| verb | seconds | peak memory |"
    echo "|---|---|---|"
} >>"$TABLES"
verb() { # NAME COMMAND...
    local name=$1
    shift
    read -r seconds peak <<<"$(timed "$@")"
    printf '| %s | %.0f | %d MiB |\n' "$name" "$seconds" $((peak / 1024)) | tee -a "$TABLES"
}
verb "validate" "$T" validate "$LARGEST"
verb "decode to a folder of PNG" "$T" decode "$LARGEST" -o "$OUT/views/" -q
verb "compare with the folder" "$T" compare "$LARGEST" "$OUT/views/" --no-ssim -q --max-error 0
verb "encode from the folder, effort 0" "$T" encode "$OUT/views/" -o "$OUT/again.tess" --effort 0 --quality 62 -q
rm -rf "$OUT/views" "$OUT/again.tess"

say "Reading one of its texels over HTTP, without a cache"
"$T" serve "$OUT" --port 8641 >"$OUT/serve.log" &
trap 'kill %1 2>/dev/null || true' EXIT
sleep 1
"$T" decode "http://127.0.0.1:8641/$(basename "$LARGEST")" --box "$TEXEL" -o "$OUT/texel.rgb" | tee -a "$TABLES"
kill %1
say "The tables are in $TABLES"
