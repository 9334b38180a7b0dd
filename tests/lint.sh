#!/usr/bin/env bash
# clang-tidy over the libraries' and programs' sources that ninja has built. A source that has passed is not
# looked at again until it, a header it includes or the settings change. As a full round takes long, it
# ends after LINT_SECONDS (default 200; 0 = no limit), the sources that changed last coming first; what
# is left is counted and comes next time. Usage: lint.sh BUILD_FOLDER JOBS
set -euo pipefail

build=$1
jobs=$2
root=$(pwd)
stamps=$build/lint
seconds=${LINT_SECONDS:-200}
deadline=$(($(date +%s) + seconds))
left=$(mktemp)
trap 'rm -f "$left"' EXIT
mkdir -p "$stamps"
# clang-tidy cannot read the compiler's precompiled headers.
sed 's# -Winvalid-pch -include [^ ]*cmake_pch\.hxx##' "$build/compile_commands.json" >"$stamps/compile_commands.json"

# Lines "source header…" with paths from the root, the project's own files only.
dependencies() {
  ninja -C "$build" -t deps | awk -v root="$root/" '
    /: #deps/ { list = ""; next }
    /^ / { path = $1; sub(/^(\.\.\/)+/, root, path)
           if (index(path, root) == 1) list = list " " substr(path, length(root) + 1); next }
    /^$/ { if (list != "") print list; list = "" }' |
    grep -E '^ (libwavelet|libbrdf|libprobe|renderer|tools)/[^ ]*\.cpp' | sort -u
}

# Lines "key source"; the key covers all that the result depends on.
keys() {
  local settings
  settings=$(cat .clang-tidy <(clang-tidy --version) | sha256sum)
  dependencies | while read -r -a files; do
    [ -e "${files[0]}" ] || continue
    echo "$({ echo "$settings"; cat "${files[@]}" 2>/dev/null; } | sha256sum | cut -c1-32) ${files[0]}"
  done | sort -u -k2,2
}

# Sources, those that changed last first.
by_age() {
  { git status --porcelain | cut -c4-; git log --format= --name-only; } 2>/dev/null |
    awk 'NF && !seen[$0]++' || true
}

lint_one() {
  local key=$1 source=$2 report
  [ ! -e "$stamps/$key" ] || return 0
  if [ "$seconds" -gt 0 ] && [ "$(date +%s)" -ge "$deadline" ]; then
    echo "$source" >>"$left"
  elif report=$(clang-tidy -p "$stamps" --quiet "$source" 2>/dev/null); then
    touch "$stamps/$key"
  else
    printf '%s\n' "$report"
    return 1
  fi
}
export -f lint_one
export build stamps seconds deadline left

code=0
# shellcheck disable=SC2016
awk 'FILENAME == ARGV[1] { age[$0] = FNR; next } { print ($2 in age ? age[$2] : 1e9), $0 }' \
  <(by_age) <(keys) | sort -n -k1,1 -s | cut -d' ' -f2- |
  xargs -r -P "$jobs" -L 1 bash -c 'lint_one "$0" "$1"' || code=1
[ ! -s "$left" ] || echo "lint: $(wc -l <"$left") sources left for the next time (LINT_SECONDS=$seconds)"
exit $code
