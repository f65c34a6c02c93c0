#!/usr/bin/env bash
# Compares the speed of two builds, which run alternately on one thread. Prints a table of user seconds
# (the best of RUNS runs), bytes and MB/s.
#   tools/lab/scripts/speed.sh OLD NEW [EFFORT_OF_OLD:EFFORT_OF_NEW]...     OLD and NEW are build folders; default 3:3
# Environment variables and their defaults: QUALITY=50 SIZE=64x32x16x16 SCENES="composed gallery
# mirror" RUNS=3
set -euo pipefail
old=$1/bin/tessera new=$2/bin/tessera
shift 2
[ $# -gt 0 ] || set -- 3:3
size=${SIZE:-64x32x16x16} work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
TIMEFORMAT=%U
faster() { awk -v a="$1" -v b="$2" 'BEGIN { print (a == "" || b + 0 < a + 0) ? b : a }'; }
seconds() { { time "$@" > /dev/null; } 2>&1; }
speed() { awk -v bytes="$1" -v s="$2" 'BEGIN { if (s > 0) printf "%.2f", bytes / s / 1e6; else printf "-" }'; }
echo "| scene | efforts | old s | bytes | MB/s | new s | bytes | MB/s | decoding old, new s |"
echo "|---|---|---|---|---|---|---|---|---|"
for scene in ${SCENES:-composed gallery mirror}; do
    raw=$work/$scene.rgb
    "$new" bake "$scene" --size "$size" --spp 4 -o "$raw" -q
    texels=$(stat -c %s "$raw")
    for pair in "$@"; do
        a='' b='' c='' d=''
        for ((run = 0; run < ${RUNS:-3}; ++run)); do
            options=(--size "$size" --quality "${QUALITY:-50}" --threads 1 -q)
            a=$(faster "$a" "$(seconds "$old" encode "$raw" "${options[@]}" --effort "${pair%:*}" -o "$work/a.tess")")
            b=$(faster "$b" "$(seconds "$new" encode "$raw" "${options[@]}" --effort "${pair#*:}" -o "$work/b.tess")")
            c=$(faster "$c" "$(seconds "$old" decode "$work/a.tess" -o "$work/a.rgb" --threads 1 -q)")
            d=$(faster "$d" "$(seconds "$new" decode "$work/b.tess" -o "$work/b.rgb" --threads 1 -q)")
        done
        echo "| $scene | $pair | $a | $(stat -c %s "$work/a.tess") | $(speed "$texels" "$a") | $b |" \
            "$(stat -c %s "$work/b.tess") | $(speed "$texels" "$b") | $c, $d |"
    done
done
