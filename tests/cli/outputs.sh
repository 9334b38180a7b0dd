#!/usr/bin/env bash
# Outputs of all programs: signals, leftovers, links, names, files of one run that are the same,
# standard output; threads and memory that the system refuses.
# Usage: outputs.sh PROGRAMS_FOLDER REFUSALS_LIBRARY
source "$(dirname "$0")/lib.sh" "$1"
refusals=$2

"$bin/brdfsynth" --model ggx -q -o brdf.binary >/dev/null
"$bin/probesynth" --scene studio --size 64 -q -o probe.hdr >/dev/null
"$bin/brdf2maps" brdf.binary -q --size 32 --theta 8 --conservation-tolerance 1 -o brdf.haar >/dev/null
"$bin/probe2maps" probe.hdr -q --size 32 -o probe.exr >/dev/null
cat >scene.json <<'END'
{ "film": {"width": 16, "height": 16},
  "camera": {"type": "orthographic", "from": [0, 0, 6], "to": [0, 0, 0], "height": 2.2},
  "light": {"probe": "probe.hdr"},
  "materials": {"measured": {"haar": "brdf.haar"}},
  "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "measured"}] }
END
inputs=(brdf.binary probe.hdr brdf.haar probe.exr scene.json)

# stopped SIGNAL SECONDS TOOL ARGUMENTS…: the exit code is left in $code
stopped() {
  local signal=$1 seconds=$2 tool=$3
  shift 3
  code=0
  timeout --preserve-status -s "$signal" "$seconds" "$bin/$tool" "$@" >"$log/out" 2>"$log/err" || code=$?
}
long=(brdf.binary -q --size 512 --theta 256 --conservation-tolerance 1)

# signals: nothing is left, the old output stays, the exit code is 128 + N
echo old >out.haar
for signal in INT:130 TERM:143 HUP:129 QUIT:131; do
  for refuse in none tmpfile; do
    LD_PRELOAD=$refusals REFUSE=$refuse stopped "${signal%:*}" 0.5 brdf2maps "${long[@]}" -o out.haar
    [ "$code" -eq "${signal#*:}" ] || fail "$signal, $refuse: exit code $code"
    [ "$(cat out.haar)" = old ] || fail "$signal, $refuse: the old output is gone"
    leaves "${inputs[@]}" out.haar
  done
done
# an ignored signal stays ignored
code=0
nohup "$bin/haarrender" scene.json -q --spp 4096 -o a.exr >/dev/null 2>&1 &
sleep 0.2
kill -HUP $!
wait $! || code=$?
[ "$code" -eq 0 ] && [ -s a.exr ] || fail "an ignored HUP ends haarrender: exit code $code"
rm a.exr
# at any time: the old output or the new one
"$bin/brdf2maps" brdf.binary -q --size 32 --theta 8 --conservation-tolerance 1 -o new.haar >/dev/null
for delay in 0.01 0.02 0.03 0.04 0.06 0.08; do
  for refuse in none tmpfile; do
    echo old >out.haar
    LD_PRELOAD=$refusals REFUSE=$refuse stopped TERM $delay brdf2maps brdf.binary -q --size 32 --theta 8 \
      --conservation-tolerance 1 -o out.haar
    [ "$(head -c 4 out.haar 2>/dev/null)" = "old" ] || same out.haar new.haar
    leaves "${inputs[@]}" out.haar new.haar
  done
done
rm new.haar

# leftovers of killed runs: removed by the next run; those of live processes and other hosts stay
stopped KILL 0.3 brdf2maps "${long[@]}" -o out.haar
leaves "${inputs[@]}" out.haar
LD_PRELOAD=$refusals REFUSE=tmpfile stopped KILL 1.5 brdf2maps "${long[@]}" -o out.haar
leftover=$(find . -maxdepth 1 -name '.haarlight-tmp.*' -printf '%f\n')
[ -n "$leftover" ] || fail "a killed run leaves no recognisable temporary: $(ls -A)"
other=${leftover/tmp.$(hostname)/tmp.another-host}
live=${leftover%?????}fffff
cp "$leftover" "$other" && cp "$leftover" "$live"
exec 9<"$live" && flock -n 9 || fail "the temporary cannot be locked"
expect 0 haarrender scene.json --spp 1 -o out.exr
leaves "${inputs[@]}" out.haar out.exr "$other" "$live"
exec 9<&-
expect 0 haarrender scene.json --spp 1 -o out.exr
leaves "${inputs[@]}" out.haar out.exr "$other"
rm "$other" out.haar out.exr

# links: written through, also dangling ones and to another file system; a loop is refused
mkdir target
echo old >target/file.exr
ln -s target/file.exr link.exr
ln -s target/new.exr dangling.exr
ln -s loop.exr loop.exr
ln -s missing/new.exr astray.exr
for link in link dangling; do
  expect 0 haarrender scene.json --spp 1 -o $link.exr
  [ -L $link.exr ] || fail "$link.exr is a link no more"
  check "$link.exr is a picture" "$bin/haarsheet" $link.exr -o sheet.png
done
expect 4 haarrender scene.json --spp 1 -o loop.exr
says "loop.exr: cannot be written: Too many levels of symbolic links"
expect 4 haarrender scene.json --spp 1 -o astray.exr
if [ -w /dev/shm ]; then
  far=$(mktemp -d /dev/shm/haarlight-test-XXXXXX)
  ln -s "$far/far.exr" far.exr
  expect 0 haarrender scene.json --spp 1 -o far.exr
  [ -L far.exr ] && [ -s "$far/far.exr" ] || fail "a link to another file system is not followed"
  rm -r "$far" far.exr
fi
rm -r target link.exr dangling.exr loop.exr astray.exr sheet.png

# names of up to 255 bytes
for refuse in none tmpfile; do
  name=$(printf 'n%.0s' {1..251}).exr
  LD_PRELOAD=$refusals REFUSE=$refuse expect 0 haarrender scene.json --spp 1 -o "$name"
  [ -s "$name" ] || fail "a name of 255 bytes is not written"
  rm -f "$name"
  LD_PRELOAD=$refusals REFUSE=$refuse expect 4 haarrender scene.json --spp 1 -o "n$name"
  says "File name too long"
done
leaves "${inputs[@]}"

# two outputs, or an output and an input, that are one file
before=$(cat "${inputs[@]}" | cksum)
ln -s scene.json scene-link.json
ln probe.hdr probe-link.exr
ln -s new.png new-link.png
expect 2 haarrender scene.json -o a.exr --image ./a.exr
says "--image: './a.exr' is the same file as the output --output"
expect 2 haarrender scene.json -o new.png --image new-link.png
expect 2 haarrender scene.json -o - --image -
expect 2 haarrender scene.json -o ../work/scene-link.json
says "--output: '../work/scene-link.json' is the same file as the input SCENE.json"
expect 2 haarrender scene.json -o brdf.haar
expect 2 haarrender scene.json -o probe-link.exr
expect 2 haarrelight build scene.json -o brdf.haar
expect 2 probe2maps probe.exr -o probe.exr
expect 2 probe2maps probe.hdr -o probe-link.exr
expect 2 maps2haar brdf.haar --pack -o ./brdf.haar
expect 2 haarinfo brdf.haar --image a.png --html a.png
expect 2 haarinfo brdf.haar --html page.html --reference probe.exr --image probe.exr
expect 2 haardiff brdf.haar brdf.haar --image brdf.haar # of no picture's extension
expect 2 haardiff probe.exr probe.exr --image probe.exr
expect 2 haarprod 'brdf.haar[0,0]' brdf.haar -o brdf.haar
expect 2 haarsheet probe.exr -o probe.exr
expect 2 haarbench --brdf brdf.binary --probe probe.hdr -o -
"$bin/haarrelight" build scene.json -q -o T.haar --resolution 8 >/dev/null
expect 2 haarrelight apply T.haar -o T.haar
expect 2 haarrelight apply T.haar -o scene.json
expect 2 haarrelight apply T.haar -o a.exr --image a.exr
expect 2 haarrelight sweep T.haar -o -
if [ -x "$bin/haarview" ]; then
  expect 2 haarview scene.json --image brdf.haar.png --html brdf.haar.png
  expect 2 haarview scene.json --image probe.exr --probe probe.exr
fi
[ "$(cat "${inputs[@]}" | cksum)" = "$before" ] || fail "an input has changed"
rm scene-link.json probe-link.exr new-link.png T.haar
leaves "${inputs[@]}"

# standard output: the same bytes as a file; the report goes to stderr, and nowhere with --quiet
# streamed FILE TOOL ARGUMENTS…: - is among the arguments
streamed() {
  local file=$1 tool=$2
  shift 2
  "$bin/$tool" "$@" 2>"$log/err" | cat >"$log/stream"
  cmp -s "$file" "$log/stream" || fail "$tool $*: standard output differs from a file: $(cat "$log/err")"
}
expect 0 haarrender scene.json --spp 1 -o a.exr --image a.png
streamed a.exr haarrender scene.json --spp 1 -o - --json
grep -q '"samples_per_pixel"' "$log/err" || fail "the report is not on stderr"
streamed a.exr haarrender scene.json --spp 1 -o - --quiet
[ ! -s "$log/err" ] || fail "--quiet prints: $(cat "$log/err")"
streamed a.png haarrender scene.json --spp 1 -o b.exr --image -
streamed probe.hdr probesynth --scene studio --size 64 -o -
streamed brdf.binary brdfsynth --model ggx -o -
streamed probe.exr probe2maps probe.hdr --size 32 -o -
expect 0 maps2haar probe.exr -o probe.haar
streamed probe.haar maps2haar probe.exr -o -
expect 0 haarinfo brdf.haar --image c.png
streamed c.png haarinfo brdf.haar --image -
"$bin/haarrender" scene.json --spp 1 -o - 2>"$log/err" | true
[ "${PIPESTATUS[0]}" -eq 4 ] || fail "a closed pipe is not exit code 4"
"$bin/haarrender" scene.json -q --spp 1 -o - >/dev/full 2>"$log/err"
[ $? -eq 4 ] || fail "a full device is not exit code 4"
"$bin/haarrender" scene.json -q --spp 1 -o - >&- 2>"$log/err"
[ $? -eq 4 ] || fail "a closed standard output is not exit code 4"
script -qec "'$bin/haarrender' scene.json -q --spp 1 -o -" /dev/null >"$log/out" 2>&1 </dev/null
[ $? -eq 4 ] && prints "standard output: is a terminal" || fail "a terminal is written to: $(head -c 200 "$log/out")"
expect 4 haarrender scene.json --spp 1 -o /dev/null
expect 4 haarrender scene.json --spp 1 -o /dev/stdout
says "write to -"
rm a.exr a.png b.exr c.png probe.haar
leaves "${inputs[@]}"

# without threads: the same bytes
expect 0 haarrender scene.json --spp 4 -o a.exr
LD_PRELOAD=$refusals REFUSE=threads expect 0 haarrender scene.json --spp 4 -o b.exr
same a.exr b.exr
LD_PRELOAD=$refusals REFUSE=threads expect 0 probe2maps probe.hdr --size 32 -o b.exr
same probe.exr b.exr
rm a.exr b.exr

# without memory: one line that names the purpose, exit code 5 and no output
# starved KIB TOOL ARGUMENTS…
starved() { (
  ulimit -v "$1"
  shift
  failures=0
  expect 5 "$@"
  says "out of memory"
  exit "$failures"
) || failures=$((failures + 1)); }
starved 400000 probe2maps probe.hdr --size 8192 -o a.exr
grep -q 'MiB for a map of 8192 x 8192 pixels' "$log/err" || fail "the purpose is missing: $(cat "$log/err")"
starved 400000 probe2maps probe.hdr --size 8192 -o a.haar
grep -q 'MiB for a map of 8192 x 8192 pixels' "$log/err" || fail "the purpose is missing: $(cat "$log/err")"
starved 400000 haarrender scene.json --spp 1 --size 8192x8192 --force -o a.exr
says "a film of 8192 x 8192 pixels"
leaves "${inputs[@]}"

# a full disk: no output and no temporary, and an old output stays
mkdir full
if mount -t tmpfs -o size=128k tmpfs full 2>/dev/null; then
  echo old >full/a.exr
  for force in "" --force; do
    expect 4 probe2maps probe.hdr --size 512 $force -o full/a.exr
    expect 4 probe2maps probe.hdr --size 512 $force -o full/b.exr
    expect 4 haarrender scene.json --spp 1 --size 256x256 $force -o full/b.exr
    expect 4 brdfsynth --model ggx -o full/b.binary
    [ "$(ls -A full)" = a.exr ] || fail "a full disk: files are left: $(ls -A full)"
    [ "$(cat full/a.exr)" = old ] || fail "a full disk: the old output is gone"
  done
  umount full
else
  skip "a full disk: mounting is not permitted"
fi
rmdir full
finish
