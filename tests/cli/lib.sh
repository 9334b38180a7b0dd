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
skipped=
tools="brdfsynth probesynth brdf2maps probe2maps maps2haar haarinfo haardiff haarprod haarrender haarrelight haarsheet haarbench"
[ ! -x "$bin/haarview" ] || tools="$tools haarview"

fail() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}

# skip REASON: a part of the test cannot run on this machine. ctest then reports the whole test as skipped,
# although its other parts have passed.
skip() {
  [[ $skipped == *"<$*>"* ]] || echo "SKIPPED: $*"
  skipped="$skipped<$*>"
}

# has PROGRAM: whether it is installed; if not, that counts as skipped.
has() { command -v "$1" >/dev/null || { skip "$1 is not installed"; return 1; }; }

# check MESSAGE COMMAND…: the command must succeed.
check() {
  local message=$1
  shift
  "$@" >/dev/null 2>&1 || fail "$message: $*"
}

# valid_json: the last command's stdout is.
valid_json() { if has python3; then check "valid JSON" python3 -m json.tool "$log/out"; fi; }

# number EXPRESSION: of awk; it must hold.
number() { awk "BEGIN { exit !($1) }" || fail "not true: $1"; }

# value NAME: the first number of that name in the last command's JSON.
value() { sed -n "s/^ *\"$1\": \([-0-9.e+]*\|null\),\{0,1\}$/\1/p" "$log/out" | head -n 1; }

# worst_map: sets column and row to those of the worst map in the JSON of haardiff.
# shellcheck disable=SC2034 # the test uses them
worst_map() {
  column=$(sed -n '/worst_map/,$p' "$log/out" | sed -n 's/^ *"column": \([0-9]*\),$/\1/p' | head -n 1)
  row=$(sed -n '/worst_map/,$p' "$log/out" | sed -n 's/^ *"row": \([0-9]*\),$/\1/p' | head -n 1)
}

# make_brdf NAME ARGUMENTS…: NAME.binary, of brdfsynth's GGX model, and NAME.haar.
make_brdf() {
  "$bin/brdfsynth" --model ggx -q -o "$1.binary" "${@:2}" >/dev/null
  "$bin/brdf2maps" "$1.binary" -q --size 64 --theta 16 --conservation-tolerance 1 -o "$1.haar" >/dev/null
}

# make_probe SCENE: SCENE.hdr, of probesynth, and SCENE.haar.
make_probe() {
  "$bin/probesynth" --scene "$1" --size 64 -q -o "$1.hdr" >/dev/null
  "$bin/probe2maps" "$1.hdr" -q --size 64 -o "$1.haar" >/dev/null
}

# grey_scene FILE WIDTH HEIGHT LIGHT: a grey sphere; LIGHT are the members of the scene's light.
grey_scene() {
  cat >"$1" <<END
{ "film": {"width": $2, "height": $3},
  "camera": {"type": "perspective", "from": [0, 0.5, 6], "to": [0, 0, 0], "up": [0, 1, 0], "fov": 30},
  "light": {$4},
  "materials": {"floor": {"lambert": [0.5, 0.5, 0.5]}},
  "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "floor"}] }
END
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

# samplers_of FILE: those that haarrender --help, in the file, lists.
samplers_of() { sed -n 's/^ *--sampler \([a-z|-]*\).*/\1/p' "$1" | tr '|' ' '; }

# says TEXT: the last command's stderr contains it; prints TEXT: its stdout does.
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
  [ -z "$skipped" ] || exit 77
}

# pfm_probe NAME OTHERS BRIGHT: a PFM image of 8 x 4 pixels, all OTHERS but one BRIGHT; floats as escaped bytes.
pfm_probe() {
  { printf 'PF\n8 4\n-1.0\n'
    for i in {1..32}; do
      value=$2
      [ "$i" -eq 21 ] && value=$3
      printf '%b' "$value$value$value"
    done; } >"$1.pfm"
}
