#!/usr/bin/env bash
# Fails unless clang-format would leave all our sources as they are.
#   tests/check_format.sh [CLANG-FORMAT] [--fix]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
format=${1:-clang-format}
how=(--dry-run --Werror)
[ "${2:-}" != "--fix" ] || how=(-i)

# Of a folder without git (an archive of the sources) nobody can tell what is ours.
git rev-parse --is-inside-work-tree >/dev/null 2>&1 || exit 77
git ls-files -z -- '*.h' '*.cpp' '*.inl' '*.c' | xargs -0 "$format" "${how[@]}"
