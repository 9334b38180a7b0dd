#!/usr/bin/env bash
# clang-tidy over every source of the libraries, programs and tests. All sources of a target are read as one, which
# parses their headers once. A target that has passed is read again when its sources, a header or the settings change.
# Usage: lint.sh JOBS
set -euo pipefail

jobs=$1
build=build/lint
stamps=$build/passed
mkdir -p "$stamps"
# clang-tidy cannot read the compiler's precompiled headers.
cmake -S . -B $build -G Ninja -DHAARLIGHT_UNITY_BATCH=0 -DHAARLIGHT_PRECOMPILE=OFF -DHAARLIGHT_CHECKED=OFF >/dev/null

# The units that a compiler would be given.
units() {
  sed -n 's/^ *"file": "\(.*\)",\{0,1\}$/\1/p' $build/compile_commands.json | sort -u
}

shared=$({
  cat .clang-tidy "$build/compile_commands.json"
  clang-tidy --version
  find libwavelet libbrdf libprobe renderer tools tests -name '*.h' -print0 | sort -z | xargs -0 cat
} | sha256sum)

lint_unit() {
  local unit=$1 key report
  key=$({
    echo "$shared"
    cat "$unit"
    sed -n 's/^#include "\(.*\.cpp\)"$/\1/p' "$unit" | xargs -r -d '\n' cat
  } | sha256sum | cut -c1-32)
  [ ! -e "$stamps/$key" ] || return 0
  if report=$(clang-tidy -p "$build" --quiet "$unit" 2>/dev/null); then
    touch "$stamps/$key"
  else
    printf '%s\n' "$report"
    return 1
  fi
}
export -f lint_unit
export build stamps shared

# shellcheck disable=SC2016
units | xargs -r -P "$jobs" -I{} bash -c 'lint_unit "$1"' lint_unit {}
