#!/usr/bin/env bash
# Runs the shaders in WGSL and compiles those in HLSL (decoder_glsl/DIALECTS.md). Not part of CI, because it
# needs npm.
#   tests/shaders/run.sh [BUILD] [FILE.tess...]      BUILD: a build folder (build); FILE: also run on these
# Packages: nodejs npm glslang-tools spirv-tools spirv-cross zstd; mesa-vulkan-drivers and libvulkan-dev, for Mesa's
# Vulkan driver on the CPU; g++-mingw-w64-x86-64-posix and wine64 for HLSL. LAVAPIPE is the path of that driver if it
# is not installed. DRIVER=swiftshader takes the one in the package chromium, which does not finish compiling
# border.comp, so that files with predicted pictures are skipped.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
here=$root/tests/shaders
build=$(realpath "${1:-$root/build}")
shift || true
work=$build/shaders
tool=$build/bin/tessera
modules=$work/node_modules
PATH=$PATH:/usr/lib/wine

mkdir -p "$work"
if [ "${DRIVER:-lavapipe}" = swiftshader ]; then
    export VK_ICD_FILENAMES=/usr/lib/chromium/vk_swiftshader_icd.json
else
    g++ -std=c++20 -O1 -shared -fPIC "$here/lavapipe.cpp" -o "$work/lavapipe.so"
    printf '{"file_format_version": "1.0.0", "ICD": {"api_version": "1.3.230", "library_path": "%s"}}\n' \
        "$work/lavapipe.so" >"$work/lavapipe.json"
    export VK_ICD_FILENAMES=$work/lavapipe.json
fi
cp "$here/package.json" "$work"
npm install --prefix "$work" --no-audit --no-fund --silent
cmake --build "$build" --target tessera tessera_npm shader_cases layered_case

python3 "$root/decoder_glsl/dialects/translate.py" --tool "$tool" --check

# write DIALECT FOLDER MACRO...
write() {
    local dialect=$1 folder=$work/$1/$2 defines=()
    for macro in "${@:3}"; do defines+=(-D "$macro"); done
    rm -rf "$folder"
    "$tool" shaders -o "$folder" --dialect "$dialect" "${defines[@]}"
}
for dialect in wgsl hlsl; do
    write $dialect plain
    write $dialect half TSR_OUTPUT_HALF
    write $dialect plain_predicted TSR_PREDICTED_TILES
    write $dialect half_predicted TSR_OUTPUT_HALF TSR_PREDICTED_TILES
    write $dialect cache TESSERA_RESIDENT_CACHE
    write $dialect half_cache TSR_OUTPUT_HALF TESSERA_RESIDENT_CACHE
    write $dialect filter TESSERA_HARDWARE_FILTER
    write $dialect cache_filter TESSERA_RESIDENT_CACHE TESSERA_HARDWARE_FILTER
    write $dialect coverage TESSERA_COVERAGE_ONLY
    write $dialect filter_coverage TESSERA_HARDWARE_FILTER TESSERA_COVERAGE_ONLY
done

failed=0
cases=()
files=()
for file in "$root"/tests/golden/*.tess "$@"; do
    case ${DRIVER:-}$(basename "$file" .tess) in
    swiftshaderpicture8 | swiftshaderpicture_half | swiftshaderrgb8_large)
        echo "skipped: $(basename "$file") needs border.comp"
        continue ;;
    esac
    files+=("$file")
    cases+=("$work/$(basename "$file" .tess).case")
    "$build/bin/shader_cases" "$file" "${cases[-1]}"
done
node "$here/dawn.mjs" "$modules" "$work/wgsl" "${cases[@]}" || failed=1
node "$here/package_decoder.mjs" "$modules" "$work/wgsl" "$build/web/package" "${files[@]}" || failed=1
"$build/bin/layered_case" "$work/layers"
node "$here/layered.mjs" "$modules" "$work/wgsl" "$work/layers" || failed=1

if ! command -v wine64 >/dev/null || ! command -v x86_64-w64-mingw32-g++-posix >/dev/null; then
    echo "skipped: HLSL needs wine64 and g++-mingw-w64-x86-64-posix"
    exit $failed
fi
x86_64-w64-mingw32-g++-posix -std=c++20 -O1 -static -o "$work/dxc.exe" "$here/dxc.cpp"
cp "$modules"/webgpu/dist/win32-x64/*.dll "$work"
cd "$work"
arguments=()
declare -A seen # most shaders are the same with and without most macros
rm -f hlsl/*/sample.frag.hlsl hlsl/*/*.all.frag.hlsl
for file in hlsl/*/*.hlsl; do
    head=$(head -1 "$file")
    [ -z "${seen[$head]:-}" ] || continue
    seen[$head]=1
    case $file in
    */sample.hlsl) # a program that calls the sampler, as an application would
        cat "$file" - >"${file%.hlsl}.frag.hlsl" <<'END'
float4 main(float3 a : A, float3 b : B, float3 c : C, float2 d : D) : SV_Target0
{
    return tessera_sample(a, b) + tessera_sample_surface(d, a, b, c, d);
}
END
        arguments+=("${file%.hlsl}.frag.hlsl" ps_6_0) ;;
    */layered_mesh.frag.hlsl) # as translated, and with all layers
        { for id in {1..13}; do echo "#define SPIRV_CROSS_CONSTANT_ID_$id $id"; done; cat "$file"; } \
            >"${file%.frag.hlsl}.all.frag.hlsl"
        arguments+=("$file" ps_6_0 "${file%.frag.hlsl}.all.frag.hlsl" ps_6_0) ;;
    *.comp.hlsl) arguments+=("$file" cs_6_0) ;;
    *.frag.hlsl) arguments+=("$file" ps_6_0) ;;
    *.vert.hlsl) arguments+=("$file" vs_6_0) ;;
    esac
done
WINEPREFIX=$work/wine WINEDEBUG=-all WINEDLLOVERRIDES='mscoree,mshtml=' \
    wine64 dxc.exe "${arguments[@]}" >dxc.log 2>&1 || failed=1
grep FAILED dxc.log || true
echo "$(grep -c 'bytes of DXIL' dxc.log) of $((${#arguments[@]} / 2)) HLSL shaders compile to DXIL"
exit $failed
