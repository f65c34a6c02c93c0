#!/bin/sh
# Measures single pictures beside AVIF and JPEG XL: the BD-rates of tests/regression/rd_pictures.md.
#   tools/lab/scripts/rd_pictures.sh TESSERA SHARED OUT
# SHARED holds the folders peers (camera grids) and assets (models). Needs ffmpeg, zstd, python3 and
# the rivals. Takes an hour on two cores. The same command continues after an interrupt.
set -eu
tool=$(realpath "$1") shared=$(realpath "$2") out=$3
mkdir -p "$out"

# The view in the middle of a grid of 8-bit RGB views: middle NAME SIDE VIEWS_PER_SIDE
middle() {
    zstd -qdc "$shared/peers/$1_$2x$2x$3x$3.rgb.zst" | python3 -c '
import sys
side, views = int(sys.argv[1]), int(sys.argv[2])
texels, middle = sys.stdin.buffer.read(), views * views // 2
picture = b"".join(texels[3 * i : 3 * i + 3] for i in range(middle, len(texels) // 3, views * views))
sys.stdout.buffer.write(b"P6 %d %d 255\n" % (side, side) + picture)' "$2" "$3" > "$out/$1.ppm"
}
middle cotton 256 9
middle fish 256 5

# Two channels of a picture of 512x512, without its third: two_channels PNG OUT
two_channels() {
    ffmpeg -v error -y -i "$1" -f rawvideo -pix_fmt rgb24 - | python3 -c '
import sys
rgb = sys.stdin.buffer.read()
out = bytearray(len(rgb) // 3 * 2)
out[0::2], out[1::2] = rgb[0::3], rgb[1::3]
sys.stdout.buffer.write(out)' > "$2"
}
helmet=$shared/assets/models/FlightHelmet/FlightHelmet_Materials_
for part in LeatherParts:leather RubberWood:wood; do
    name=${part#*:}
    cp "$helmet${part%:*}Mat_BaseColor.png" "$out/$name.png"
    cp "$helmet${part%:*}Mat_Normal.png" "$out/$name-normal.png"
    two_channels "$out/$name-normal.png" "$out/$name-normal.ya"
done

cd "$out"
"$tool" rd cotton.ppm fish.ppm leather.png wood.png --pictures --efforts 4,3 --rivals avif,jxl \
    -o pictures --cache cache
"$tool" rd leather-normal.png wood-normal.png --pictures --rivals avif,avif:planes -o normals \
    --cache cache
"$tool" rd leather-normal.ya wood-normal.ya --size 512x512x1x1 --pictures --rivals avif:planes \
    -o normals-2 --cache cache
