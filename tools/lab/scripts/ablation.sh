#!/usr/bin/env bash
# Measures what each coding tool is worth, or each effort, and writes it to tests/regression/ablation.md.
#   tools/lab/scripts/ablation.sh [ARGUMENTS...]     see tests/regression/ablation.cpp; all tools: half an hour on two cores
source "$(dirname "${BASH_SOURCE[0]}")/../../common.sh"
build build ablation
build/bin/ablation tests/regression/ablation.md "$@"
