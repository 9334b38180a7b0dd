#!/usr/bin/env bash
# Image formats that probe2maps refuses or reads: exit codes and messages.
source "$(dirname "$0")/lib.sh" "$1"
ulimit -c 0

# pfm END: a 4x4 image of ones whose header lines end so
pfm() {
  printf 'PF%b4 4%b-1.0%b' "$1" "$1" "$1"
  printf '\0\0\200\77%.0s' $(seq 48)
}
pfm '\n' >lf.pfm
pfm '\r\n' >crlf.pfm
expect 0 probe2maps lf.pfm -o a.exr --size 16 --mapping octahedral
expect 0 probe2maps crlf.pfm -o b.exr --size 16 --mapping octahedral
expect 0 haardiff a.exr b.exr --max-relative-l2 0

# OpenEXR written by a program of this toolkit; layers and parts that are not there
expect 0 probe2maps a.exr -o b.exr --size 16 --mapping octahedral
expect 0 haardiff a.exr b.exr --max-relative-l2 1e-6
expect 3 probe2maps a.exr -o c.exr --layer beauty
says "no layer 'beauty'"
expect 3 probe2maps a.exr -o c.exr --part 1
says "no part '1'"
expect 3 probe2maps lf.pfm -o c.exr --layer beauty
says 'no layers'

# formats that are not accepted, whatever their name
{ printf 'DDS |\0\0\0'; head -c 200 /dev/zero; } >x.exr
{ printf 'BM'; head -c 200 /dev/zero; } >x.png
{ printf '\001\332\001\001'; head -c 600 /dev/zero; } >x.hdr
for file in x.exr x.png x.hdr; do
  expect 3 probe2maps $file -o c.exr
  says 'TIFF, PNG and JPEG are accepted'
done

# headers that claim 16384 x 8192 pixels
{
  printf '\211PNG\r\n\032\n\0\0\0\rIHDR\0\0\100\0\0\0\040\0\020\002\0\0\0\375\214\027\165'
  printf '\0\0\0\0IDAT\065\257\006\036\0\0\0\0IEND\256\102\140\202'
} >bomb.png
printf 'II\052\0\010\0\0\0\005\0\0\001\004\0\001\0\0\0\0\100\0\0\001\001\004\0\001\0\0\0\0\040\0\0\002\001\003\0\001\0\0\0\040\0\0\0\021\001\004\0\001\0\0\0\010\0\0\0\027\001\004\0\001\0\0\0\100\0\0\0\0\0\0\0' >bomb.tif
printf 'PF\n16384 8192\n-1\nabc' >bomb.pfm
for file in bomb.png bomb.tif bomb.pfm; do
  (
    ulimit -v 400000
    failures=0
    expect 3 probe2maps $file -o c.exr
    exit "$failures"
  ) || failures=$((failures + 1))
done

# a reader that cannot be found or started is named
mkdir -p elsewhere/bin
cp "$bin/probe2maps" elsewhere/bin
code=0
elsewhere/bin/probe2maps a.exr -o c.exr >"$log/out" 2>"$log/err" || code=$?
[ "$code" -eq 5 ] || fail "no reader: exit code $code: $(cat "$log/err")"
says haarlight_read_image
expect 0 probe2maps lf.pfm -o c.exr --size 16 --mapping octahedral
finish
