#!/usr/bin/env bash
# brdfsynth and brdf2maps.
source "$(dirname "$0")/lib.sh" "$1"

size=34992012 # bytes of a MERL file of 90 x 90 x 180 bins

# brdfsynth
for model in ggx blinn-phong ward lafortune ashikhmin-shirley; do
  expect 0 brdfsynth --model $model -o $model.binary
  [ "$(stat -c %s $model.binary)" -eq $size ] || fail "$model.binary is not of $size bytes"
done
rm blinn-phong.binary ward.binary lafortune.binary ashikhmin-shirley.binary
expect 0 brdfsynth --model ggx --noise 0.05 -o noise.binary --threads 1
expect 0 brdfsynth --model ggx --noise 0.05 -o again.binary --threads 2
same noise.binary again.binary
cmp -s noise.binary ggx.binary && fail "--noise changes nothing"
rm again.binary noise.binary
expect 2 brdfsynth -o x.binary
expect 2 brdfsynth --model marble -o x.binary
expect 2 brdfsynth --model ggx --noise -1 -o x.binary
expect 2 brdfsynth --model ggx
refuses_bad_output .binary brdfsynth --model ggx -o @
leaves ggx.binary

# brdf2maps, the work
small=(--size 32 --theta 8 --conservation-tolerance 0.02)
expect 0 brdf2maps ggx.binary -o a.exr "${small[@]}" --threads 1 --json
prints '"mean_error"'
expect 0 brdf2maps ggx.binary -o b.exr "${small[@]}" --threads 2
same a.exr b.exr
mkdir elsewhere
(cd elsewhere && "$bin/brdf2maps" "$work/ggx.binary" -o b.exr "${small[@]}" >/dev/null)
same a.exr elsewhere/b.exr
rm -r elsewhere b.exr
expect 0 brdf2maps ggx.binary -o b.exr "${small[@]}" --no-cosine
cmp -s a.exr b.exr && fail "--no-cosine changes nothing"
expect 0 brdf2maps ggx.binary -o b.exr "${small[@]}" --lookup nearest
cmp -s a.exr b.exr && fail "--lookup changes nothing"
expect 0 brdf2maps ggx.binary -o b.exr --size 32 --theta 8 --roll 8 --supersample 2 --conservation-tolerance 0.2
rm b.exr

# direct and by an EXR: the same bytes
expect 0 maps2haar a.exr -o two.haar --criterion l2 --tolerance 0.01
expect 0 brdf2maps ggx.binary -o one.haar "${small[@]}" --criterion l2 --tolerance 0.01
same one.haar two.haar
expect 0 haarinfo one.haar --validate
rm a.exr one.haar two.haar

# a conservation that is not met: 1, and no file
expect 1 brdf2maps ggx.binary -o x.exr --size 32 --theta 8 --conservation-tolerance 0
expect 1 brdf2maps ggx.binary -o x.haar --size 32 --theta 8 --conservation-tolerance 0
says "not written"
leaves ggx.binary

# usage
expect 2 brdf2maps ggx.binary -o x.png
expect 2 brdf2maps ggx.binary -o x.exr --size 17
expect 2 brdf2maps ggx.binary -o x.exr --size 0.5
expect 2 brdf2maps ggx.binary -o x.exr --keep 10
expect 2 brdf2maps ggx.binary -o x.haar "${small[@]}" --criterion count
expect 2 brdf2maps ggx.binary -o x.haar "${small[@]}" --keep 10 --tolerance 0.1
expect 2 brdf2maps ggx.binary

# bad input
refuses_bad_input x.exr brdf2maps @ -o x.exr "${small[@]}"
head -c 20000000 ggx.binary >bad.binary
expect 3 brdf2maps bad.binary -o x.exr "${small[@]}"
says bad.binary
{ cat ggx.binary; echo; } >bad.binary
expect 3 brdf2maps bad.binary -o x.haar "${small[@]}"
for dims in '\132\0\0\0\264\0\0\0\132\0\0\0' '\0\0\0\0\132\0\0\0\264\0\0\0' \
  '\377\377\377\377\132\0\0\0\264\0\0\0' '\377\377\377\177\377\377\377\177\377\377\377\177'; do
  cp ggx.binary bad.binary
  patch bad.binary 0 "$dims"
  expect 3 brdf2maps bad.binary -o x.exr "${small[@]}"
done
cp ggx.binary bad.binary
patch bad.binary $((12 + 8 * 1000)) '\0\0\0\0\0\0\370\177'
expect 3 brdf2maps bad.binary -o x.haar "${small[@]}"
says "byte 8012"
rm bad.binary

# tables of one byte value in each plane: \277 makes negative doubles, \101 ones of 2e6, \0 zeros
# planes RED GREEN BLUE
planes() {
  local byte
  printf '\132\0\0\0\132\0\0\0\264\0\0\0'
  for byte; do head -c 11664000 /dev/zero | tr '\0' "$byte"; done
}
planes '\277' '\0' '\0' >table.binary
expect 1 brdf2maps table.binary -o x.haar "${small[@]}"
says "no cell is valid, every cell is negative in red"
grep -Eq '^invalid cells +1$' "$log/out" || fail "the invalid cells are missing: $(cat "$log/out")"
planes '\277' '\277' '\277' >table.binary
expect 1 brdf2maps table.binary -o x.exr "${small[@]}"
says "negative in red, green, blue"
planes '\0' '\0' '\0' >table.binary
expect 0 brdf2maps table.binary -o x.exr "${small[@]}"
grep -Eq '^invalid cells +0$' "$log/out" || fail "a black table has invalid cells: $(cat "$log/out")"
rm x.exr
planes '\101' '\0' '\0' >table.binary
expect 0 brdf2maps table.binary -o x.exr "${small[@]}"
says "the albedo is above 1, up to"
rm x.exr table.binary
refuses_bad_output .exr brdf2maps ggx.binary -o @ "${small[@]}"
refuses_bad_output .haar brdf2maps ggx.binary -o @ "${small[@]}"
leaves ggx.binary
finish
