#!/usr/bin/env bash
# probesynth and probe2maps.
source "$(dirname "$0")/lib.sh" "$1"

# probesynth
for scene in studio sun-sky spheres; do
  expect 0 probesynth --scene $scene --size 64 -o $scene.hdr
done
expect 0 probesynth --scene sun-sky --size 64 -o again.hdr --threads 1
same sun-sky.hdr again.hdr
rm again.hdr spheres.hdr
expect 2 probesynth -o x.hdr
expect 2 probesynth --scene cellar -o x.hdr
expect 2 probesynth --scene studio --size -3 -o x.hdr
refuses_bad_output .hdr probesynth --scene studio --size 64 -o @
leaves studio.hdr sun-sky.hdr

# probe2maps, the work
expect 0 probe2maps sun-sky.hdr -o a.exr --size 64 --threads 1 --json
prints '"mean_error"'
prints angular
expect 0 probe2maps sun-sky.hdr -o b.exr --size 64 --threads 2
same a.exr b.exr
expect 0 probe2maps sun-sky.hdr -o b.exr --size 64 --mapping angular
mkdir elsewhere
(cd elsewhere && "$bin/probe2maps" ../sun-sky.hdr -o b.exr --size 64 >/dev/null 2>&1)
same a.exr elsewhere/b.exr
rm -r elsewhere b.exr
expect 0 maps2haar a.exr -o two.haar
expect 0 probe2maps sun-sky.hdr -o one.haar --size 64
same one.haar two.haar
expect 0 probe2maps sun-sky.hdr -o one.haar --size 16 --orientations 4 --threads 1
expect 0 probe2maps sun-sky.hdr -o a.exr --size 16 --orientations 4 --threads 2
expect 0 maps2haar a.exr -o two.haar
same one.haar two.haar
expect 0 probe2maps sun-sky.hdr -o one.haar --size 16 --mapping octahedral
expect 0 probe2maps sun-sky.hdr -o one.haar --size 16 --mapping mirrorball --supersample 2
# any image that others can read
expect 0 haarinfo one.haar --image picture.exr
expect 0 probe2maps picture.exr -o one.haar --mapping octahedral
rm a.exr one.haar two.haar picture.exr
# RGBE of another program: any first line, and an EXPOSURE of a composed picture
grey() { printf '\200\200\200\201%.0s' 1 2 3 4 5 6 7 8; }
{ printf '#?RADIANCE\n\n-Y 2 +X 4\n'; grey; } >plain.hdr
{ printf 'made elsewhere\ninput.hdr:\n\tEXPOSURE=8\nFORMAT=32-bit_rle_rgbe\n\n+Y 2 +X 4\n'; grey; } >odd.hdr
{ printf '#?OTHER\nEXPOSURE=1\n\n-Y 2 +X 4\n'; grey; } >other.hdr
for name in plain odd other; do
  expect 0 probe2maps $name.hdr -o $name.exr --size 16 --json
done
for name in odd other; do
  expect 0 haardiff plain.exr $name.exr --max-relative-l2 0
done
rm plain.* odd.* other.*

# usage
expect 2 probe2maps studio.hdr -o x.tif
expect 2 probe2maps studio.hdr -o x.exr --mapping cube
expect 2 probe2maps studio.hdr -o x.exr --size 100
expect 2 probe2maps studio.hdr -o x.exr --orientations 0
expect 2 probe2maps studio.hdr

# bad input
refuses_bad_input x.exr probe2maps @ -o x.exr
head -c 3000 studio.hdr >bad.hdr
expect 3 probe2maps bad.hdr -o x.haar
says bad.hdr
printf '#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n' >bad.hdr
head -c 32 /dev/zero | tr '\0' '\200' >>bad.hdr
expect 3 probe2maps bad.hdr -o x.exr --mapping angular
expect 0 probe2maps bad.hdr -o x.exr --mapping latlong --size 16
rm x.exr
printf '#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2000000000 +X 2000000000\nabc' >bad.hdr
expect 3 probe2maps bad.hdr -o x.exr
# 230 bytes that claim 20 million pixels: no memory is taken for them
{ printf '#?RADIANCE\n\n-Y 6 +X 3333333\n'; printf '3%.0s' {1..200}; } >bad.hdr
(ulimit -v 200000; failures=0; expect 3 probe2maps bad.hdr -o x.exr; says 'cut short'; exit "$failures") ||
  fail "a small file takes much memory"
# a PFM image of 2 x 1 pixels, one of them not a number
{ printf 'PF\n2 1\n-1.0\n'; printf '\0\0\200\77%.0s' 1 2 3 4 5; printf '\0\0\300\177'; } >nan.pfm
expect 3 probe2maps nan.pfm -o x.exr --mapping latlong
says nan.pfm
head -c 20 nan.pfm >cut.pfm
expect 3 probe2maps cut.pfm -o x.exr
rm bad.hdr nan.pfm cut.pfm
refuses_bad_output .exr probe2maps studio.hdr -o @ --size 16
refuses_bad_output .haar probe2maps studio.hdr -o @ --size 16
leaves studio.hdr sun-sky.hdr
finish
