#!/usr/bin/env bash
# Installs what is missing, builds everything and runs all tests.
#   tools/test.sh                  Release
#   tools/test.sh --sanitize       with the address and undefined-behaviour sanitizers as well
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

install_missing
build build -- -DTESSERA_TESTS=ON
say "Testing"
ctest --test-dir build --output-on-failure -j "$(nproc)"

if [ "${1:-}" = "--sanitize" ]; then
    build build-sanitize -- -DTESSERA_SANITIZE=address,undefined
    say "Testing under sanitizers"
    ctest --test-dir build-sanitize --output-on-failure -j "$(nproc)" --timeout 1500
fi
say "All tests passed"
