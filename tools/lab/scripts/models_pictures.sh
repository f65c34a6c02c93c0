#!/bin/sh
# Draws each model beside its truth, close by, in layers of four sizes: the picture of
# tests/regression/models.md.
#   tools/lab/scripts/models_pictures.sh TESSERA SHARED OUT
# SHARED holds the folder assets of models and environments. Files that OUT already has are used
# again. Takes about 15 minutes on two cores; the picture is OUT/models.png.
set -eu
tool=$1 shared=$2 out=$3
assets=$shared/assets
mkdir -p "$out"
: > "$out/pictures.txt"

figure() { python3 -c 'import json, sys
view = json.load(open(sys.argv[1]))["views"][0]["compressed_truth"]
print("%.1f kB, %.1f dB" % (int(sys.argv[2]) / 1000, view["object_psnr"]))' "$@"; }

# A budget is BYTES, BYTES:TEXELS or default: row NAME MODEL eye look fov "budgets" options...
row() {
    name=$1 model=$assets/$2 eye=$3 look=$4 fov=$5 budgets=$6
    shift 6
    for budget in $budgets; do
        file=$out/$name-${budget%:*}
        case $budget in
        default) set_size= ;;
        *:*) set_size="--target-bytes ${budget%:*} --texels ${budget#*:}" ;;
        *) set_size="--target-bytes $budget" ;;
        esac
        [ -e "$file.tess" ] || "$tool" bake "$model" -o "$file.tess" --layered -q $set_size "$@"
        [ -e "$file.json" ] || "$tool" render "$file.tess" -o "$file.png" --eye="$eye" --look="$look" \
            --fov "$fov" --pixels 192x144 --truth "$model" --truth-spp 256 --write-all --json -q > "$file.json"
        [ "$budget" != "${budgets%% *}" ] || printf '%s-truth.png\t%s, truth\n' "$file" "$name" >> "$out/pictures.txt"
        printf '%s.png\t%s\n' "$file" "$(figure "$file.json" "$(stat -c %s "$file.tess")")" >> "$out/pictures.txt"
    done
}

studio="--env $assets/studio.exr"
row FlightHelmet models/FlightHelmet/FlightHelmet.gltf 0.09305,0.5785,0.3796 -0.02035,0.5092,0.03939 36 \
    "180000:500000 240000:700000 default 480000:1500000" $studio
row AlphaBlendModeTest models/AlphaBlendModeTest.glb 0,1.2,4 0,1.2,0 36 "40000 80000 160000 320000" $studio
row PalmTree models/PalmTree/PalmTree.gltf 5,3.5,7 0,2,0 40 "80000 160000 default 320000" $studio
row CornellBox models/CornellBox.glb -141,412,269 -278,274,-280 45 "15000 30000 60000 120000"
row teapot models/teapot.obj 2.60268,3.0064,4.77135 0.217,1.86128,0 36 "20000 40000 70000 150000" \
    --metal 1 --roughness 0.1 $studio
row bunny bunny.glb 0.895,0.561,1.79 0,0.131,0 36 "16000 25000 50000 100000" $studio

set -- # pictures first, because --label takes all that follows
while IFS="$(printf '\t')" read -r picture label; do
    set -- "$@" "$picture"
done < "$out/pictures.txt"
while IFS="$(printf '\t')" read -r picture label; do
    set -- "$@" --label "$label"
done < "$out/pictures.txt"
"$tool" sheet --columns 5 -o "$out/models.png" "$@"
