#!/usr/bin/env bash
# clang-tidy over every source of the libraries, programs and tests. All sources of a target are read as one, which
# parses their headers once. A target that has passed is read again when its sources, a header or the settings change.
# As a full round takes long, it ends after LINT_SECONDS (default 200; 0 = no limit); what is left is counted and comes next time.
# Usage: lint.sh JOBS
set -euo pipefail

jobs=$1
limit=${LINT_SECONDS:-200}
deadline=$(($(date +%s) + limit))
left=$(mktemp)
trap 'rm -f "$left"' EXIT
build=build/lint
stamps=$build/passed
mkdir -p "$stamps"
# clang-tidy cannot read the compiler's precompiled headers.
cmake -S . -B $build -G Ninja -DHAARLIGHT_UNITY_BATCH=0 -DHAARLIGHT_PRECOMPILE=OFF >/dev/null

# The units that a compiler would be given.
units() {
  sed -n 's/^ *"file": "\(.*\)",\{0,1\}$/\1/p' $build/compile_commands.json | awk '{ print ($0 ~ "/tests/"), $0 }' | sort -u | cut -d' ' -f2-
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
  if [ "$limit" -gt 0 ] && [ "$(date +%s)" -ge "$deadline" ]; then
    echo "$unit" >>"$left"
  elif report=$(clang-tidy -p "$build" --quiet "$unit" 2>/dev/null); then
    touch "$stamps/$key"
  else
    printf '%s\n' "$report"
    return 1
  fi
}
export -f lint_unit
export build stamps shared limit deadline left

code=0
# shellcheck disable=SC2016
units | xargs -r -P "$jobs" -I{} bash -c 'lint_unit "$1"' lint_unit {} || code=1
[ ! -s "$left" ] || echo "lint: $(wc -l <"$left") units left for the next time (LINT_SECONDS=$limit)"
exit $code
