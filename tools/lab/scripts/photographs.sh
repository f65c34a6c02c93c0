#!/bin/sh
# Fits textures to photographs and draws photographs that were kept out: the tables of
# tests/regression/photographs.md.
#   tools/lab/scripts/photographs.sh TESSERA SHARED OUT
# SHARED holds the folder photos. Needs NumPy and Pillow for sets with errors. Files that OUT already has are used
# again. Takes about half an hour on two cores.
set -eu
tool=$1 photos=$2/photos out=$3
scripts=$(dirname "$0")
filter='--pixel-filter blackman-harris'
mkdir -p "$out"

# Fits, draws and compares: fit NAME SET FOLDER options...
fit() {
    name=$1 set=$2 folder=$3
    shift 3
    [ -e "$out/$name.tess" ] || "$tool" fit "$folder/transforms_train.json" --mesh "$folder/$set.obj" \
        -o "$out/$name.tess" $filter --json "$@" > "$out/$name.json"
    "$tool" render "$out/$name.tess" --cameras "$photos/$set/transforms_test.json" -o "$out/$name" --rays 16 $filter -q
    printf '%s %s ' "$name" "$(stat -c %s "$out/$name.tess")"
    "$tool" compare "$photos/$set/transforms_test.json" "$out/$name" | grep '^mean'
}

# Trial fits choose the same smoothness for all files of a set, so the others skip them.
fit suzi-70 suzi "$photos/suzi" --quality 70
fit pmndrs-70 pmndrs "$photos/pmndrs" --quality 70
for set in suzi pmndrs; do
    smoothness=0.25
    [ $set = suzi ] || smoothness=4
    for kind in wrong poses exposure jpeg mesh; do
        [ -e "$out/$set-set-$kind" ] || ${PYTHON:-python3} "$scripts/photograph_errors.py" "$photos/$set" "$kind" "$out/$set-set-$kind"
        fit "$set-$kind" "$set" "$out/$set-set-$kind" --quality 70 --smoothness $smoothness
    done
    for quality in 58 85; do
        fit "$set-$quality" "$set" "$photos/$set" --quality "$quality" --smoothness $smoothness
    done
done
