#!/bin/bash
# Tests the decoder and the encoder on another processor, with another compiler or on another system. It builds
# in build-cross-ARCH and runs same_bytes and the tests that take seconds. The golden files and some encodes
# must give the frozen results in tests/golden. Damaged files must give the same results as in a native
# build. README.md says what was found.
#   tests/cross/run.sh ARCH   aarch64 or s390x (big-endian): runs under qemu with these packages of
#                             Debian, where aarch64 is called arm64:
#                               dpkg --add-architecture s390x
#                               apt install g++-s390x-linux-gnu qemu-user-static \
#                                   libzstd-dev:s390x libdraco-dev:s390x libgtest-dev:s390x
#                             clang: this processor with clang-19 and its libc++:
#                               apt install clang-19 libc++-19-dev libc++abi-19-dev dpkg-dev
#                             windows: mingw-w64, also builds the tool, runs under wine:
#                               apt install g++-mingw-w64-x86-64-posix wine64 dpkg-dev and what the
#                                   tool is built with natively (tools/common.sh)
# TESTS: gtest filter for both programs. The default runs all tests that take seconds, "" runs none.
set -euo pipefail
cd "$(dirname "$0")/../.."
arch=${1:?ARCH, as the head of this file says}
# Builds only the libraries and their tests. Only clang and mingw use -O3, which is slow to compile for qemu.
common=(-G Ninja -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=24 -DTESSERA_TESTS=ON -DTESSERA_TOOLS=OFF
        -DTESSERA_GPU=OFF -DTESSERA_SHARED=OFF -DTESSERA_HTTP=OFF -DTESSERA_WEB=OFF -DTESSERA_PYTHON=OFF)
! command -v ccache > /dev/null || common+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
run=()
program=""
targets=(same_bytes)
native_targets=(same_bytes)
tool=()
folder=build-cross-$arch
case $arch in
clang)
    libraries=$PWD/$folder-libraries
    tests/cross/dependencies.sh libc++ "$libraries" draco gtest
    export PKG_CONFIG_PATH=$libraries/prefix/lib/pkgconfig
    other=(-DCMAKE_BUILD_TYPE=Release -DCMAKE_C_COMPILER=clang-19 -DCMAKE_CXX_COMPILER=clang++-19
           -DCMAKE_CXX_FLAGS=-stdlib=libc++ -DCMAKE_PREFIX_PATH="$libraries/prefix")
    ;;
windows)
    libraries=$PWD/$folder-libraries
    tests/cross/dependencies.sh windows "$libraries" zstd draco gtest headers \
        tool_headers zlib png jpeg webp tiff exr meshoptimizer curl httplib embree
    export PKG_CONFIG_LIBDIR=$libraries/prefix/lib/pkgconfig
    export WINEPREFIX=${WINEPREFIX:-$libraries/wine} WINEDEBUG=-all
    tool=(-DTESSERA_TOOLS=ON -DTESSERA_HTTP=ON -DTESSERA_WEB=AUTO)
    other=(-DCMAKE_BUILD_TYPE=Release -DCMAKE_TOOLCHAIN_FILE="$PWD/tests/cross/windows.cmake"
           -DTESSERA_CROSS_PREFIX="$libraries/prefix" -DTESSERA_SHARED=ON "${tool[@]}")
    run=(/usr/lib/wine/wine64)
    program=.exe
    targets+=(tessera_shared c_api_test tessera)
    native_targets+=(tessera tools_tests)
    ;;
*)
    multiarch=$arch-linux-gnu
    export PKG_CONFIG_LIBDIR=/usr/lib/$multiarch/pkgconfig:/usr/share/pkgconfig
    run=(qemu-"$arch"-static -L /)
    other=(-DCMAKE_BUILD_TYPE=Debug "-DCMAKE_CXX_FLAGS_DEBUG=-O1" -DCMAKE_SYSTEM_NAME=Linux
           -DCMAKE_SYSTEM_PROCESSOR="$arch" -DCMAKE_C_COMPILER="$multiarch-gcc"
           -DCMAKE_CXX_COMPILER="$multiarch-g++" -DCMAKE_LIBRARY_ARCHITECTURE="$multiarch"
           -DCMAKE_FIND_ROOT_PATH="/usr/lib/$multiarch;/usr" -DCMAKE_CROSSCOMPILING_EMULATOR="${run[0]};-L;/")
    ;;
esac
slow=Sampler*:Shader*:Journals*:DamagedJournals*:Rate*:Mask*:Prediction*:PredictedFiles*:EncodeCopies*:Layers*
slow+=:DenseTables*:Tools*:Encoder*:SameBytes*:DamagedLevels*:Partial*:Threads*:RefinedTrees*
slow+=:Encodings*:InverseTransform.Meets*:Codec*:DecodedLevel*:TileChoice*:TileReuse*:Access*:EncodeFilter*:Allocation*
filter=${TESTS--$slow}
[ -z "$filter" ] || targets+=(format_tests codec_tests)
jobs=${JOBS:-$(nproc)}
cmake -S . -B "$folder" "${common[@]}" "${other[@]}" > "$folder.log" || { cat "$folder.log"; exit 1; }
rm "$folder.log"
ninja -C "$folder" -j "$jobs" "${targets[@]}"
# NATIVE: a folder with a native build of same_bytes, for Windows also of tessera and tools_tests.
native=${NATIVE:-build-cross-native}
if [ -z "${NATIVE:-}" ]; then
    env -u PKG_CONFIG_LIBDIR -u PKG_CONFIG_PATH cmake -S . -B "$native" "${common[@]}" "${tool[@]}" \
        -DCMAKE_BUILD_TYPE=Release > /dev/null
    ninja -C "$native" -j "$jobs" "${native_targets[@]}"
fi
"$native/bin/same_bytes" tests/golden > "$folder/native.txt"
"${run[@]}" "$folder/bin/same_bytes$program" tests/golden | tr -d '\r' > "$folder/made.txt"
head -n "$(wc -l < tests/golden/manifest.txt)" "$folder/made.txt" | diff tests/golden/manifest.txt -
tail -n "$(wc -l < tests/golden/encodings.txt)" "$folder/made.txt" | diff tests/golden/encodings.txt -
diff "$folder/native.txt" "$folder/made.txt"
echo "$arch: $(wc -l < "$folder/made.txt") results equal those of the native build"
[ -z "$filter" ] || for tests in format_tests codec_tests; do
    "${run[@]}" "$folder/bin/$tests$program" --gtest_brief=1 --gtest_filter="$filter"
done
if [ "$arch" = windows ]; then
    tests/cross/windows_dll.sh "$folder"
    tests/cross/windows_zip.sh "$folder"
    tests/cross/windows_tool.sh "$folder" "$native"
fi
