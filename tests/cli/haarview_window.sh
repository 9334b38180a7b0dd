#!/usr/bin/env bash
# haarview's window on a virtual screen: orbit, screenshots, two panes, and files that are rewritten.
source "$(dirname "$0")/lib.sh" "$1"
source "$(dirname "$0")/view_lib.sh"

"$bin/brdfsynth" --model ggx --diffuse 0.2,0.1,0.05 --roughness 0.15 -q -o brdf.binary >/dev/null
"$bin/brdfsynth" --model ggx --diffuse 0.05,0.1,0.4 --roughness 0.4 -q -o other.binary >/dev/null
for name in brdf other; do
  "$bin/brdf2maps" $name.binary -q --size 64 --theta 16 --conservation-tolerance 1 -o $name.haar >/dev/null
done
"$bin/probesynth" --scene studio --size 32 -q -o studio.hdr >/dev/null
inputs="brdf.binary brdf.haar other.binary other.haar studio.hdr"

# errors without a screen
unset DISPLAY WAYLAND_DISPLAY
expect 4 haarview brdf.haar
has_window || finish
says "haarview: window: cannot be opened"
for wrong in "--turn 30" "--frames 0" "--frames 2 --screenshot picture.jpg" "--screenshot picture.png" \
  "--frames 2 --reloads 1" "--image picture.png --watch" "--compare"; do
  # shellcheck disable=SC2086
  expect 2 haarview brdf.haar $wrong
done
expect 4 haarview brdf.haar --frames 1 --screenshot nowhere/picture.png
expect 2 haarview brdf.haar --environment
# shellcheck disable=SC2086
leaves $inputs

start_screen || finish

# pixels A.png B.png: sets $brightness, the mean code of A, and $difference, the mean of |A - B|; codes up to 255
pixels() {
  read -r brightness difference < <(python3 - "$@" <<'END'
import struct, sys, zlib

def codes(path):
    data = open(path, "rb").read()
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, colours = struct.unpack(">IIBB", body[:10])
            assert (depth, colours) == (8, 2)
        packed += body if kind == b"IDAT" else b""
        at += size + 12
    raw, row = zlib.decompress(packed), bytearray(3 * width)
    rows = bytearray()
    for y in range(height):
        line = raw[y * (3 * width + 1):(y + 1) * (3 * width + 1)]
        above, row = row, bytearray(line[1:])
        for x in range(3 * width):
            a = row[x - 3] if x >= 3 else 0
            c = above[x - 3] if x >= 3 else 0
            b, p = above[x], a + above[x] - c
            paeth = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            row[x] = (row[x] + (0, a, b, (a + b) // 2, paeth)[line[0]]) & 255
        rows += row
    return rows

a, b = codes(sys.argv[1]), codes(sys.argv[2])
print(sum(a) / len(a), sum(abs(x - y) for x, y in zip(a, b)) / len(a) if len(a) == len(b) else 255)
END
)
}

# saved NAME ARGUMENTS…: a screenshot of the window without its controls
saved() {
  local name=$1
  shift
  expect 0 haarview "$@" --size 120x90 --no-panel --screenshot "$name.png"
}

saved still brdf.haar --frames 1
prints "frames"
saved turned brdf.haar --frames 3 --turn 40
saved again brdf.haar --frames 3 --turn 40
same turned.png again.png
saved round brdf.haar --frames 2 --turn 360
saved other other.haar --frames 1
saved beside brdf.haar --beside other.haar --frames 1
saved around brdf.haar --frames 1 --probe studio.hdr --light-level 5
expect 0 haarview brdf.haar --size 120x90 --image frame.png
expect 0 haarview brdf.haar --size 120x90 --probe studio.hdr --light-level 5 --image frame_around.png
expect 0 haarview brdf.haar --size 400x300 --frames 2 --screenshot panel.png --json
if has python3; then
  valid_json
  for kind in "still frame" "around frame_around"; do
    # shellcheck disable=SC2086
    pixels ${kind/ /.png }.png
    number "$brightness > 10 && $difference < 0.5"
  done
  pixels round.png frame.png
  number "$difference < 0.5"
  for another in turned other beside around; do
    pixels $another.png still.png
    number "$brightness > 10 && $difference > 1"
  done
fi

# watched WAY NAME: a file is rewritten in that way repeatedly until the window has tried to reload it once
watched() {
  cp brdf.haar watched.haar
  timeout 60 "$bin/haarview" watched.haar --size 120x90 --no-panel --watch --reloads 1 --frames 1 --json \
    --screenshot "$2.png" >"$log/out" 2>"$log/err" &
  local window=$!
  while sleep 1 && kill -0 "$window" 2>/dev/null; do "$1" watched.haar; done
  wait "$window" || fail "haarview --watch: exit code $?: $(head -c 300 "$log/err")"
}
replaced() { cp other.haar new.haar && mv new.haar "$1"; }
rewritten() { cat other.haar >"$1"; }
half_written() { head -c 3000 other.haar >"$1"; }
watched replaced reloaded
same reloaded.png other.png
prints '"reloads": 1'
says "watched.haar was reloaded"
watched rewritten reloaded
same reloaded.png other.png
watched half_written kept
same kept.png still.png
prints '"refused_reloads": 1'
says "watched.haar"
says "the previous version is kept"

# shellcheck disable=SC2086
leaves $inputs still.png turned.png again.png round.png other.png beside.png around.png frame.png frame_around.png \
  panel.png watched.haar reloaded.png kept.png
finish
