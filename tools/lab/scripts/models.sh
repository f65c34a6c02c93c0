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

# Three poses close by and four whole.
helmet_views() {
    view "$1" "$helmet" c1 0.09305,0.5785,0.3796 -0.02035,0.5092,0.03939 36
    view "$1" "$helmet" c2 -0.4362,0.4714,0.2536 -0.05815,0.4525,0.02679 36
    view "$1" "$helmet" c3 0.06785,0.421,0.3292 -0.02035,0.4021,0.05199 36
    view "$1" "$helmet" w1 0.2443,0.5218,0.9844 -0.02035,0.358,0.01419 45
    view "$1" "$helmet" w2 -0.7638,0.61,0.619 -0.02035,0.358,0.01419 45
    view "$1" "$helmet" w3 0.7987,0.4588,-0.5528 -0.02035,0.358,0.01419 45
    view "$1" "$helmet" w4 0.1057,1.089,0.6442 -0.02035,0.358,0.01419 45
}

# Two poses close by and two whole, around the middle of a model, X,Y,Z, whose farthest vertex is 3.5 * U
# away from it: usual_views NAME MODEL X,Y,Z U
usual_views() {
    for pose in c1:2.5,1.5,5:0,0.3,0:36 c2:-3.5,2.5,3.5:0,0,0:36 w1:2.1,1.3,9:0,0,0:45 w2:-6,4,-6:0,0,0:45; do
        view "$1" "$2" $(echo "$pose" | awk -F: -v middle="$3" -v unit="$4" '
            function place(text, p, m) {
                split(text, p, ","); split(middle, m, ",")
                return m[1] + unit * p[1] "," m[2] + unit * p[2] "," m[3] + unit * p[3]
            }
            { print $1, place($2), place($3), $4 }')
    done
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

for placed in bunny:0,0.024,0:0.358 suzi:0,0,0.016:0.291 pmndrs:0,0,0:1.44; do
    model=${placed%%:*} frame=${placed#*:}
    for kind in layers single; do
        case $kind in
        layers) bake "$model-layers" "$assets/$model.glb" --layered --texels 200000 ;;
        single) bake "$model-single" "$assets/$model.glb" --single --spp 4 ;;
        esac
        usual_views "$model-$kind" "$assets/$model.glb" "${frame%:*}" "${frame#*:}"
    done
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
