#!/usr/bin/env bash
# Textures up to the paper's largest, 1024x512x128x128 (8.6 billion texels, 25.8 GB raw), baked straight
# into files: bytes, PSNR on a random 1 % of tiles that are baked again, time and peak memory. Then the
# largest is validated, decoded to a folder, compared with it, encoded again from it, and read over HTTP.
# Output: demo_output/full_size/tables.md; what was seen is in tests/regression/full_size.md.
#   tools/lab/scripts/full_size.sh           three quarters of an hour on 2 cores, up to 30 GB of disk for a while
#   tools/lab/scripts/full_size.sh --quick   up to 512x256x64x64 only: some minutes
#   TESSERA=build/bin/tessera tools/lab/scripts/full_size.sh      with a tool that is there already
source "$(dirname "${BASH_SOURCE[0]}")/../../common.sh"
[ -x /usr/bin/time ] || apt-get install -y -qq time >/dev/null || stop "GNU time is needed (apt-get install time)"

find_tool
OUT=demo_output/full_size
rm -rf "$OUT"
mkdir -p "$OUT"
TABLES=$OUT/tables.md
SIZES="128x64x32x32 256x128x32x32 256x128x64x64 512x256x64x64 1024x512x64x64 1024x512x128x128"
TEXEL=880:881,192:193,66:67,71:72 # of an object
if [ "${1:-}" = --quick ]; then
    SIZES="128x64x32x32 256x128x32x32 256x128x64x64 512x256x64x64"
    TEXEL=440:441,96:97,33:34,35:36
fi

# timed COMMAND...: runs it quietly, prints "SECONDS PEAK_KB".
timed() {
    /usr/bin/time -f "%e %M" -o "$OUT/time" "$@" >"$OUT/last.txt"
    cat "$OUT/time"
}

say "Baking, one ray a texel, effort 1, quality 62, with coarse levels"
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
say "The largest one, with the default of 1 GiB of memory"
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

say "One texel of it, cold, over HTTP"
"$T" serve "$OUT" --port 8641 >"$OUT/serve.log" &
trap 'kill %1 2>/dev/null || true' EXIT
sleep 1
"$T" decode "http://127.0.0.1:8641/$(basename "$LARGEST")" --box "$TEXEL" -o "$OUT/texel.rgb" | tee -a "$TABLES"
kill %1
say "Written: $TABLES"
