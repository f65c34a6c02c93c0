#!/usr/bin/env bash
# Measures what each coding tool is worth (half an hour on two cores) and writes it to tests/regression/ablation.md.
#   tools/scripts/ablation.sh [PEERS.rgb]      the rivals' texture, composed_128x64x32x32.rgb.zst unpacked
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
[ $# -le 1 ] || stop "usage: tools/scripts/ablation.sh [composed_128x64x32x32.rgb]"
[ $# -eq 0 ] || [ -r "$1" ] || stop "cannot read $1"
build build ablation
build/bin/ablation tests/regression/ablation.md "$@"
