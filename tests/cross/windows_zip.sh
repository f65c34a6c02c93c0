#!/bin/bash
# Packs the tool and the C interface (DLL, import library, header) for Windows, with the licences of the
# libraries that they hold.
#   tests/cross/windows_zip.sh FOLDER   FOLDER is what `run.sh windows` built; the archive appears in it
set -euo pipefail
folder=$(cd "${1:?FOLDER}" && pwd)
root=$(cd "$(dirname "$0")/../.." && pwd)
version=$(sed -n 's/^project(tessera VERSION \([0-9.]*\).*/\1/p' "$root/CMakeLists.txt")
name=tessera-$version-windows-x86_64
rm -rf "${folder:?}/$name" "$folder/$name.zip"
mkdir -p "$folder/$name"/{bin,lib,include/tessera/codec,licences}
for program in tessera.exe libtessera.dll; do
    x86_64-w64-mingw32-strip -o "$folder/$name/bin/$program" "$folder/bin/$program"
done
cp "$folder/codec/libtessera.dll.a" "$folder/$name/lib/"
cp "$folder/include/tessera/codec/tessera.h" "$folder/$name/include/tessera/codec/"
cp "$root/tests/cross/windows_readme.txt" "$folder/$name/README.txt"
for source in "$folder"-libraries/source/*/; do # built by dependencies.sh
    library=$(basename "$source")
    licence=$source/debian/copyright
    [ -e "$licence" ] || licence=$source/LICENSE.txt
    cp "$licence" "$folder/$name/licences/${library%%-[0-9]*}.txt"
done
# Headers of the build machine, GCC's libraries, and libc++ in the viewer's WebAssembly.
for package in libglm-dev libcli11-dev nlohmann-json3-dev libtinygltf-dev libstb-dev libstdc++6 \
    mingw-w64-x86-64-dev libc++-19-dev-wasm32 wasi-libc; do
    cp "/usr/share/doc/$package/copyright" "$folder/$name/licences/$package.txt"
done
(cd "$folder" && cmake -E tar cf "$name.zip" --format=zip "$name")
echo "$folder/$name.zip: $(stat -c %s "$folder/$name.zip") bytes, of which are unpacked:"
(cd "$folder/$name" && stat -c '  %n %s' bin/* lib/*)
