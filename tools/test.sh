#!/usr/bin/env bash
# Installs what is missing, builds everything and runs the tests.
#   tools/test.sh                     all of them
#   tools/test.sh --fast              all but the slow ones: while you work
#   tools/test.sh --sanitize KIND     under a sanitizer: address, undefined, thread or
#                                     address,undefined; thread runs the tests that have threads
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    sed -n '3,6s/^# *//p' "${BASH_SOURCE[0]}" >&2
    stop "$1"
}

which=() # tests
kind=""
case "${1:-}" in
"") ;;
--fast) which=(--label-exclude slow) ;;
--sanitize)
    kind=${2:-}
    case "$kind" in
    address | undefined | address,undefined | undefined,address) ;;
    thread) which=(--label-regex threads) ;;
    *) usage "--sanitize wants address, undefined, thread or address,undefined, not '$kind'" ;;
    esac
    ;;
*) usage "unknown option '$1'" ;;
esac

# A browser is large: where it cannot be had, its test says that it is left out.
install_browser() {
    command -v chromium >/dev/null && command -v node >/dev/null && return
    say "Installing Chromium and node for the viewer's test"
    apt-get install -y -qq --no-install-recommends chromium nodejs >/dev/null 2>&1 ||
        say "No Chromium could be installed: web_viewer is skipped"
}

# For the tests of the Python package.
PACKAGES="$PACKAGES python3-numpy python3-pytest python3-pil python3-zarr"
install_missing
[ -n "$kind" ] || install_browser
if [ -n "$kind" ]; then
    folder=build-${kind//,/-}
    # -O1: as much again would go into compiling as into running.
    build "$folder" -- -DTESSERA_TESTS=ON -DTESSERA_SANITIZE="$kind" -DCMAKE_CXX_FLAGS_RELEASE="-O1"
    export ASAN_OPTIONS=${ASAN_OPTIONS:-detect_stack_use_after_return=1}
    export UBSAN_OPTIONS=${UBSAN_OPTIONS:-print_stacktrace=1}
    # It waits a second at each exit, when a command that was interrupted must be gone after 0.7.
    export TSAN_OPTIONS=${TSAN_OPTIONS:-suppressions=$ROOT/tests/tsan.supp:atexit_sleep_ms=0}
    # The driver's own threads are not compiled for it, and so every use of them looks like a race.
    [ "$kind" != thread ] || export TESSERA_NO_GPU=1
    say "Testing under -fsanitize=$kind"
    ctest --test-dir "$folder" --output-on-failure -j "$(nproc)" --timeout 3000 "${which[@]}"
else
    build build -- -DTESSERA_TESTS=ON
    say "Testing"
    ctest --test-dir build --output-on-failure -j "$(nproc)" "${which[@]}"
fi
say "All tests passed"
