#!/bin/bash
# Builds the libraries that Tessera uses from Debian's source packages, for another system or another
# C++ library. What is built already is kept.
#   tests/cross/dependencies.sh windows|libc++ FOLDER NAME...
# FOLDER/source gets the sources, FOLDER/prefix headers and static libraries. NAME: zstd draco gtest headers.
# Needs the packages dpkg-dev, cmake, ninja-build, libglm-dev, libgtest-dev and the compiler.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
system=${1:?windows or libc++} folder=$(mkdir -p "${2:?FOLDER}" && cd "$2" && pwd)
shift 2
prefix=$folder/prefix
mkdir -p "$folder"/{source,build,apt/lists/partial,apt/cache/archives/partial} "$prefix"/{include,lib/pkgconfig}
case $system in
windows)
    target=(-DCMAKE_TOOLCHAIN_FILE="$here/windows.cmake" -DTESSERA_CROSS_PREFIX="$prefix") ;;
libc++)
    target=(-DCMAKE_C_COMPILER=clang-19 -DCMAKE_CXX_COMPILER=clang++-19 -DCMAKE_CXX_FLAGS=-stdlib=libc++
            -DCMAKE_PREFIX_PATH="$prefix") ;;
*) echo "unknown system '$system'" >&2; exit 2 ;;
esac
common=(-G Ninja -Wno-dev -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$prefix" -DCMAKE_INSTALL_LIBDIR=lib
        -DBUILD_SHARED_LIBS=OFF -DBUILD_TESTING=OFF -DCMAKE_POSITION_INDEPENDENT_CODE=ON)
! command -v ccache > /dev/null || common+=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)

# fetch PACKAGE: sets `source` to its unpacked source with Debian's patches. Leaves apt's own settings alone.
fetch() {
    if [ ! -e "$folder/source/$1.fetched" ]; then
        local list="$folder/apt/sources.list"
        echo "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg]" \
             "http://deb.debian.org/debian bookworm main" > "$list"
        local apt=(apt-get -qq -o Dir::Etc::SourceList="$list" -o Dir::Etc::SourceParts=/dev/null
                   -o Dir::State::Lists="$folder/apt/lists" -o Dir::Cache="$folder/apt/cache")
        [ -n "$(find "$folder/apt/lists" -name '*_Sources*')" ] || "${apt[@]}" update
        (cd "$folder/source" && "${apt[@]}" source "$1" > "$1.log" 2>&1) || { cat "$folder/source/$1.log"; exit 1; }
        touch "$folder/source/$1.fetched"
    fi
    source=$(find "$folder/source" -maxdepth 1 -type d -name "$1-*" | head -n 1)
}

# build NAME TARGET SOURCE OPTION...: runs CMake and ninja.
build() {
    local name=$1 goal=$2 from=$3
    shift 3
    cmake -S "$from" -B "$folder/build/$name" "${common[@]}" "${target[@]}" "$@" > "$folder/build/$name.log" 2>&1 &&
        ninja -C "$folder/build/$name" -j "${JOBS:-$(nproc)}" "$goal" >> "$folder/build/$name.log" 2>&1 ||
        { tail -n 30 "$folder/build/$name.log"; exit 1; }
}

package_file() { # NAME LIBRARIES REQUIRES
    printf 'Name: %s\nDescription: built by tests/cross/dependencies.sh\nVersion: 0\nRequires.private: %s\n' "$1" "$3" \
        > "$prefix/lib/pkgconfig/$1.pc"
    printf 'Cflags: -I%s/include\nLibs: -L%s/lib %s\n' "$prefix" "$prefix" "$2" >> "$prefix/lib/pkgconfig/$1.pc"
}

make_zstd() {
    fetch libzstd
    build zstd install "$source/build/cmake" -DZSTD_BUILD_PROGRAMS=OFF -DZSTD_BUILD_SHARED=OFF \
        -DZSTD_MULTITHREAD_SUPPORT=OFF -DZSTD_LEGACY_SUPPORT=OFF
    package_file libzstd -lzstd ""
}
make_draco() { # without its programs
    fetch draco
    build draco draco_static "$source" -DDRACO_TESTS=OFF -DCMAKE_UNITY_BUILD=ON -DCMAKE_CXX_FLAGS_RELEASE="-O1 -DNDEBUG"
    (cd "$source/src" && find draco -name '*.h' -exec cp --parents {} "$prefix/include" \;)
    cp "$folder/build/draco/draco/draco_features.h" "$prefix/include/draco/"
    cp "$folder/build/draco/libdraco.a" "$prefix/lib/"
    package_file draco -ldraco ""
}
make_gtest() { # of the package libgtest-dev
    build gtest install /usr/src/googletest -DBUILD_GMOCK=OFF
}
make_headers() { # libraries that are only headers
    cp -r /usr/include/glm "$prefix/include/"
    mkdir -p "$prefix/lib/cmake/glm"
    printf 'add_library(glm::glm INTERFACE IMPORTED)\ntarget_include_directories(glm::glm INTERFACE %s)\n' \
        "$prefix/include" > "$prefix/lib/cmake/glm/glm-config.cmake"
}

for name in "$@"; do
    [ -e "$prefix/$name.done" ] || { "make_$name" && touch "$prefix/$name.done"; }
done
