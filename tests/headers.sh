#!/usr/bin/env bash
# Every public header compiles when it is the only one included, but for Eigen, which is parsed once for all of them.
# Usage: headers.sh JOBS
set -euo pipefail
mkdir -p build
flags="-std=c++20 -Wall -Wextra -Werror -isystem /usr/include/eigen3"
for library in libwavelet libbrdf libprobe renderer; do
  flags="$flags -I $library/include"
done
# shellcheck disable=SC2086
printf '#include <Eigen/Core>\n#include <Eigen/Geometry>\n' | clang++ $flags -x c++-header - -o build/eigen.pch
# shellcheck disable=SC2086
find lib*/include renderer/include -name '*.h' -print0 | sort -z |
  xargs -0 -n 1 -P "$1" clang++ $flags -include-pch build/eigen.pch -Wno-pragma-once-outside-header -fsyntax-only -x c++
