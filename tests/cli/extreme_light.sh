#!/usr/bin/env bash
# Black probes, and probes of the smallest and largest radiances, by every sampler and integrator.
source "$(dirname "$0")/lib.sh" "$1"

zero='\0\0\0\0' one='\0\0\200\77' tiny='\302\26\1\0' huge='\245\324\150\123' # 1e-40, 1e12
pfm_probe black "$zero" "$zero"
pfm_probe tiny "$zero" "$tiny"
pfm_probe bright "$one" "$huge"

# scene NAME ALBEDO PROBE
scene() {
  cat >"$1.json" <<END
{ "film": {"width": 8, "height": 8},
  "camera": {"type": "perspective", "from": [0, 0.5, 6], "to": [0, 0, 0], "up": [0, 1, 0], "fov": 30},
  "light": {"probe": "$3.pfm", "mapping": "latlong"},
  "materials": {"grey": {"lambert": [$2, $2, $2]}},
  "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "grey"},
              {"type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "material": "grey"}] }
END
}
scene black 0.5 black
scene tiny 0.5 tiny
scene bright 0.5 bright
scene faint 1e-37 bright
expect 0 haarrender --help
samplers=$(samplers_of "$log/out")
for name in black tiny; do
  for sampler in $samplers; do
    case $sampler in product-table | wais) continue ;; esac # they need tables
    expect 0 haarrender $name.json -o x.exr --sampler "$sampler" --spp 2 --threads 1
  done
  expect 0 haarrender $name.json -o x.exr --integrator path --spp 2 --threads 1
done
for name in bright faint; do
  expect 0 haarrender $name.json -o x.exr --spp 2 --threads 1
done
# one pixel of 1e12 among ones: bounded memory
for name in black bright tiny; do
  (ulimit -v 1500000; failures=0
   expect 0 haarrender $name.json -o x.exr --integrator product-integral --threads 1
   exit "$failures") || fail "product-integral of $name"
done

# maps
expect 0 probe2maps black.pfm -o black.haar --mapping latlong --size 32
expect 0 haarinfo black.haar --validate
! grep -qiE 'nan|inf$' "$log/out" || fail "haarinfo prints no number"
largest='\377\377\177\177'
pfm_probe largest "$largest" "$largest"
expect 3 probe2maps largest.pfm -o x.haar --mapping latlong
says 'exceeds the largest single-precision number'
finish
