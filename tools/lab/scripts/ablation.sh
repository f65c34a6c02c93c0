#!/usr/bin/env bash
# Measures what each coding tool or each effort gains and writes the tables to
# tests/regression/ablation.md.
#   tools/lab/scripts/ablation.sh [ARGUMENTS...]     for the arguments see tests/regression/ablation.cpp
# Measuring all tools takes half an hour on two cores.
source "$(dirname "${BASH_SOURCE[0]}")/../../common.sh"
build build ablation
build/bin/ablation tests/regression/ablation.md "$@"
