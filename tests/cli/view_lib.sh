# shellcheck shell=bash disable=SC2154 # lib.sh sets bin and log
# Shared by the tests of haarview; after lib.sh.

[ -x "$bin/haarview" ] || { echo "skipped: haarview was not built"; exit 77; }

# needs_egl FILE…: skips the test, saying so, where haarview cannot draw without a screen.
needs_egl() {
  if ! "$bin/haarview" "$@" --frame probe.exr -q >"$log/out" 2>"$log/err"; then
    grep -q "^haarview: EGL: " "$log/err" || { cat "$log/err"; exit 1; }
    echo "skipped: $(cat "$log/err")"
    exit 77
  fi
  rm probe.exr
}

# number EXPRESSION: it must hold; errors prints the relative errors: the frame's, then each level's.
number() { awk "BEGIN { exit !($1) }" || fail "not so: $1"; }
errors() { sed -n 's/.*"relative_rms": *\([0-9.e+-]*\).*/\1/p' "$log/out"; }
