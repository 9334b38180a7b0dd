# shellcheck shell=bash
# Shared by the tests of the programs. Usage in a test: source lib.sh "$1"
# $1 is the folder of the programs; the test runs in a folder of its own, $log beside it.
set -u
export LC_ALL=C
bin=$1
log=$(mktemp -d)
work=$log/work
mkdir "$work"
trap 'rm -rf "$log"' EXIT
cd "$work" || exit 1
failures=0

fail() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}

# check MESSAGE COMMAND…: the command must succeed.
check() {
  local message=$1
  shift
  "$@" >/dev/null 2>&1 || fail "$message: $*"
}

# same A B: two files must be equal.
same() { cmp -s "$1" "$2" || fail "$1 and $2 differ"; }

# expect CODE TOOL ARGUMENTS…: the exit code; stdout is left in $log/out, stderr in $log/err. From code 2
# on, stdout must be empty and stderr one line that begins with the tool's name.
expect() {
  local wanted=$1 tool=$2 code=0
  shift 2
  timeout 60 "$bin/$tool" "$@" >"$log/out" 2>"$log/err" || code=$?
  [ "$code" -eq "$wanted" ] || fail "$tool $*: exit code $code, not $wanted: $(head -c 300 "$log/err")"
  [ "$code" -ge 2 ] || return 0
  [ "$(wc -l <"$log/err")" -eq 1 ] || fail "$tool $*: not one line on stderr: $(cat "$log/err")"
  grep -q "^$tool: " "$log/err" || fail "$tool $*: stderr does not begin with the tool's name"
  [ ! -s "$log/out" ] || fail "$tool $*: wrote to stdout and failed"
}

# says WORDS: of the last command's stderr; prints WORDS: of its stdout.
says() { grep -qF -- "$1" "$log/err" || fail "stderr lacks '$1': $(cat "$log/err")"; }
prints() { grep -qF -- "$1" "$log/out" || fail "stdout lacks '$1': $(head -c 500 "$log/out")"; }

# leaves NAMES…: these are all files in the folder.
leaves() {
  local found wanted
  found=$(find . -mindepth 1 -maxdepth 1 -printf '%P\n' | sort | tr '\n' ' ')
  wanted=$([ $# -eq 0 ] || printf '%s\n' "$@" | sort | tr '\n' ' ')
  [ "$found" = "$wanted" ] || fail "the folder holds '$found', not '$wanted'"
}

# refuses_bad_input OUTPUT TOOL ARGUMENTS…: @ among the arguments stands for the input. Every kind of file
# that no tool can read gives exit code 3 and no output.
refuses_bad_input() {
  local output=$1 tool=$2 kind
  shift 2
  mkdir bad
  mkdir bad/folder
  mkfifo bad/fifo
  : >bad/empty
  printf 'Lorem ipsum dolor sit amet, consectetur adipiscing elit.\n' >bad/text
  head -c 4096 /dev/zero >bad/zeros
  for kind in missing folder fifo empty text zeros; do
    expect 3 "$tool" "${@/@/bad/$kind}"
    says "bad/$kind"
    [ ! -e "$output" ] || fail "$tool left $output for $kind"
  done
  rm -r bad
}

# refuses_bad_output EXTENSION TOOL ARGUMENTS…: @ stands for the output. Exit code 4 and no output.
refuses_bad_output() {
  local extension=$1 tool=$2
  shift 2
  mkdir "folder$extension"
  expect 4 "$tool" "${@/@/folder$extension}"
  rmdir "folder$extension" || fail "$tool wrote into a folder"
  expect 4 "$tool" "${@/@/missing/out$extension}"
  mkfifo "fifo$extension"
  expect 4 "$tool" "${@/@/fifo$extension}"
  [ -p "fifo$extension" ] || fail "$tool replaced a FIFO"
  rm "fifo$extension"
  full_disk "$tool" "${@/@/full$extension}"
  [ ! -e "full$extension" ] || fail "$tool left a half-written file"
}

# full_disk TOOL ARGUMENTS…: files of a KiB at most can be written; exit code 4.
# shellcheck disable=SC2030,SC2031 # the subshell counts for itself
full_disk() { (
  ulimit -f 1
  failures=0
  expect 4 "$@"
  exit "$failures"
) || failures=$((failures + 1)); }

# patch FILE OFFSET BYTES: writes printf-escaped bytes into a file.
patch() { printf '%b' "$3" | dd of="$1" bs=1 seek="$2" conv=notrunc status=none; }

finish() {
  [ "$failures" -eq 0 ] || { echo "$failures failures"; exit 1; }
}
