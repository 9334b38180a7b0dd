#!/usr/bin/env bash
# haarrelight: transfer that is built, applied and swept, for every kind of variation, and its misuse.
source "$(dirname "$0")/lib.sh" "$1"

make_brdf brdf --diffuse 0.2,0.1,0.05
make_brdf blue --diffuse 0.02,0.1,0.3 --roughness 0.4
make_probe studio
make_probe sun-sky
inputs=(brdf.binary brdf.haar blue.binary blue.haar studio.hdr studio.haar sun-sky.hdr sun-sky.haar scene.json)

# scene FILE ROTATE MATERIAL X: a measured sphere and a matt ball at X over a matt floor.
scene() {
  cat >"$1" <<END
{ "film": {"width": 24, "height": 16},
  "camera": {"type": "perspective", "from": [0, 1.5, 6], "to": [0, 0, 0], "up": [0, 1, 0], "fov": 35},
  "light": {"probe": "studio.hdr", "haar": "studio.haar", "rotate": $2},
  "materials": {"measured": {"brdf": "$3.binary", "haar": "$3.haar"}, "floor": {"lambert": [0.5, 0.5, 0.5]}},
  "objects": [{"type": "sphere", "center": [-0.8, 0, 0], "radius": 1, "material": "measured"},
              {"type": "sphere", "name": "ball", "center": [$4, -0.5, 0.6], "radius": 0.5, "material": "floor"},
              {"type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "material": "floor"}] }
END
}
scene scene.json 0 brdf 0.8

# agrees SCENE PICTURE BOUND: with a rendering, as a mean relative error
agrees() {
  "$bin/haarrender" "$1" -o truth.exr --spp 256 -q >/dev/null
  "$bin/haarsheet" --reference truth.exr "$2" -o sheet.png --json >"$log/out"
  awk -F: -v bound="$3" '/relative_error/ { exit !($2 + 0 < bound) }' "$log/out" ||
    fail "$2 is not $1: $(cat "$log/out")"
  rm truth.exr sheet.png
}

# light: as it stands, turned, and another
expect 0 haarrelight build scene.json --vary light --tolerance 0.05 --resolution 64 -o light.haar --json
valid_json
expect 0 haarinfo light.haar
prints "scene.json"
expect 0 haarinfo --validate light.haar
expect 0 haarrelight apply light.haar -o a.exr --json
agrees scene.json a.exr 0.03
expect 0 haarrelight apply light.haar --rotate 60,0,0 -o b.exr --image b.png
scene turned.json 60 brdf 0.8
agrees turned.json b.exr 0.03
cmp -s a.exr b.exr && fail "--rotate changes nothing"
sed 's/studio/sun-sky/g' scene.json >sky.json
for light in sun-sky.hdr sun-sky.haar; do
  expect 0 haarrelight apply light.haar --probe $light -o b.exr
  agrees sky.json b.exr 0.05
done
rm turned.json sky.json b.exr b.png

# bytes depend on neither threads nor folder; packed is smaller and the same
expect 0 haarrelight build scene.json --tolerance 0.05 --resolution 64 -o one.haar --threads 1
same light.haar one.haar
mkdir elsewhere
(cd elsewhere && "$bin/haarrelight" build ../scene.json --tolerance 0.05 --resolution 64 -o one.haar >/dev/null)
same light.haar elsewhere/one.haar
expect 0 haarrelight apply elsewhere/one.haar --scene scene.json -o elsewhere/a.exr --threads 1
same a.exr elsewhere/a.exr
rm -r elsewhere one.haar
expect 0 haarrelight build scene.json --tolerance 0.05 --resolution 64 --pack -o packed.haar
[ "$(wc -c <packed.haar)" -lt "$(($(wc -c <light.haar) / 2))" ] || fail "--pack does not make it small"
expect 0 haarrelight apply packed.haar -o b.exr
"$bin/maps2haar" packed.haar --unpack -q -o unpacked.haar >/dev/null
same light.haar unpacked.haar
rm packed.haar unpacked.haar b.exr

# an object by its name and its number, a material, the view
expect 0 haarrelight build scene.json --vary object:ball --tolerance 0.3 --resolution 64 -o object.haar
expect 0 haarrelight build scene.json --vary object:1 --tolerance 0.3 --resolution 64 -o number.haar
same object.haar number.haar
expect 0 haarrelight apply object.haar --move -1.2,0,0 -o b.exr
scene moved.json 0 brdf -0.4
agrees moved.json b.exr 0.06
expect 0 haarrelight build scene.json --vary material:measured --size 12x8 -o material.haar
expect 0 haarrelight apply material.haar --brdf blue.haar -o b.exr
scene blue.json 0 blue 0.8
sed -i 's/"width": 24, "height": 16/"width": 12, "height": 8/' blue.json
agrees blue.json b.exr 0.05
expect 0 haarrelight apply material.haar --brdf blue.binary -o b.exr
expect 0 haarrelight build scene.json --vary view -o view.haar
expect 0 haarrelight apply view.haar --move 2,0,0 -o b.exr
rm number.haar moved.json blue.json b.exr

# sequences
expect 0 haarrelight sweep light.haar --pictures 3 -o turn.png --json
for picture in turn.png turn-0000.png turn-0001.png turn-0002.png; do
  check "$picture is a picture" "$bin/haarsheet" $picture -o sheet.png
  rm $picture sheet.png
done
expect 0 haarrelight sweep object.haar --pictures 2 --on-sheet 1 --move-from -2,0,0 --move-to 2,0,0 -o move.png
cmp -s move-0000.png move-0001.png && fail "nothing moves"
rm move*.png

# usage
expect 2 haarrelight
expect 2 haarrelight rebuild
says "build|apply|sweep"
expect 2 haarrelight build scene.json
expect 2 haarrelight build scene.json -o x.haar --vary lamp
says "material:NAME"
expect 2 haarrelight build scene.json -o x.haar --vary object:bowl
expect 2 haarrelight build scene.json -o x.haar --vary object:3
says "0 to 2"
expect 2 haarrelight build scene.json -o x.haar --vary material:gold
says "measured, floor"
expect 2 haarrelight build scene.json -o x.haar --resolution 100
expect 2 haarrelight apply light.haar -o x.exr --move 1,0,0
says "was built with --vary light, not object:NAME or view"
expect 2 haarrelight apply light.haar -o x.exr --brdf blue.haar
expect 2 haarrelight apply object.haar -o x.exr --rotate 10,0,0
says "was built with --vary object:1, not light"
expect 2 haarrelight apply view.haar -o x.exr --probe sun-sky.hdr
expect 2 haarrelight apply light.haar -o x.exr --rotate 10
expect 2 haarrelight sweep light.haar -o x.exr
for command in build apply sweep; do
  expect 0 haarrelight $command --help
  prints "haarrelight $command"
done

# input and output
scene other.json 5 brdf 0.8
expect 3 haarrelight apply light.haar --scene other.json -o x.exr
says "is not the scene"
expect 3 haarrelight apply light.haar --scene missing.json -o x.exr
expect 3 haarrelight apply studio.haar -o x.exr
says "holds no transfer"
sed 's/"type": "plane"/"name": "ball", "type": "plane"/' scene.json >other.json
expect 3 haarrelight build other.json -o x.haar
says "objects[1] already"
rm other.json
refuses_bad_input x.exr haarrelight apply @ --scene scene.json -o x.exr
refuses_bad_input x.haar haarrelight build @ -o x.haar
refuses_bad_output .haar haarrelight build scene.json --size 4x4 -o @
refuses_bad_output .exr haarrelight apply light.haar -o @
leaves "${inputs[@]}" light.haar object.haar material.haar view.haar a.exr
finish
