#!/usr/bin/env bash
# haarview of transfer: frames compared with haarrelight apply, level by level, and errors.
source "$(dirname "$0")/lib.sh" "$1"
source "$(dirname "$0")/view_lib.sh"

"$bin/brdfsynth" --model ggx --diffuse 0.2,0.1,0.05 -q -o brdf.binary >/dev/null
"$bin/brdf2maps" brdf.binary -q --size 64 --theta 16 --conservation-tolerance 1 -o brdf.haar >/dev/null
for light in studio sun-sky; do
  "$bin/probesynth" --scene $light --size 64 -q -o $light.hdr >/dev/null
done
"$bin/probe2maps" sun-sky.hdr -q --size 64 -o sun-sky.haar >/dev/null
cat >scene.json <<'END'
{ "film": {"width": 24, "height": 16},
  "camera": {"type": "perspective", "from": [0, 1.5, 6], "to": [0, 0, 0], "up": [0, 1, 0], "fov": 35},
  "light": {"probe": "studio.hdr", "rotate": 20},
  "materials": {"measured": {"brdf": "brdf.binary", "haar": "brdf.haar"}, "floor": {"lambert": [0.5, 0.5, 0.5]}},
  "objects": [{"type": "sphere", "center": [-0.8, 0, 0], "radius": 1, "material": "measured"},
              {"type": "sphere", "name": "ball", "center": [0.8, -0.5, 0.6], "radius": 0.5, "material": "floor"},
              {"type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "material": "floor"}] }
END
"$bin/haarrelight" build scene.json --vary light --resolution 64 -q -o light.haar >/dev/null
"$bin/haarrelight" build scene.json --vary object:ball --size 8x8 -q -o object.haar >/dev/null

needs_egl light.haar

# agrees CHANGE…: within 1 % of apply with the same change, with an error that decreases with the level
agrees() {
  "$bin/haarrelight" apply light.haar "$@" -q -o applied.exr >/dev/null
  expect 0 haarview light.haar "$@" --reference applied.exr --repeat 1 --json --frame frame.exr
  valid_json
  mapfile -t error < <(errors)
  [ "${#error[@]}" = 8 ] || fail "not seven levels: $(cat "$log/out")"
  number "${error[0]} <= 0.01 && ${error[0]} == ${error[7]}"
  number "${error[1]} > 0.1 && ${error[3]} < ${error[1]} && ${error[5]} < ${error[3]}"
}
agrees
agrees --rotate 70,0,0
cp frame.exr turned.exr
agrees --rotate=-30,20,200 --light sun-sky.hdr
agrees --probe sun-sky.haar
agrees
cmp -s frame.exr turned.exr && fail "--rotate changes nothing"

# --compare computes the same picture; that of another rotation differs
expect 0 haarview light.haar --rotate 70,0,0 --compare --repeat 1 --json --frame frame.exr
mapfile -t error < <(errors)
number "${error[0]} <= 0.01"
same frame.exr turned.exr
expect 0 haarview light.haar --rotate 160,0,0 --reference turned.exr --repeat 1 --json --frame frame.exr
mapfile -t error < <(errors)
number "${error[0]} > 0.1"

# --level has the error that the comparison reports, with fewer accesses
expect 0 haarview light.haar --level 2 --compare --repeat 1 --json --frame frame.exr
mapfile -t error < <(errors)
number "${error[0]} == ${error[3]}"
mapfile -t accesses < <(sed -n 's/.*"accesses": *\([0-9.e+-]*\).*/\1/p' "$log/out")
number "${accesses[0]} < ${accesses[2]} && ${accesses[2]} < ${accesses[4]} && ${accesses[4]} < ${accesses[6]}"

# without background; packed, elsewhere; as a .png
sed 's/"rotate": 20/"rotate": 20, "background": false/' scene.json >bare.json
"$bin/haarrelight" build bare.json --resolution 64 --pack -q -o packed.haar >/dev/null
mkdir elsewhere
mv packed.haar elsewhere
expect 0 haarview elsewhere/packed.haar --scene bare.json --compare --repeat 1 --json --frame frame.exr
mapfile -t error < <(errors)
number "${error[0]} <= 0.01"
expect 3 haarview elsewhere/packed.haar --frame frame.exr
expect 0 haarview light.haar --frame frame.png
rm -r elsewhere bare.json frame.png

# errors
expect 3 haarview object.haar --frame picture.exr
says "was built with --vary object:1; expected --vary light"
expect 2 haarview object.haar --frame picture.exr --rotate 10,0,0
says "was built with --vary object:1, not light"
for option in "--size 8x8" "--environment" "--light-direction 0,0,1" "--html page.html"; do
  # shellcheck disable=SC2086
  expect 2 haarview light.haar --frame picture.exr $option
  says "does not apply to transfer"
done
expect 2 haarview light.haar --frame picture.exr --level 14
expect 2 haarview light.haar --frame picture.exr --rotate 10
for option in "--rotate 1,2,3" "--scene scene.json"; do
  # shellcheck disable=SC2086
  expect 2 haarview brdf.haar --frame picture.exr $option
  says "applies to transfer"
done
expect 3 haarview light.haar --scene missing.json --frame picture.exr
sed 's/"rotate": 20/"rotate": 21/' scene.json >other.json
expect 3 haarview light.haar --scene other.json --frame picture.exr
says "is not the scene"
expect 3 haarview light.haar --light brdf.haar --frame picture.exr
expect 3 haarview light.haar --reference missing.exr --frame picture.exr
head -c 5000 light.haar >cut.haar
expect 3 haarview cut.haar --scene scene.json --frame picture.exr
rm cut.haar other.json

# the window, where there is a screen: --turn leads to what --rotate shows at once
unset DISPLAY WAYLAND_DISPLAY
expect 2 haarview light.haar --watch
expect 4 haarview light.haar --frames 1
says "haarview: window: "
files="applied.exr brdf.binary brdf.haar frame.exr light.haar object.haar scene.json studio.hdr sun-sky.haar sun-sky.hdr turned.exr"
if has_window && start_screen; then
  expect 0 haarview light.haar --no-panel --frames 1 --screenshot still.png
  expect 0 haarview light.haar --no-panel --frames 2 --turn 70 --screenshot turned.png
  expect 0 haarview light.haar --no-panel --frames 1 --rotate 70,0,0 --screenshot rotated.png
  expect 0 haarview light.haar --frames 1 --screenshot panel.png --json
  valid_json
  same turned.png rotated.png
  cmp -s turned.png still.png && fail "--turn changes nothing"
  cmp -s panel.png still.png && fail "there is no panel"
  files="$files still.png turned.png rotated.png panel.png"
fi
# shellcheck disable=SC2086
leaves $files
finish
