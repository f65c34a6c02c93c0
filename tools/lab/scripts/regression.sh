#!/usr/bin/env bash
# Measures everything in tests/regression/results.csv again, in a few minutes, and reports what got
# worse.
#   tools/lab/scripts/regression.sh
source "$(dirname "${BASH_SOURCE[0]}")/../../common.sh"
build build regression -- -DTESSERA_TESTS=ON
build/bin/regression build/results.csv
# Fails if sizes or errors get worse. It does not check speeds, which vary from run to run.
awk -F, 'NR == FNR { if (FNR > 1) { bytes[$1 $2 $3] = $4; psnr[$1 $2 $3] = $6 } next }
    FNR > 1 && ($1 $2 $3) in bytes {
        if ($4 > bytes[$1 $2 $3] * 1.002) { print "larger: " $0 " (was " bytes[$1 $2 $3] ")"; bad = 1 }
        if ($6 < psnr[$1 $2 $3] - 0.02) { print "lower PSNR: " $0 " (was " psnr[$1 $2 $3] ")"; bad = 1 } }
    END { exit bad }' tests/regression/results.csv build/results.csv ||
    stop "results are worse than tests/regression/results.csv (see above); the new ones are in build/results.csv"
say "No result is worse. The new results are in build/results.csv"
