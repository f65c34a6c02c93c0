#!/bin/bash
# Builds the libraries that Tessera uses from Debian's source packages, for another system or another
# C++ library. What is built already is kept.
#   tests/cross/dependencies.sh windows|libc++ FOLDER NAME...
# FOLDER/source gets the sources, FOLDER/prefix headers and static libraries. NAME is a function make_NAME below.
# Needs the packages dpkg-dev, cmake, ninja-build, libglm-dev, libgtest-dev and the compiler; for the tool also
# libcli11-dev, nlohmann-json3-dev, libtinygltf-dev, libstb-dev.
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

# fetch PACKAGE [--tar-only]: sets `source` to its unpacked source, with Debian's patches unless --tar-only. Leaves
# apt's own settings alone.
fetch() {
    if [ ! -e "$folder/source/$1.fetched" ]; then
        local list="$folder/apt/sources.list"
        echo "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg]" \
             "http://deb.debian.org/debian bookworm main" > "$list"
        local apt=(apt-get -qq -o Dir::Etc::SourceList="$list" -o Dir::Etc::SourceParts=/dev/null
                   -o Dir::State::Lists="$folder/apt/lists" -o Dir::Cache="$folder/apt/cache")
        [ -n "$(find "$folder/apt/lists" -name '*_Sources*')" ] || "${apt[@]}" update
        (cd "$folder/source" && "${apt[@]}" source "$@" > "$1.log" 2>&1) || { cat "$folder/source/$1.log"; exit 1; }
        [ "${2:-}" != --tar-only ] || (cd "$folder/source" && tar xf "$1"_*.orig.tar.*)
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
header_library() { # NAME TARGET: a library of the build machine that is only headers
    cp -r "/usr/include/$3" "$prefix/include/"
    mkdir -p "$prefix/lib/cmake/$1"
    printf 'add_library(%s INTERFACE IMPORTED)\ntarget_include_directories(%s INTERFACE %s)\n' "$2" "$2" \
        "$prefix/include" > "$prefix/lib/cmake/$1/$1-config.cmake"
}
make_headers() {
    header_library glm glm::glm glm
}

# What the tool needs besides.
make_tool_headers() {
    header_library cli11 CLI11::CLI11 CLI
    header_library nlohmann_json nlohmann_json::nlohmann_json nlohmann
    cp /usr/include/tiny_gltf.h "$prefix/include/"
    cp -r /usr/include/stb "$prefix/include/"
    echo '#include <stb/stb_rect_pack.h>' > "$folder/build/stb.c"
    x86_64-w64-mingw32-gcc-posix -O2 -DSTB_RECT_PACK_IMPLEMENTATION -I "$prefix/include" \
        -c "$folder/build/stb.c" -o "$folder/build/stb.o"
    x86_64-w64-mingw32-ar rcs "$prefix/lib/libstb.a" "$folder/build/stb.o"
    package_file stb -lstb ""
}
make_zlib() {
    fetch zlib
    build zlib zlibstatic "$source"
    cp "$source/zlib.h" "$folder/build/zlib/zconf.h" "$prefix/include/"
    cp "$folder/build/zlib/libzlibstatic.a" "$prefix/lib/libz.a"
}
make_png() {
    fetch libpng1.6
    build png install "$source" -DPNG_SHARED=OFF -DPNG_TESTS=OFF -DPNG_EXECUTABLES=OFF
}
make_jpeg() {
    fetch libjpeg-turbo
    # Its own GNUInstallDirs would make a relative folder one of the current folder.
    build jpeg install "$source" "-DCMAKE_INSTALL_LIBDIR=$prefix/lib" -DENABLE_SHARED=OFF -DWITH_SIMD=OFF \
        -DWITH_TURBOJPEG=OFF
}
make_webp() {
    fetch libwebp
    local part options=()
    for part in ANIM_UTILS CWEBP DWEBP GIF2WEBP IMG2WEBP VWEBP WEBPINFO WEBPMUX EXTRAS; do
        options+=("-DWEBP_BUILD_$part=OFF")
    done
    build webp install "$source" "${options[@]}"
    package_file libwebp -lwebp ""
}
make_tiff() {
    fetch tiff
    local part options=()
    for part in tools tests contrib docs; do
        options+=("-Dtiff-$part=OFF")
    done
    for part in lzma zstd webp jbig lerc libdeflate; do
        options+=("-D$part=OFF")
    done
    build tiff install "$source" "${options[@]}"
}
make_exr() {
    fetch imath
    build imath install "$source" -DPYTHON=OFF
    fetch openexr
    build exr install "$source" -DOPENEXR_BUILD_TOOLS=OFF -DOPENEXR_INSTALL_EXAMPLES=OFF -DOPENEXR_INSTALL_TOOLS=OFF
}
make_meshoptimizer() {
    fetch meshoptimizer
    build meshoptimizer install "$source"
}
make_curl() { # HTTP and HTTPS by the system's own TLS
    fetch curl
    local part options=()
    for part in ZLIB ZSTD BROTLI; do
        options+=("-DCURL_$part=OFF")
    done
    build curl install "$source" -DBUILD_CURL_EXE=OFF -DHTTP_ONLY=ON -DCURL_USE_SCHANNEL=ON -DCURL_USE_LIBSSH2=OFF \
        -DCURL_USE_LIBPSL=OFF -DUSE_LIBIDN2=OFF -DUSE_NGHTTP2=OFF -DENABLE_UNICODE=ON "${options[@]}"
}
make_httplib() { # as one header, without TLS and compression
    fetch cpp-httplib
    cp "$source/httplib.h" "$prefix/include/"
    package_file cpp-httplib "-lws2_32" ""
}
make_embree() { # Triangles and single rays are all that RayScene uses.
    fetch embree --tar-only # the mirror lacks Debian's patches, which concern Debian's own build
    # CMake 3.25 sets this variable only for clang.
    sed -i 's/CMAKE_CXX_COMPILER_FRONTEND_VARIANT} MATCHES/CMAKE_CXX_COMPILER_ID} MATCHES/' "$source/CMakeLists.txt"
    sed -i '/embree\.rc/d' "$source/kernels/CMakeLists.txt" # in UTF-16, which windres does not read
    touch "$source/readme.pdf" # which Debian removed, and which `install` copies
    local part options=()
    for part in ISPC_SUPPORT TUTORIALS RAY_PACKETS RAY_MASK BACKFACE_CULLING GEOMETRY_QUAD GEOMETRY_CURVE \
        GEOMETRY_SUBDIVISION GEOMETRY_USER GEOMETRY_INSTANCE GEOMETRY_GRID GEOMETRY_POINT; do
        options+=("-DEMBREE_$part=OFF")
    done
    build embree install "$source" -DEMBREE_STATIC_LIB=ON -DEMBREE_TASKING_SYSTEM=INTERNAL -DEMBREE_MAX_ISA=SSE2 \
        -DEMBREE_INSTALL_DEPENDENCIES=OFF "${options[@]}"
}

for name in "$@"; do
    [ -e "$prefix/$name.done" ] || { "make_$name" && touch "$prefix/$name.done"; }
done
