#!/bin/bash
# Tests the DLL by C programs that link its import library, and continues an encode that was killed.
#   tests/cross/windows_dll.sh FOLDER   FOLDER is what `run.sh windows` built
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(cd "${1:?FOLDER}" && pwd)
wine=/usr/lib/wine/wine64
export WINEPREFIX=${WINEPREFIX:-$folder-libraries/wine} WINEDEBUG=${WINEDEBUG:--all}

link() { # NAME SOURCE
    x86_64-w64-mingw32-gcc-posix -std=c99 -DTESSERA_SHARED -I "$folder/include" "$2" -o "$folder/bin/$1.exe" \
        "$folder/codec/libtessera.dll.a"
}
link consumer_c "$root/tests/consumers/c/main.c"
link killed_encode "$root/tests/cross/killed_encode.c"
rm -rf "$folder/encoded" && mkdir "$folder/encoded" && cd "$folder/encoded"
"$wine" ../bin/c_api_test.exe c_api_test.tess
"$wine" ../bin/consumer_c.exe gradient.tess
"$wine" ../bin/killed_encode.exe 0
mv größe*.tess whole.tess
"$wine" ../bin/killed_encode.exe 25 || [ $? = 9 ]
[ ! -e größe*.tess ] && [ -e größe*.journal/pass-1 ] # killed with tiles
"$wine" ../bin/killed_encode.exe 0
cmp größe*.tess whole.tess
[ ! -e größe*.journal ]
echo "the DLL passes"
