#!/usr/bin/env bash
# Fails if clang-format would change a source of the project. --fix formats the sources.
#   tests/check_format.sh [CLANG-FORMAT] [--fix]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
format=${1:-clang-format}
how=(--dry-run --Werror)
[ "${2:-}" != "--fix" ] || how=(-i)

# Without git, for instance in an archive of the sources, the project's files are not known.
git rev-parse --is-inside-work-tree >/dev/null 2>&1 || exit 77
git ls-files -z -- '*.h' '*.cpp' '*.inl' '*.c' | xargs -0 "$format" "${how[@]}"
