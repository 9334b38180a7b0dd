#!/usr/bin/env bash
# clang-tidy over all sources but the tests' that ninja has built. A source whose text and headers have
# passed once is not looked at again. Usage: lint.sh BUILD_FOLDER JOBS
set -euo pipefail

build=$1
jobs=$2
root=$(pwd)
stamps=$build/lint
mkdir -p "$stamps"

# Lines "key source": the key covers the source, the project's headers it includes, and the settings.
keys() {
  local settings
  settings=$(cat .clang-tidy <(clang-tidy --version) | sha256sum)
  ninja -C "$build" -t deps | awk -v root="$root/" '
    /: #deps/ { list = ""; next }
    /^ / { path = $1; sub(/^(\.\.\/)+/, root, path)
           if (index(path, root) == 1) list = list " " substr(path, length(root) + 1); next }
    /^$/ { if (list != "") print list; list = "" }' |
    grep -E '^ (libwavelet|libbrdf|libprobe|renderer|tools)/[^ ]*\.cpp' | sort -u |
    while read -r source headers; do
      # shellcheck disable=SC2086
      echo "$({ echo "$settings"; cat $source $headers; } | sha256sum | cut -c1-32) $source"
    done
}

lint_one() {
  local key=$1 source=$2 report
  [ ! -e "$stamps/$key" ] || return 0
  if report=$(clang-tidy -p "$build" --quiet "$source" 2>/dev/null); then
    touch "$stamps/$key"
  else
    printf '%s\n' "$report"
    return 1
  fi
}
export -f lint_one
export build stamps

keys | sort -u -k2 | xargs -P "$jobs" -L 1 bash -c 'lint_one "$0" "$1"'
