#!/usr/bin/env bash
# Inputs from pipes, files that change while they are in use, packed files that expand, and outputs that do not fit.
source "$(dirname "$0")/lib.sh" "$1"

# peak_below MIB TOOL ARGUMENTS…: the peak of memory must stay below.
peak_below() {
  local limit=$1 peak
  shift
  has /usr/bin/time || return 0
  /usr/bin/time -f '%M' -o "$log/peak" "$bin/$1" "${@:2}" >/dev/null 2>&1
  peak=$(tail -n 1 "$log/peak")
  [ "$peak" -lt $((limit * 1024)) ] || fail "$* took $peak KiB, more than $limit MiB"
}

"$bin/probesynth" --scene studio --size 64 -q -o studio.hdr >/dev/null
"$bin/probe2maps" studio.hdr -q --size 64 -o world.haar >/dev/null
"$bin/maps2haar" world.haar --pack -q -o packed.haar >/dev/null
grey_scene scene.json 8 8 '"probe": "studio.hdr", "haar": "world.haar"'

# Pipes give the same bytes as files.
expect 0 probe2maps - -q --size 64 -o pipe.haar < <(cat studio.hdr)
"$bin/haardiff" world.haar pipe.haar --max-linf 0 >/dev/null || fail "a probe from a pipe differs"
grep -aq "source=standard input" pipe.haar || fail "provenance does not name standard input"
expect 0 haarinfo --validate - < <(cat packed.haar)
expect 0 haarinfo - <world.haar
expect 0 haarinfo <(cat packed.haar)
expect 0 haardiff packed.haar - --max-linf 0 < <(cat world.haar)
expect 0 maps2haar - --unpack -o unpacked.haar < <(cat packed.haar)
same world.haar unpacked.haar
expect 0 haarrender scene.json --spp 1 -o file.exr
expect 0 haarrender - --spp 1 -o pipe.exr < <(cat scene.json)
expect 0 haarrender <(cat scene.json) --spp 1 -o pipe.exr
mkfifo late.haar
(sleep 0.5; cat world.haar >late.haar) &
expect 0 haarinfo late.haar
wait
expect 2 haardiff - - </dev/null
says "standard input"
expect 3 haarinfo - </dev/null
says "standard input: is a device"
expect 3 haarinfo /dev/zero
says "device"
expect 3 haarinfo - <&-
rm late.haar
"$bin/brdfsynth" --model ggx --diffuse 0.2,0.1,0.1 -q -o gloss.binary >/dev/null
maps=(-q --size 8 --theta 2 --conservation-tolerance 1)
expect 0 brdf2maps gloss.binary "${maps[@]}" -o file.haar
expect 0 brdf2maps - "${maps[@]}" -o pipe.haar < <(cat gloss.binary)
expect 0 haardiff file.haar pipe.haar --max-linf 0
expect 0 brdf2maps <(cat gloss.binary) "${maps[@]}" -o pipe.haar
expect 0 haardiff file.haar pipe.haar --max-linf 0
"$bin/haarrender" scene.json --size 16x8 --spp 1 -q -o image.exr --image image.png >/dev/null
{ printf 'PF\n2 1\n-1.0\n'; head -c 24 studio.hdr | tr -c '[:lower:]' b; } >image.pfm
for image in image.exr image.png image.pfm; do
  expect 0 probe2maps $image --mapping latlong -q --size 16 -o file.haar
  expect 0 probe2maps - --mapping latlong -q --size 16 -o pipe.haar < <(cat $image)
  expect 0 haardiff file.haar pipe.haar --max-linf 0
  expect 0 probe2maps <(cat $image) --mapping latlong -q --size 16 -o pipe.haar
  expect 0 haardiff file.haar pipe.haar --max-linf 0
done
twice() {
  expect 2 "$@" </dev/null
  says "standard input, which is read once"
}
twice haarbench --brdf - --probe - -o bench
twice haarbench --brdf - - --probe studio.hdr -o bench
[ ! -e bench ] || fail "haarbench left its folder"
if [ -x "$bin/haarview" ]; then
  twice haarview - --probe - --image view.png
  twice haarview - --beside - --frames 1
  twice haarview - --compare --reference - --image view.png
fi

# Memory that the system refuses is named.
truncate -s 10G large.haar
(
  ulimit -v 2000000
  failures=0
  expect 5 haarinfo large.haar
  says "for the contents of large.haar"
  exit "$failures"
) || failures=$((failures + 1))
rm large.haar

# Neither form needs the temporary folder.
TMPDIR=/nonexistent expect 0 haarinfo packed.haar
TMPDIR=/nonexistent expect 0 haardiff world.haar packed.haar --max-linf 0

# A file that shrinks or changes while it is rendered.
sed 's/"width": 8, "height": 8/"width": 256, "height": 256/' scene.json >large.json
"$bin/haarrender" large.json --spp 16 --threads 1 -q -o before.exr >/dev/null
for change in ': >world.haar' 'head -c 100000 /dev/urandom | dd of=world.haar conv=notrunc status=none'; do
  cp unpacked.haar world.haar
  "$bin/haarrender" large.json --spp 16 --threads 1 -q -o after.exr >/dev/null 2>"$log/err" &
  sleep 0.1
  eval "$change"
  wait $!
  code=$?
  if [ "$code" -eq 0 ]; then
    "$bin/haardiff" before.exr after.exr --max-linf 0 >/dev/null 2>&1 || fail "a changed file changed the picture"
  else
    [ "$code" -eq 3 ] || fail "a changed file: exit code $code: $(cat "$log/err")"
  fi
done
cp unpacked.haar world.haar

# A packed file that would expand is refused at once.
bomb=$(dirname "$0")/../../../shared/cases/packed_bomb_1.haar
if [ -f "$bomb" ]; then
  expect 3 maps2haar "$bomb" --unpack -o out.haar
  expect 1 haarinfo --validate "$bomb"
  peak_below 64 haarinfo --validate "$bomb"
else
  skip "the shared data lack packed_bomb_1.haar"
fi

# Outputs that cannot fit.
expect 4 probe2maps studio.hdr --size 8192 --orientations 512 -o huge.exr
says "TiB of disk space"
says "--force"
[ ! -e huge.exr ] || fail "huge.exr was left"
(
  ulimit -v 2000000
  failures=0
  expect 4 haarrender scene.json --size 8192x8192 --spp 1 -o huge.exr
  says "GiB of memory"
  exit "$failures"
) || failures=$((failures + 1))

finish
