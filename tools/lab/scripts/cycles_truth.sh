#!/bin/sh
# Renders models with `render --truth` and with Blender Cycles and compares both, their pictures and
# then their times: the tables "Truth beside Blender Cycles" of tests/regression/models.md.
#   tools/lab/scripts/cycles_truth.sh TESSERA SHARED OUT [PATHS]
# SHARED holds the folder assets of models and environments. Each pixel gets PATHS paths, a multiple
# of 16, 128 by default. Needs Blender 3.4; takes five to nine minutes on two shared cores.
set -eu
tool=$1 assets=$2/assets out=$3 paths=${4:-128}
models=$assets/models environment=$assets/studio.exr
script=$(dirname "$0")/cycles_truth.py
exposure=0.0005 # The brightest lamp reaches 1,700.
mkdir -p "$out"

# Sets the model of a name, its camera and options of bake.
select_model() {
    options=
    case $1 in
    cornell*) model=$models/CornellBox.glb eye=-278,274.4,955.6 look=-278,274.4,-279.6 ;;
    teapot*) model=$models/teapot.obj eye=5.943,5.392,5.727 look=0.217,1.575,0 options='--metal 1 --roughness 0.1' ;;
    alpha*) model=$models/AlphaBlendModeTest.glb eye=0,1.744,7.632 look=0,1.099,-0.1 ;;
    sunglasses*) model=$models/SunglassesKhronos.glb eye=0.0608,0.0896,0.106 look=0,0.0288,-0.0764 ;;
    helmet*) model=$models/FlightHelmet/FlightHelmet.gltf eye=0.2443,0.5218,0.9844 look=-0.02035,0.358,0.01419 ;;
    esac
}

# compare NAME [MATERIALS-TO-OMIT]
compare() {
    name=$1 omitted=${2:-}
    select_model "$name"
    # The truth needs only the .tess's metadata, so its texture is tiny.
    "$tool" bake "$model" -o "$out/$name.tess" --layered --texels 4000 --effort 0 \
        --spp 1 --env "$environment" --exposure $exposure -q $options
    # One ray at each of 4x4 places per pixel: the script joins them in linear light.
    "$tool" render "$out/$name.tess" -o "$out/$name.exr" --eye "$eye" --look "$look" --pixels 800x600 --rays 1 \
        --truth "$model" --truth-spp $((paths / 16)) --write-all -q
    for lobes in blender gltf; do
        blender -b --python-exit-code 1 -P "$script" -- "$model" "$environment" "$eye" "$look" 45 \
            200x150 "$paths" "$out/$name-$lobes.exr" "$out/$name-truth.exr" $exposure "$omitted" \
            $lobes > "$out/$name-$lobes.log"
        printf '%s, diffuse lobe of %s: ' "$name" $lobes
        grep 'mean light' "$out/$name-$lobes.log"
    done
}

compare cornell
compare teapot
compare alpha
compare alpha-unblended MatBlend
compare sunglasses lens_interior,lens_exterior,nose_pads
compare helmet LensesMat

# The table of times: speed NAME [EYE], after compare
speed() {
    select_model "$1"
    printf '%s\n' "$1"
    blender -b --python-exit-code 1 -P "$(dirname "$0")/cycles_speed.py" -- "$tool" "$out/$1.tess" "$model" \
        "$environment" "${2:-$eye}" "$look" $exposure 128 > "$out/$1-speed.log"
    grep noise "$out/$1-speed.log"
}

speed cornell
speed teapot
speed alpha
speed sunglasses 0.0304,0.0592,0.0148 # nearer
speed helmet
