#!/usr/bin/env bash
# Runs all fuzz targets, or those named, for MINUTES in total:
#   tests/fuzz/run.sh MINUTES [TARGET...]
# It builds them in build-fuzz with clang and the sanitizers address and undefined. Inputs that reach new
# code are kept in build-fuzz/corpus/TARGET, and crashes in build-fuzz/crashes. SAVE=1 adds new inputs to
# tests/fuzz/corpus.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
minutes=${1:?MINUTES}
shift
build=$root/build-fuzz
cmake -S "$root" -B "$build" -G Ninja -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_C_COMPILER=clang -DCMAKE_UNITY_BUILD=ON \
    -DCMAKE_CXX_FLAGS_RELEASE="-O1 -DNDEBUG" -DTESSERA_FUZZ=ON -DTESSERA_SANITIZE=address,undefined \
    -DTESSERA_TESTS=OFF -DTESSERA_SHARED=OFF -DTESSERA_GPU=OFF > /dev/null
targets=("$@")
if [ ${#targets[@]} -eq 0 ]; then
    mapfile -t targets < <(cd "$root/tests/fuzz" && ls fuzz_*.cpp | sed 's/\.cpp$//' | grep -v -e driver -e mutator)
fi
nice ninja -C "$build" "${targets[@]}"
seconds=$(awk "BEGIN { s = $minutes * 60 / ${#targets[@]}; print s < 1 ? 1 : int(s) }")
mkdir -p "$build/crashes"
failed=0
for target in "${targets[@]}"; do
    work=$build/corpus/$target
    saved=$root/tests/fuzz/corpus/$target
    mkdir -p "$work" "$saved"
    "$build/bin/$target" --write-seeds "$work"
    dictionary=$root/tests/fuzz/dictionaries/$target.dict
    log=$build/$target.log
    nice -n 19 "$build/bin/$target" "$work" "$saved" \
        -max_total_time="$seconds" -timeout=60 -rss_limit_mb=2500 -max_len=16384 \
        -print_final_stats=1 -artifact_prefix="$build/crashes/$target-" \
        ${dictionary:+$([ -e "$dictionary" ] && echo "-dict=$dictionary")} > "$log" 2>&1 || failed=1
    runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
    edges=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$log" | tail -1)
    echo "$target: ${runs:-0} runs, ${edges:-?} edges$(grep -m1 -o 'SUMMARY: .*' "$log" | sed 's/^/, /' || true)"
    if [ "${SAVE:-0}" = 1 ]; then
        # Keeps a minimal set of small inputs that reach different code. With counters it would be
        # much larger.
        nice -n 19 "$build/bin/$target" -set_cover_merge=1 -use_counters=0 -max_len=600 "$saved" "$work" \
            > /dev/null 2>&1 || true
    fi
    rmdir --ignore-fail-on-non-empty "$saved"
done
exit $failed
