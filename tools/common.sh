# Shared by demo.sh and test.sh: what Debian packages are needed, installing, building.
# Source it; it sets ROOT and moves there.
set -euo pipefail
ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$ROOT"

PACKAGES="g++ cmake ninja-build pkg-config libglm-dev libzstd-dev libdraco-dev libcli11-dev nlohmann-json3-dev
libpng-dev libjpeg62-turbo-dev libwebp-dev libtiff-dev libopenexr-dev libembree-dev libtinygltf-dev libmeshoptimizer-dev libstb-dev libgtest-dev libepoxy-dev
libegl-dev libegl1 libgl1-mesa-dri glslang-tools libcurl4-openssl-dev libcpp-httplib-dev ca-certificates
clang-format python3 nodejs clang-19 lld-19 libc++-19-dev-wasm32 libc++abi-19-dev-wasm32 libclang-rt-19-dev-wasm32
wasi-libc zopfli"

say() { printf '\n== %s\n' "$*"; }
stop() {
    printf 'error: %s\n' "$*" >&2
    exit 1
}

install_missing() {
    command -v dpkg-query >/dev/null || stop "this script installs Debian packages; on another system install the like of: $PACKAGES"
    local missing=""
    for package in $PACKAGES; do
        dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q "ok installed" || missing="$missing $package"
    done
    if [ -z "$missing" ]; then
        say "All needed packages are installed"
        return
    fi
    say "Installing:$missing"
    [ "$(id -u)" = 0 ] || stop "installing needs root; run as root, or first: apt-get install$missing"
    export DEBIAN_FRONTEND=noninteractive
    apt-get update -qq || stop "apt-get update failed (no network?)"
    # shellcheck disable=SC2086
    apt-get install -y -qq --no-install-recommends $missing >/dev/null || stop "could not install:$missing"
}

# build FOLDER TARGETS... -- CMAKE-ARGUMENTS...
build() {
    local folder=$1
    shift
    local targets=()
    while [ $# -gt 0 ] && [ "$1" != "--" ]; do
        targets+=("$1")
        shift
    done
    [ $# -gt 0 ] && shift
    say "Building in $folder (Release)"
    # Compiling many files as one source takes a third of the time, because headers are read once.
    cmake -S . -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_UNITY_BUILD=ON \
        -DCMAKE_UNITY_BUILD_BATCH_SIZE=24 "$@" >"$folder.log" 2>&1 ||
        { cat "$folder.log" >&2; stop "CMake failed"; }
    ninja -C "$folder" -j "$(nproc)" "${targets[@]}" | tail -n 3 || stop "the build failed"
}

# Sets T to the tool that TESSERA names; builds it where that is not set.
find_tool() {
    T=${TESSERA:-}
    [ -z "$T" ] || return 0
    install_missing
    build build tessera -- -DTESSERA_TESTS=OFF
    T=build/bin/tessera
}
