# shellcheck shell=bash disable=SC2154 # lib.sh sets bin and log
# Shared by the tests of haarview; after lib.sh.

[ -x "$bin/haarview" ] || { skip "haarview was not built"; finish; }

# needs_egl FILE…: skips the test, saying so, where haarview cannot draw without a screen.
needs_egl() {
  if ! "$bin/haarview" "$@" --frame probe.exr -q >"$log/out" 2>"$log/err"; then
    grep -q "^haarview: EGL: " "$log/err" || { cat "$log/err"; exit 1; }
    skip "$(cat "$log/err")"
    finish
  fi
  rm probe.exr
}

# errors prints the relative errors: the frame's, then each level's.
errors() { sed -n 's/.*"relative_rms": *\([0-9.e+-]*\).*/\1/p' "$log/out"; }

# has_window: whether this build of haarview opens a window; the last command has tried to without a screen.
has_window() {
  ! grep -q "left out of this build" "$log/err" || { skip "haarview was built without a window"; return 1; }
}

# start_screen: a virtual screen of 800 x 600 pixels, until the test ends.
start_screen() {
  local display
  has Xvfb || return 1
  mkfifo "$log/display"
  Xvfb -displayfd 3 -screen 0 800x600x24 -nolisten tcp 3<>"$log/display" >/dev/null 2>&1 &
  screen=$!
  trap 'kill "$screen" 2>/dev/null; rm -rf "$log"' EXIT
  read -r -t 30 display <"$log/display" || { skip "Xvfb does not start"; return 1; }
  export DISPLAY=:$display
}
