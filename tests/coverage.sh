#!/bin/bash
# Prints per folder how many lines of format/ and codec/ their tests reach, as counted by clang:
#   tests/coverage.sh [TEST_FILTER]     builds in build-coverage; needs clang, llvm and jq
# CLANG_VERSION is the suffix of the programs' names, by default -19. Version 14 cannot compile the
# tests. Afterwards this shows the lines of one file, with a 0 beside those that no test reaches:
#   cd build-coverage && llvm-cov-19 show bin/format_tests -object bin/codec_tests \
#       -instr-profile=all.profdata ../format/container/index.cpp
set -euo pipefail
cd "$(dirname "$0")/.."
folder=build-coverage
v=${CLANG_VERSION--19}
cmake -S . -B "$folder" -G Ninja -DCMAKE_UNITY_BUILD=ON -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O1 \
    -DCMAKE_C_COMPILER=clang$v -DCMAKE_CXX_COMPILER=clang++$v \
    -DCMAKE_CXX_FLAGS="-fprofile-instr-generate -fcoverage-mapping" -DTESSERA_TESTS=ON \
    -DTESSERA_GPU=OFF -DTESSERA_SHARED=OFF -DTESSERA_HTTP=OFF -DTESSERA_WEB=OFF > /dev/null
ninja -C "$folder" format_tests codec_tests c_api_test
for tests in format_tests codec_tests; do
    LLVM_PROFILE_FILE=$folder/$tests.profraw "$folder/bin/$tests" --gtest_brief=1 --gtest_filter="${1:-*}"
done
LLVM_PROFILE_FILE=$folder/c_api_tests.profraw "$folder/bin/c_api_test" "$folder/c_api.tess"
llvm-profdata$v merge "$folder"/*_tests.profraw -o "$folder/all.profdata"
llvm-cov$v export --summary-only "$folder/bin/format_tests" -object "$folder/bin/codec_tests" \
    -object "$folder/bin/c_api_test" -instr-profile="$folder/all.profdata" format codec > "$folder/summary.json"
jq -r '.data[0].files[] | [.filename, .summary.lines.count, .summary.lines.covered] | @tsv' "$folder/summary.json" |
    sed "s|^$PWD/||; s|/[^/\t]*\t|\t|" |
    awk -F'\t' '{ n[$1] += $2; hit[$1] += $3; n["all"] += $2; hit["all"] += $3 }
                END { for (f in n) printf "%-24s %6d lines  %5.1f %%\n", f, n[f], 100 * hit[f] / n[f] }' | sort
