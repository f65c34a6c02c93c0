#!/usr/bin/env bash
# Measures everything in tests/regression/results.csv again (a few minutes) and says what changed.
#   tools/lab/scripts/regression.sh
source "$(dirname "${BASH_SOURCE[0]}")/../../common.sh"
build build regression
build/bin/regression build/results.csv
# Sizes and errors must not get worse; speeds are for people.
awk -F, 'NR == FNR { if (FNR > 1) { bytes[$1 $2 $3] = $4; psnr[$1 $2 $3] = $6 } next }
    FNR > 1 && ($1 $2 $3) in bytes {
        if ($4 > bytes[$1 $2 $3] * 1.002) { print "larger: " $0 " (was " bytes[$1 $2 $3] ")"; bad = 1 }
        if ($6 < psnr[$1 $2 $3] - 0.02) { print "lower PSNR: " $0 " (was " psnr[$1 $2 $3] ")"; bad = 1 } }
    END { exit bad }' tests/regression/results.csv build/results.csv ||
    stop "worse than tests/regression/results.csv (see above); new figures are in build/results.csv"
say "No worse. New figures: build/results.csv"
