#!/bin/sh
# Finds the cameras of 48 photographs with COLMAP and fits a texture to them: the figures of
# tests/regression/photographs.md.
#   tools/lab/scripts/colmap.sh TESSERA OUT
# Needs Debian's blender and colmap. Files that OUT already has are used again. Takes about 20 minutes on two cores.
set -eu
tool=$1 out=$2
scripts=$(dirname "$0")
export QT_QPA_PLATFORM=offscreen
mkdir -p "$out"

[ -e "$out/table.blend" ] || blender -b --python-exit-code 1 -P "$scripts/photo_scene.py" -- "$out/table.blend" > "$out/scene.log"
[ -e "$out/set/mesh.obj" ] || blender -b "$out/table.blend" --python-exit-code 1 -P "$scripts/../../scripts/blender_views.py" -- \
    photos "$out/set" 48 0 640x480 4.2 8 > "$out/photos.log"
if [ ! -e "$out/sparse/0" ]; then
    rm -f "$out/colmap.db"
    colmap feature_extractor --database_path "$out/colmap.db" --image_path "$out/set/train" \
        --ImageReader.single_camera 1 --SiftExtraction.use_gpu 0 --SiftExtraction.max_num_features 2048 > "$out/colmap.log"
    colmap exhaustive_matcher --database_path "$out/colmap.db" --SiftMatching.use_gpu 0 >> "$out/colmap.log"
    mkdir -p "$out/sparse"
    colmap mapper --database_path "$out/colmap.db" --image_path "$out/set/train" --output_path "$out/sparse" >> "$out/colmap.log"
fi

# Where the cameras are in the frame of the mesh. One measures it, or reads it from a rig or a turntable.
python3 - "$out/set/transforms_train.json" > "$out/places.txt" <<'END'
import json, sys
for frame in json.load(open(sys.argv[1]))['frames']:
    print(frame['file_path'].split('/')[-1] + '.png', *[row[3] for row in frame['transform_matrix'][:3]])
END
mkdir -p "$out/aligned"
colmap model_aligner --input_path "$out/sparse/0" --output_path "$out/aligned" --ref_images_path "$out/places.txt" \
    --ref_is_gps 0 --robust_alignment_max_error 0.02 >> "$out/colmap.log"

# With the cameras that COLMAP found, and with those that Blender used. COLMAP orders photographs otherwise, so others
# are kept out.
options="--mesh $out/set/mesh.obj --pixel-filter blackman-harris --hold-out 8 --quality 70"
[ -e "$out/colmap.tess" ] || "$tool" fit "$out/aligned" --images "$out/set/train" -o "$out/colmap.tess" $options
[ -e "$out/known.tess" ] || "$tool" fit "$out/set/transforms_train.json" -o "$out/known.tess" $options
