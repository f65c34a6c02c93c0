#!/bin/sh
# Renders models with `render --truth` and with Blender Cycles and compares both: the table "Truth
# beside Blender Cycles" of tests/regression/models.md.
#   tools/lab/scripts/cycles_truth.sh TESSERA SHARED OUT [PATHS]
# SHARED holds the folder assets of models and environments. Each pixel gets PATHS paths, a multiple
# of 16, 128 by default. Needs Blender 3.4; takes two to four minutes on two shared cores.
set -eu
tool=$1 assets=$2/assets out=$3 paths=${4:-128}
models=$assets/models environment=$assets/studio.exr
script=$(dirname "$0")/cycles_truth.py
exposure=0.0005 # The brightest lamp reaches 1,700.
mkdir -p "$out"

# compare NAME MODEL EYE MATERIALS-TO-OMIT options of bake...
compare() {
    name=$1 model=$2 eye=$3 omitted=$4
    shift 4
    # The truth needs only the .tess's metadata, so its texture is tiny.
    "$tool" bake "$model" -o "$out/$name.tess" --single --density 2 --directions 1x1 --effort 0 \
        --spp 1 --env "$environment" --exposure $exposure -q "$@"
    # One ray at each of 4x4 places per pixel: the script joins them in linear light.
    "$tool" render "$out/$name.tess" -o "$out/$name.exr" --eye "$eye" --pixels 800x600 --rays 1 \
        --truth "$model" --truth-spp $((paths / 16)) --write-all -q
    for lobes in blender gltf; do
        blender -b --python-exit-code 1 -P "$script" -- "$model" "$environment" "$eye" 0,0,0 45 \
            200x150 "$paths" "$out/$name-$lobes.exr" "$out/$name-truth.exr" $exposure "$omitted" \
            $lobes > "$out/$name-$lobes.log"
        printf '%s, diffuse lobe of %s: ' "$name" $lobes
        grep 'mean light' "$out/$name-$lobes.log"
    done
}

compare cornell "$models/CornellBox.glb" 0,0,9 ''
compare teapot "$models/teapot.obj" 6,4,6 '' --metal 1 --roughness 0.1
compare alpha "$models/AlphaBlendModeTest.glb" 0,0.5,6 ''
compare alpha-unblended "$models/AlphaBlendModeTest.glb" 0,0.5,6 MatBlend
compare sunglasses "$models/SunglassesKhronos.glb" 2,2,6 lens_interior,lens_exterior,nose_pads
compare helmet "$models/FlightHelmet/FlightHelmet.gltf" 2.1,1.3,7.7 LensesMat
