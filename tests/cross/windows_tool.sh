#!/bin/bash
# Tests tessera.exe, as windows_zip.sh packed it, under wine from a folder of its own.
#   tests/cross/windows_tool.sh FOLDER NATIVE
# FOLDER is what `run.sh windows` built; NATIVE is a native build with the tool and tools_tests.
# TOOL_TESTS: gtest filter for tools_tests; "" runs none.
set -euo pipefail
folder=$(cd "${1:?FOLDER}" && pwd) native=$(cd "${2:?NATIVE}" && pwd)
root=$(cd "$(dirname "$0")/../.." && pwd)
export WINEPREFIX=${WINEPREFIX:-$folder-libraries/wine} WINEDEBUG=${WINEDEBUG:--all} no_proxy=127.0.0.1
work=$(mktemp -d)
server=
end() {
    [ -z "$server" ] || kill "$server" || true
    rm -rf "$work"
}
trap end EXIT
cd "$work"
cmake -E tar xf "$folder"/tessera-*-windows-x86_64.zip
wine=/usr/lib/wine/wine64 exe=$(echo "$work"/tessera-*/bin/tessera.exe)
printf '#!/bin/bash\nexec timeout 300 %s %q "$@"\n' "$wine" "$exe" > tool
chmod +x tool
x86_64-w64-mingw32-gcc-posix -O1 "$root/tests/cross/hold_file.c" -o hold_file.exe
windows() { "$work/tool" "$@"; }
linux() { "$native/bin/tessera" "$@"; }
checks=0
check() { # WHAT COMMAND...
    "${@:2}" > "$work/said" 2>&1 || { echo "failed with $?: $1"; cat "$work/said"; exit 1; }
    checks=$((checks + 1))
}
refuses() { # WHAT CODE WORDS COMMAND...: fails with the code and one line that contains the words
    local code=0
    "${@:4}" > "$work/said" 2>&1 || code=$?
    if [ "$code" != "$2" ] || ! grep -qF "$3" "$work/said" || [ "$(wc -l < "$work/said")" != 1 ]; then
        cat "$work/said"
        echo "failed with $code: $1"
        exit 1
    fi
    checks=$((checks + 1))
}
mkdir files && cd files

# Both systems write the same bytes.
linux bake composed --size 32x16x9x5 --spp 2 -q -o scene.exr
check "bake" windows bake composed --size 32x16x9x5 --spp 2 -q -o windows.exr
check "the same scene" cmp scene.exr windows.exr
for options in "--effort 1 --target-psnr 40" "--effort 3 --quality 60" "--effort 0 --lossless"; do
    # shellcheck disable=SC2086
    linux encode scene.exr $options -q -o linux.tess
    # shellcheck disable=SC2086
    check "encode $options" windows encode scene.exr $options -q -o windows.tess
    check "the same file by $options" cmp linux.tess windows.tess
    for ending in raw exr; do
        linux decode linux.tess -q -o "linux.$ending"
        check "decode to $ending" windows decode linux.tess -q -o "windows.$ending"
        check "the same texels in $ending" cmp "linux.$ending" "windows.$ending"
    done
    linux decode linux.tess -q -o linux_views/
    check "decode to views" windows decode linux.tess -q -o 'windows_views\'
    check "the same views" diff -r linux_views windows_views
    rm -r linux_views windows_views
done
linux info linux.tess --json | sed 's/linux\.tess/x/' > linux.json
windows info linux.tess --json | sed 's/linux\.tess/x/' > windows.json
check "the same facts" diff linux.json windows.json
check "validate" windows validate linux.tess
linux compare scene.exr linux.tess | grep -v '^  time' > linux.txt
windows compare scene.exr linux.tess | grep -v '^  time' > windows.txt
check "the same comparison" diff linux.txt windows.txt
for verb in "sheet linux.tess" "render linux.tess --pixels 64x48"; do
    # shellcheck disable=SC2086
    linux $verb -o linux.png > /dev/null
    # shellcheck disable=SC2086
    check "$verb" windows $verb -o windows.png
    check "the same picture by $verb" cmp linux.png windows.png
done
check "rd" windows rd scene.exr --rivals none --efforts 0 --psnr 38 -q -o 'curves\'

# Names: UTF-8, drives, both slashes, more than 260 characters.
name='größe € 測試.tess'
cp linux.tess "$name"
check "a UTF-8 name" windows info "$name"
grep -qF "$name" "$work/said"
check "a UTF-8 name is written" windows encode scene.exr --effort 0 -q -o "neu $name"
[ -e "neu $name" ]
check "a drive and backslashes" windows decode "Z:${PWD//\//\\}\\linux.tess" -q -o "Z:${PWD//\//\\}\\drive.exr"
check "the same texels by the drive" cmp drive.exr linux.exr
check "a path from the root of a drive" windows validate "$PWD/linux.tess"
long=$(printf 'a-folder-with-a-name-of-40-characters-xx/%.0s' 1 2 3 4 5 6 7 8)
check "a long path is made" windows encode scene.exr --effort 0 -q -o "${long}a.tess"
check "a long path is read" windows validate "${long}a.tess"
check "views in a long path" windows decode "${long}a.tess" -q -o "${long}views/"
check "views are read from a long path" windows encode "${long}views/" --effort 0 -q -o b.tess
check "rd in a long path" windows rd scene.exr --rivals none --efforts 0 --psnr 38 -q -o "${long}curves"
check "the files of rd are there" test -s "${long}curves/rd.csv" -a -s "${long}curves/index.html"
# Nine photographs of a wall.
frames=()
for x in -1 0 1; do
    for y in -1 0 1; do
        frames+=("{\"file_path\":\"photos/größe ${#frames[@]}.png\",\"transform_matrix\":
                  [[1,0,0,$x],[0,1,0,$y],[0,0,1,10],[0,0,0,1]]}")
    done
done
mkdir "${long}wall"
printf 'v -3 -3 0\nv 3 -3 0\nv 3 3 0\nv -3 3 0\nf 1 2 3 4\n' > wall.obj
(IFS=,; echo "{\"w\":32,\"h\":32,\"fl_x\":36,\"frames\":[${frames[*]}]}") > "${long}wall/transforms.json"
linux render --scene lambert --size 32x16x2x2 --spp 1 --cameras "${long}wall/transforms.json" \
    -o "${long}wall/photos" -q
fit=(--mesh wall.obj --texels 1024 --directions 2 --shared-directions 4 --smoothness 1 --no-corrections -q)
cp -r "${long}wall" 'wände €'
check "photographs" windows fit 'wände €/transforms.json' "${fit[@]}" -o wall.tess
check "photographs are drawn" windows render wall.tess --cameras 'wände €' -q -o 'drawn €/'
check "photographs in a long path" windows fit "${long}wall" "${fit[@]}" -o far_wall.tess
check "they are drawn" windows render far_wall.tess --cameras "${long}wall" -q -o "${long}drawn"
check "the same pictures by both paths" diff -r 'drawn €' "${long}drawn"
check "photographs are compared" windows compare "${long}wall" "${long}drawn"
check "pictures are compared" windows compare 'drawn €' "${long}drawn" --pictures --min-psnr 99

# An encode that is killed goes on where it was, and gives the same bytes.
long_encode=(encode big.exr --effort 4 --tile 16x16x9x9 --threads 1 -q)
linux bake composed --size 96x96x9x9 --spp 1 -q -o big.exr
linux "${long_encode[@]}" -o linux_big.tess
"$wine" "$exe" "${long_encode[@]}" -o big.tess &
encoder=$!
until [ "$(find big.tess.journal/pass-1 -size +2k 2> /dev/null)" ]; do
    kill -0 "$encoder"
    sleep 0.05
done
kill -KILL "$encoder"
wait "$encoder" 2> /dev/null || true
check "an encode was killed" test ! -e big.tess -a -e big.tess.journal/pass-1
check "it is resumed" windows "${long_encode[@]}" --resume -o big.tess
check "the same file after a kill" cmp big.tess linux_big.tess
check "no journal is left" test ! -e big.tess.journal

# Names that Windows reserves, files in use, read-only files. Nothing is left behind.
rm -rf left && mkdir left
for reserved in nul.tess CON.tess 'left\COM1.tess' 'left\LPT1.tess'; do
    refuses "to write $reserved" 2 "$reserved: cannot write: the system reserves this name" \
        windows encode scene.exr --effort 0 -q -o "$reserved"
done
refuses "to write a name with ?" 2 'a?.tess' windows encode scene.exr --effort 0 -q -o 'left\a?.tess'
refuses "to read NUL" 2 nul.tess windows info nul.tess
cp linux.tess left/held.tess
"$wine" ../hold_file.exe 'left\held.tess' > held &
holder=$!
until grep -q held held; do sleep 0.1; done
refuses "to read a held file" 2 "another process has the file open" windows info 'left\held.tess'
refuses "to replace a held file" 2 "another process has the file open; finished tiles are kept" \
    windows encode scene.exr --effort 0 -q -o 'left\held.tess'
kill "$holder"
wait "$holder" || true
check "the held file is as before" cmp left/held.tess linux.tess
check "the same encode ends once the file is free" \
    windows encode scene.exr --effort 0 --resume -q -o 'left\held.tess'
chmod a-w left/held.tess
refuses "to replace a read-only file" 2 "read-only" windows encode scene.exr --effort 0 -q -o 'left\held.tess'
check "nothing is left" test "$(ls left)" = held.tess

# Text with Windows' line ends.
linux decode linux.tess -q -o views/
linux encode views/ --effort 0 -q -o linux_views.tess
sed -i 's/$/\r/' views/*.json
check "JSON with CRLF" windows encode views/ --effort 0 -q -o windows_views.tess
check "the same file by JSON with CRLF" cmp linux_views.tess windows_views.tess

# Models and meshes.
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1\n' > model.obj
mkdir crlf
sed 's/$/\r/' model.obj > crlf/model.obj
bake=(--density 8 --directions 4x4 --spp 1 --effort 0 -q)
linux bake model.obj "${bake[@]}" -o model.tess
check "a texture on a mesh is decoded" windows decode model.tess -q -o model.exr
cd crlf # the file holds the model's name as given
check "a model with CRLF is baked" windows bake model.obj "${bake[@]}" -o ../windows_model.tess
cd ..
check "the same file of a model" cmp model.tess windows_model.tess
linux render model.tess -q -o linux.png --pixels 64x48
check "a mesh is drawn" windows render windows_model.tess -q -o windows.png --pixels 64x48
check "the same picture of a mesh" cmp linux.png windows.png
# What no build for Windows has is named.
refuses "to draw by OpenGL" 5 "no GPU support" windows render linux.tess --via gpu -q -o left.png
check "rd without rivals" windows rd scene.exr --rivals x265 --efforts 0 --psnr 38 -q -o 'rivals\'
grep -q "not installed: x265" rivals/rd.csv
check "no output is left" test ! -e left.tess -a ! -e left.png

# Servers and URLs.
"$wine" "$exe" serve . --port 0 > url &
server=$!
until grep -q http url; do sleep 0.1; done
url=$(head -n 1 url | tr -d '\r')
check "Windows reads from Windows" windows decode "${url}linux.tess" -q -o served.exr
check "the same texels by HTTP" cmp served.exr linux.exr
check "Linux reads from Windows" linux validate "${url}linux.tess"
check "the list of files" curl -sf "$url"
grep -qF "$name" "$work/said"
check "the viewer" curl -sf "$url?f=linux.tess"
grep -qi "<html" "$work/said"
echo secret > ../secret.tess
for path in ..%5Csecret.tess %5C%5Clocalhost%5Ca.tess "Z:%5Csecret.tess" C: NUL; do
    check "no answer to $path" test "$(curl -s -o /dev/null -w '%{http_code}' "$url$path")" = 404
done
kill "$server"
wait "$server" || true
server=
check "view" windows view linux.tess -o page.html
grep -q "<html" page.html
echo "$checks checks of tessera.exe pass"

# The other tests of the command line start tens of processes each, or need links, signals or /dev.
default=CliJson.*:CliStream.*:FitCli.*:Cli.BakesEncodesDecodesCompares:Cli.DecodesParts:Cli.KeepsTheMesh
filter=${TOOL_TESTS-$default}
[ -z "$filter" ] || TESSERA_TOOL=$work/tool "$native/bin/tools_tests" --gtest_brief=1 --gtest_filter="$filter"
