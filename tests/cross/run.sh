#!/bin/bash
# Tests the decoder and the encoder on another processor or with another compiler. It builds in
# build-cross-ARCH and runs same_bytes and the tests that take seconds. The golden files and some encodes
# must give the frozen results in tests/golden. Damaged files must give the same results as in a native
# build.
#   tests/cross/run.sh ARCH   aarch64 or s390x (big-endian): runs under qemu with these packages of
#                             Debian, where aarch64 is called arm64:
#                               dpkg --add-architecture s390x
#                               apt install g++-s390x-linux-gnu qemu-user-static \
#                                   libzstd-dev:s390x libdraco-dev:s390x libgtest-dev:s390x
#                             clang: this processor with clang++
# TESTS: gtest filter for both programs. The default runs all tests that take seconds, "" runs none.
set -euo pipefail
cd "$(dirname "$0")/../.."
arch=${1:?ARCH, as the head of this file says}
# Builds only the libraries and their tests. Only clang uses -O3, which is slow to compile for qemu.
common=(-G Ninja -DCMAKE_UNITY_BUILD=ON -DTESSERA_TESTS=ON -DTESSERA_TOOLS=OFF -DTESSERA_GPU=OFF
        -DTESSERA_SHARED=OFF -DTESSERA_HTTP=OFF -DTESSERA_WEB=OFF)
run=()
case $arch in
clang) other=(-DCMAKE_BUILD_TYPE=Release -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++) ;;
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
targets=(same_bytes)
[ -z "$filter" ] || targets+=(format_tests codec_tests)
folder=build-cross-$arch
cmake -S . -B "$folder" "${common[@]}" "${other[@]}" > "$folder.log" || { cat "$folder.log"; exit 1; }
rm "$folder.log"
ninja -C "$folder" "${targets[@]}"
env -u PKG_CONFIG_LIBDIR cmake -S . -B build-cross-native "${common[@]}" -DCMAKE_BUILD_TYPE=Release > /dev/null
ninja -C build-cross-native same_bytes
build-cross-native/bin/same_bytes tests/golden > build-cross-native/made.txt
"${run[@]}" "$folder/bin/same_bytes" tests/golden > "$folder/made.txt"
head -n "$(wc -l < tests/golden/manifest.txt)" "$folder/made.txt" | diff tests/golden/manifest.txt -
tail -n "$(wc -l < tests/golden/encodings.txt)" "$folder/made.txt" | diff tests/golden/encodings.txt -
diff build-cross-native/made.txt "$folder/made.txt"
echo "$arch: $(wc -l < "$folder/made.txt") results equal those of the native build"
[ -z "$filter" ] || for tests in format_tests codec_tests; do
    "${run[@]}" "$folder/bin/$tests" --gtest_brief=1 --gtest_filter="$filter"
done
