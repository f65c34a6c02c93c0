#!/bin/sh
# Measures baked models against path-traced truth: the tables of tests/regression/models.md.
#   tools/lab/scripts/models.sh TESSERA SHARED OUT
# SHARED holds the folder assets of models and environments. Files that OUT already has are used
# again. Takes about half an hour on two cores.
set -eu
tool=$1 shared=$2 out=$3
assets=$shared/assets
mkdir -p "$out"

# Bakes once: bake NAME MODEL options...
bake() {
    file=$out/$1.tess
    name=$1 model=$2
    shift 2
    [ -e "$file" ] || "$tool" bake "$model" -o "$file" --env "$assets/studio.exr" --json "$@" \
        > "$out/$name.json"
}

# Renders one view beside its truth: view NAME MODEL POSE eye look fov
view() {
    result=$out/$1-$3
    [ -e "$result.json" ] || "$tool" render "$out/$1.tess" -o "$result.png" --eye "$4" --look "$5" \
        --fov "$6" --pixels 320x240 --truth "$2" --truth-spp 256 --write-all --json > "$result.json"
}

# Three poses close by and four whole, in the units of `bake`.
helmet_views() {
    view "$1" "$helmet" c1 0.9,1.75,2.9 0,1.2,0.2 36
    view "$1" "$helmet" c2 -3.3,0.9,1.9 -0.3,0.75,0.1 36
    view "$1" "$helmet" c3 0.7,0.5,2.5 0,0.35,0.3 36
    view "$1" "$helmet" w1 2.1,1.3,7.7 0,0,0 45
    view "$1" "$helmet" w2 -5.9,2,4.8 0,0,0 45
    view "$1" "$helmet" w3 6.5,0.8,-4.5 0,0,0 45
    view "$1" "$helmet" w4 1,5.8,5 0,0,0 45
}

# Two poses close by and two whole, for a model that fills the sphere of radius 3.5.
usual_views() {
    view "$1" "$2" c1 2.5,1.5,5 0,0.3,0 36
    view "$1" "$2" c2 -3.5,2.5,3.5 0,0,0 36
    view "$1" "$2" w1 2.1,1.3,9 0,0,0 45
    view "$1" "$2" w2 -6,4,-6 0,0,0 45
}

helmet=$assets/models/FlightHelmet/FlightHelmet.gltf
for rate in 240000:700000 320000:1000000 400000:1200000 480000:1500000; do
    bytes=${rate%:*}
    bake "helmet-$bytes" "$helmet" --layered --texels "${rate#*:}" --target-bytes "$bytes"
    helmet_views "helmet-$bytes"
done
# A plain picture on the same mesh: what other viewers show, the mean over all directions.
[ -e "$out/helmet-flat.tess" ] || {
    "$tool" convert "$out/helmet-480000.tess" -o "$out/flat.glb" --picture-side 4096 -q
    size=$(/usr/bin/python3 - "$out" << 'END'
import io, json, struct, sys
from PIL import Image
out = sys.argv[1]
glb = open(out + '/flat.glb', 'rb').read()
length = struct.unpack('<I', glb[12:16])[0]
description, data = json.loads(glb[20:20 + length]), glb[28 + length:]
view = description['bufferViews'][description['images'][0]['bufferView']]
begin = view.get('byteOffset', 0)
picture = Image.open(io.BytesIO(data[begin:begin + view['byteLength']])).convert('RGB')
open(out + '/flat.rgb', 'wb').write(picture.tobytes())
tess = open(out + '/helmet-480000.tess', 'rb').read()
entry, mesh = tess.find(b'prxy'), tess.find(b'DRACO')
open(out + '/flat.drc', 'wb').write(tess[mesh:mesh + struct.unpack('<I', tess[entry + 8:entry + 12])[0]])
print('%dx%dx1x1' % picture.size)
END
    )
    "$tool" encode "$out/flat.rgb" --size "$size" --channels 3 --mesh "$out/flat.drc" --proxy mesh \
        --surface-map mesh-uv --angular-map octahedral-mirrored --tile 32x32x1x1 \
        --target-bytes "$(stat -c %s "$out/helmet-480000.tess")" -o "$out/helmet-flat.tess" --json \
        > "$out/helmet-flat.json"
}
helmet_views helmet-flat

for model in bunny suzi pmndrs; do
    bake "$model-layers" "$assets/$model.glb" --layered --texels 200000
    usual_views "$model-layers" "$assets/$model.glb"
    bake "$model-single" "$assets/$model.glb" --spp 4
    usual_views "$model-single" "$assets/$model.glb"
done

python3 - "$out" << 'END'
import glob, json, math, os, sys
out = sys.argv[1]
def mean_psnr(figures):
    return -10 * math.log10(sum(10 ** (-p / 10) for p in figures) / len(figures))
print('| file | bytes | seconds | close, dB | whole, dB | SSIM close, whole | whole picture, dB |')
print('|---|---|---|---|---|---|---|')
for path in sorted(glob.glob(out + '/*.tess')):
    name = os.path.basename(path)[:-5]
    views = {p[len(out) + len(name) + 2:-5]: json.load(open(p))['views'][0]['compressed_truth']
             for p in glob.glob(f'{out}/{name}-[cw][0-9].json')}
    if not views:
        continue
    close = [v for k, v in views.items() if k[0] == 'c']
    whole = [v for k, v in views.items() if k[0] == 'w']
    ssim = ', '.join('%.3f' % (sum(v['ssim'] for v in s) / len(s)) for s in (close, whole))
    seconds = json.load(open(f'{out}/{name}.json'))['seconds']
    print('| %s | %d | %.0f | %.2f | %.2f | %s | %.2f |' % (
        name, os.path.getsize(path), seconds, mean_psnr([v['object_psnr'] for v in close]),
        mean_psnr([v['object_psnr'] for v in whole]), ssim,
        mean_psnr([v['psnr'] for v in views.values()])))
END
