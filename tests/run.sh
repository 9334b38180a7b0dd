#!/usr/bin/env bash
# Everything that must hold: builds build/release and checks format, scripts, headers, lint and tests.
# Installs missing Debian packages first. Usage: bash tests/run.sh [ctest arguments]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

jobs=$(nproc)
failed=""

# check NAME COMMAND…: goes on after a failure, but remembers it.
check() {
  local name=$1 start=$SECONDS
  shift
  if "$@"; then
    echo "== $name: ok ($((SECONDS - start)) s)"
  else
    echo "== $name: FAILED"
    failed="$failed $name"
  fi
}

check_format() {
  find libwavelet libbrdf libprobe renderer tools tests -name '*.h' -o -name '*.cpp' | sort |
    xargs clang-format --dry-run -Werror
}

check_scripts() {
  find pipelines tests .ci -name '*.sh' -not -path '*/out/*' -print0 | sort -z | xargs -0 shellcheck .ci/run
}

bash pipelines/install_packages.sh check
cmake --preset release
cmake --build build/release -j "$jobs"
check format check_format
check scripts check_scripts
check headers bash tests/headers.sh "$jobs"
check lint bash tests/lint.sh "$jobs"
check tests ctest --test-dir build/release --output-on-failure -j "$jobs" "$@"

if [ -n "$failed" ]; then
  echo "FAILED:$failed"
  exit 1
fi
