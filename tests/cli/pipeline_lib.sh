# shellcheck shell=bash
# Shared by the tests of pipelines/Makefile. Usage: source pipeline_lib.sh PROGRAMS_FOLDER SOURCE_FOLDER
source "$(dirname "$0")/lib.sh" "$1"
pipelines=$2/pipelines
unset MAKEFLAGS MAKELEVEL MFLAGS

# Small sources: a.binary, b.binary.zst, x.hdr, y.hdr.
make_sources() {
  "$bin/brdfsynth" --model ggx -q -o a.binary >/dev/null
  "$bin/brdfsynth" --model ward -q -o b.binary >/dev/null
  zstd -q --rm b.binary
  "$bin/probesynth" --scene studio --size 64 -q -o x.hdr >/dev/null
  "$bin/probesynth" --scene sun-sky --size 64 -q -o y.hdr >/dev/null
}

small=(BIN="$bin" SPP=1 RENDER_FLAGS="--size 16x16" PROBE_FLAGS="--size 64"
  BRDF_FLAGS="--size 32 --theta 8 --conservation-tolerance 1"
  BRDF_TABLE_FLAGS="--size 16 --theta 4 --roll 8 --conservation-tolerance 1"
  PROBE_TABLE_FLAGS="--size 16 --orientations 4")

# chain ARGUMENT…: make must succeed; stdout in $log/out, stderr in $log/err.
chain() {
  make --no-print-directory -C "$pipelines" "${small[@]}" "$@" >"$log/out" 2>"$log/err" ||
    fail "make $*: $(cat "$log/out" "$log/err")"
}

# runs PROGRAM COUNT MESSAGE: so many times did the last make call the program.
runs() {
  [ "$(grep -c "/$1 " "$log/out")" -eq "$2" ] || fail "$3: not $2 calls of $1: $(cat "$log/out")"
}

# makes MESSAGE BRDF2MAPS PROBE2MAPS HAARRENDER: the calls of the last make.
makes() {
  runs brdf2maps "$2" "$1"
  runs probe2maps "$3" "$1"
  runs haarrender "$4" "$1"
}

# refuses WORDS ARGUMENT…: make fails with one line that contains the words, and prints nothing else.
refuses() {
  local words=$1
  shift
  make --no-print-directory -C "$pipelines" "${small[@]}" "$@" >"$log/out" 2>"$log/err" && fail "make $*: accepted"
  [ "$(wc -l <"$log/err")" -eq 1 ] || fail "make $*: not one line: $(cat "$log/err")"
  [ ! -s "$log/out" ] || fail "make $*: prints $(cat "$log/out")"
  says "$words"
}
