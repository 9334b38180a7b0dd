#!/usr/bin/env bash
# Black and huge-valued probes, BRDFs and maps through all programs: exit codes, one line where they are
# refused, and neither "nan" nor "inf" in results.
source "$(dirname "$0")/lib.sh" "$1"

zero='\0\0\0\0' one='\0\0\200\77' huge='\312\362\111\161' # 1e30
pfm_probe black "$zero" "$zero"
pfm_probe huge "$huge" "$huge"
pfm_probe peak "$one" "$huge"

# MERL files of one value in all cells: 0, and 1.7e29, whose bytes as a double are 01 … 01 46
header='\132\0\0\0\132\0\0\0\264\0\0\0'
bytes=$((24 * 90 * 90 * 180))
{ printf '%b' "$header"; head -c "$bytes" /dev/zero; } >black.binary
{ printf '%b' "$header"; yes "$(printf '\001\001\001\001\001\001\001F')" | tr -d '\n' | head -c "$bytes"; } >huge.binary

# numbers: the last command printed numbers, and no complaint of them.
numbers() {
  ! grep -qiE '(^|[^a-z])(nan|inf)([^a-z]|$)' "$log/out" "$log/err" || fail "$1 says: $(cat "$log/out" "$log/err")"
}
runs() { expect 0 "$@"; numbers "$*"; }

for name in black huge peak; do
  runs probe2maps $name.pfm --mapping latlong --size 16 -o $name.haar
  runs probe2maps $name.pfm --mapping latlong --size 16 -o $name.exr
  runs haarinfo $name.haar --validate
  runs haarinfo $name.haar --html $name.html
  ! grep -qE '>-?(nan|inf)<' $name.html || fail "$name.html shows no number"
  expect 0 haardiff $name.haar $name.exr # its table shows inf where the reference holds nothing
  expect 0 haardiff $name.haar black.haar --image difference.png
  runs haarsheet $name.exr black.exr -o sheet.png
done
for name in black huge; do
  runs brdf2maps $name.binary --size 8 --theta 2 --conservation-tolerance 1 -o brdf-$name.haar
  runs haarinfo brdf-$name.haar --validate
  runs haarprod brdf-$name.haar black.haar -o product.haar
done
rm product.haar

# products that no float holds
for name in huge peak brdf-huge; do
  expect 3 haarprod $name.haar $name.haar
  says "exceeds the largest single-precision number"
  expect 3 haarprod $name.haar $name.haar -o product.haar
  says "exceeds the largest single-precision number"
  expect 3 haarprod $name.haar $name.haar --factor 1 -o product.haar
  [ ! -e product.haar ] || fail "haarprod left an output"
done

# scene NAME PROBE MATERIAL EMISSION
scene() {
  cat >"$1.json" <<END
{ "film": {"width": 8, "height": 8},
  "camera": {"type": "perspective", "from": [0, 0.5, 6], "to": [0, 0, 0], "up": [0, 1, 0], "fov": 30},
  "light": {"probe": "$2.pfm", "mapping": "latlong"},
  "materials": {"m": {$3}, "glow": {"emission": [$4, $4, $4]}},
  "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "m", "name": "ball"},
              {"type": "sphere", "center": [0, 2, 0], "radius": 0.5, "material": "glow"},
              {"type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "material": "m"}] }
END
}
scene emitter black '"lambert": [0.5, 0.5, 0.5]' 5
scene huge huge '"lambert": [0.5, 0.5, 0.5]' 0
scene black black '"haar": "brdf-black.haar"' 0
runs haarrender emitter.json --spp 4 --integrator path -o emitter.exr
runs haarrender black.json --spp 4 -o dark.exr
expect 1 haardiff emitter.exr dark.exr --max-l2 1e-3 # the emitter lights the scene
for varying in light object:ball view; do
  for name in emitter black; do
    runs haarrelight build $name.json --vary $varying --tolerance 0.3 --resolution 8 -o transfer.haar
    runs haarrelight apply transfer.haar -o picture.exr
    runs haarrelight sweep transfer.haar --frames 2 -o sweep.png
  done
done
runs haarrelight build huge.json --vary light --tolerance 0.3 --resolution 8 -o transfer.haar
runs haarrelight apply transfer.haar -o picture.png
expect 3 haarrelight build huge.json --vary view --tolerance 0.3 --resolution 8 -o x.haar
says "too large for a transfer"
[ ! -e x.haar ] || fail "haarrelight left an output"

for pair in "black huge" "huge black"; do
  read -r brdf light <<<"$pair"
  runs haarbench --brdf "$brdf.binary" --probe "$light.pfm" --size 4x4 --seeds 2 --spp 1 --reference-spp 16 --brdf-size 8 \
    --theta 2 --probe-size 8 --samplers light,product -o "bench-$brdf"
  ! grep -liE '(^|[^a-z])(nan|inf)([^a-z]|$)' "bench-$brdf"/results.* || fail "haarbench writes no numbers"
done
if [ -x "$bin/haarview" ] && "$bin/haarview" emitter.json --image view.png -q >/dev/null 2>&1; then
  for light in black huge; do
    runs haarview brdf-black.haar --size 8x8 --probe $light.haar --compare --image view.exr
    runs haarview brdf-huge.haar --size 8x8 --image view.png
  done
  runs haarview emitter.json --environment --image view.exr
else
  skip "haarview was not built or cannot draw"
fi
finish
