#!/usr/bin/env bash
# haarview: frames compared with the same trees on the CPU, level by level, and errors.
source "$(dirname "$0")/lib.sh" "$1"
source "$(dirname "$0")/view_lib.sh"

"$bin/brdfsynth" --model ggx --diffuse 0.2,0.1,0.05 --roughness 0.15 -q -o brdf.binary >/dev/null
"$bin/brdf2maps" brdf.binary -q --size 128 --theta 32 --conservation-tolerance 1 -o brdf.haar >/dev/null
"$bin/brdf2maps" brdf.binary -q --size 16 --theta 8 --conservation-tolerance 1 --coefficients float \
  -o small.haar >/dev/null

# scene FILE SHAPE: two sets side by side, a matt floor, and one more object.
scene() {
  cat >"$1" <<END
{ "film": {"width": 96, "height": 64},
  "camera": {"type": "perspective", "from": [0, 1.5, 6], "to": [0, 0, 0], "up": [0, 1, 0], "fov": 35},
  "light": {"probe": "unused.hdr"},
  "materials": {"fine": {"haar": "brdf.haar"}, "coarse": {"haar": "small.haar"}, "floor": {"lambert": [0.5, 0.5, 0.5]}},
  "objects": [{"type": "sphere", "center": [-0.8, 0, 0], "radius": 1, "material": "fine"},
              {"type": "sphere", "center": [0.6, 0, 0], "radius": 0.5, "material": "coarse", "transform": {"scale": 2}},
              {"type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "material": "floor"}, $2] }
END
}
scene scene.json '{"type": "sphere", "center": [0, -0.7, 1.5], "radius": 0.3, "material": "fine"}'

needs_egl brdf.haar --size 8x8

# agrees FRAMES…: at full resolution within 1 % of the CPU, with an error that decreases with the level
agrees() {
  expect 0 haarview "$@" --level 13 --compare --repeat 1 --json --image frame.exr
  valid_json
  mapfile -t error < <(errors)
  number "${error[0]} <= 0.01 && ${error[-1]} <= 0.01"
  number "${error[1]} > 0.2 && ${error[5]} < ${error[1]} && ${error[7]} < ${error[5]}"
}
agrees brdf.haar --size 64x64 --light-direction 1,2,3
agrees brdf.haar --size 64x64 --light-position=-1,1,3
agrees scene.json --light-direction=-1,2,2
agrees scene.json --light-position 0.5,2,3 --irradiance 9,6,3

# with small pixels the level that they need is nearly the full resolution
expect 0 haarview brdf.haar --size 256x256 --compare --repeat 1 --json --image frame.exr
mapfile -t error < <(errors)
number "${error[0]} < 0.1 && ${error[0]} < ${error[5]}"

# environment: at the finest level within 2 % of a picture by product integrals, with an error that decreases and
# accesses that increase with the level
sed -i 's/"light": {.*}/"light": {"probe": "sky.hdr", "rotate": 70, "background": false}/' scene.json
"$bin/probesynth" --scene sun-sky --size 128 -q -o sky.hdr >/dev/null
"$bin/probe2maps" sky.hdr --size 256 -q -o sky.haar >/dev/null
accesses() { sed -n 's/.*"accesses": *\([0-9.e+-]*\).*/\1/p' "$log/out"; }
expect 0 haarrender scene.json --size 48x32 --integrator product-integral -q -o integral.exr
expect 0 haarview scene.json --size 48x32 --environment --reference integral.exr --repeat 1 --json --image frame.exr
mapfile -t error < <(errors)
mapfile -t count < <(accesses)
number "${error[0]} <= 0.02 && ${error[-1]} <= 0.02"
number "${error[1]} > 0.2 && ${error[3]} < ${error[1]} && ${error[5]} < ${error[3]}"
number "${count[0]} < ${count[2]} && ${count[2]} < ${count[4]} && ${count[4]} <= ${count[-1]}"

# trees of a light instead of the probe they were made from; --compare computes the same picture
expect 0 haarview brdf.haar --size 32x32 --probe sky.haar --compare --repeat 1 --json --image trees.exr
mapfile -t error < <(errors)
number "${error[0]} <= 0.02"
expect 0 haarview brdf.haar --size 32x32 --probe sky.hdr --repeat 1 --image trees.exr

# the page: the picture that chromium draws of it agrees with the CPU
export=(--compare --repeat 1 --json -q)
expect 0 haarview brdf.haar --size 64x64 --light-direction 1,2,3 "${export[@]}" --html lamp.html
expect 0 haarview scene.json --size 48x32 --environment --reference integral.exr --html environment.html
expect 0 haarview brdf.haar --size 64x64 --light-direction 1,2,3 "${export[@]}" --export again.html
same lamp.html again.html
grep -qE '(src|href)=|https?:' lamp.html && fail "the page needs more than itself"
# deviation PAGE#CHECK: of the picture in a browser.
deviation() {
  timeout 120 chromium --headless --no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader \
    --user-data-dir="$log/chromium" --dump-dom "file://$PWD/$1" 2>/dev/null >"$log/dom"
  grep -q 'gl_error 0<' "$log/dom" || fail "$1: $(grep -o '<pre id="result">.*' "$log/dom")"
  sed -n 's/.*id="result">check.* relative_rms \([0-9.e-]*\).*/\1/p' "$log/dom"
}
if has chromium; then
  fine=$(deviation 'lamp.html#check,13')
  coarse=$(deviation 'lamp.html#check,4')
  number "${fine:-1} > 0 && ${fine:-1} <= 0.01 && ${coarse:-0} > 0.1"
  fine=$(deviation 'environment.html#check')
  coarse=$(deviation 'environment.html#check,2')
  number "${fine:-1} > 0 && ${fine:-1} <= 0.02 && ${coarse:-0} > 0.1"
fi

# small pictures take fewer accesses
near=$("$bin/haarview" brdf.haar --size 256x256 -q --image frame.exr | sed -n 's/accesses per pixel *//p')
distant=$("$bin/haarview" brdf.haar --size 16x16 -q --image frame.exr | sed -n 's/accesses per pixel *//p')
number "$distant < 0.8 * $near"

# a .png; frames are reproducible
expect 0 haarview brdf.haar --size 32x32 --image frame.png
"$bin/haarview" brdf.haar --size 64x64 -q --image once.exr >/dev/null
"$bin/haarview" brdf.haar --size 64x64 -q --image twice.exr >/dev/null
same once.exr twice.exr

# errors
expect 2 haarview brdf.haar --image picture.jpg
expect 2 haarview brdf.haar --image picture.exr --level 14
expect 2 haarview brdf.haar --image picture.exr --light-direction 0,0,0
expect 2 haarview brdf.haar --image picture.exr --light-direction 0,0,1 --light-position 0,0,1
expect 2 haarview brdf.haar --image picture.exr --environment --light-direction 0,0,1
expect 2 haarview brdf.haar --image picture.exr --split-threshold 0.1
expect 2 haarview brdf.haar --image picture.exr --environment
expect 3 haarview brdf.haar --image picture.exr --probe brdf.haar
expect 3 haarview scene.json --image picture.exr --reference integral.exr
says "48x32"
head -c 5000 brdf.haar >cut.haar
expect 3 haarview cut.haar --image picture.exr
scene disk.json '{"type": "disk", "center": [0, 0, 0], "normal": [0, 1, 0], "radius": 1, "material": "fine"}'
expect 3 haarview disk.json --image picture.exr
says "objects[3]"
expect 4 haarview brdf.haar --size 70000x1 --image picture.exr
says "GL: a picture can have"
scene many.json '{"type": "sphere", "center": [0, -0.7, 1.5], "radius": 0.3, "material": "fine"}'
columns=$(for i in $(seq 550); do printf '"m%d": {"haar": "brdf.haar"}, ' "$i"; done)
sed -i "s/\"floor\": {/$columns&/" many.json
expect 4 haarview many.json --image picture.exr
says "GL: the scene needs a texture with a side of"
refuses_bad_input picture.exr haarview @ --image picture.exr
refuses_bad_output .html haarview brdf.haar --size 64x64 --html @
refuses_bad_output .exr haarview brdf.haar --size 64x64 --image @
__EGL_VENDOR_LIBRARY_FILENAMES=/nowhere expect 4 haarview brdf.haar --image picture.exr
says "EGL: "
leaves brdf.binary brdf.haar small.haar scene.json cut.haar again.html disk.json environment.html lamp.html many.json frame.exr frame.png integral.exr sky.haar sky.hdr trees.exr once.exr twice.exr
finish
