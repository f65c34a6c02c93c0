#!/bin/bash
# Packs what programs on Windows need of the C interface: the DLL, its import library and the header.
#   tests/cross/windows_zip.sh FOLDER   FOLDER is what `run.sh windows` built; the archive appears in it
set -euo pipefail
folder=$(cd "${1:?FOLDER}" && pwd)
version=$(sed -n 's/^project(tessera VERSION \([0-9.]*\).*/\1/p' "$(dirname "$0")/../../CMakeLists.txt")
name=tessera-$version-windows-x86_64
rm -rf "${folder:?}/$name" "$folder/$name.zip"
mkdir -p "$folder/$name"/{bin,lib,include/tessera/codec}
x86_64-w64-mingw32-strip -o "$folder/$name/bin/libtessera.dll" "$folder/bin/libtessera.dll"
cp "$folder/codec/libtessera.dll.a" "$folder/$name/lib/"
cp "$folder/include/tessera/codec/tessera.h" "$folder/$name/include/tessera/codec/"
(cd "$folder" && cmake -E tar cf "$name.zip" --format=zip "$name")
echo "$folder/$name.zip: $(stat -c %s "$folder/$name.zip") bytes"
