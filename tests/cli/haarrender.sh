#!/usr/bin/env bash
# haarrender: every sampler that --help lists, every estimator and integrator, and every kind of bad input.
source "$(dirname "$0")/lib.sh" "$1"

make_brdf brdf --diffuse 0.2,0.1,0.05
"$bin/brdf2maps" brdf.binary -q --size 32 --theta 8 --roll 16 --conservation-tolerance 1 -o brdf.table.haar >/dev/null
"$bin/probesynth" --scene studio --size 64 -q -o probe.hdr >/dev/null
"$bin/probe2maps" probe.hdr -q --size 64 -o probe.haar >/dev/null
"$bin/probe2maps" probe.hdr -q --size 32 --orientations 8 -o probe.table.haar >/dev/null
inputs=(brdf.binary brdf.haar brdf.table.haar probe.hdr probe.haar probe.table.haar)

cat >scene.json <<'END'
{ "film": {"width": 24, "height": 16},
  "camera": {"type": "perspective", "from": [0, 0.5, 6], "to": [0, 0, 0], "up": [0, 1, 0], "fov": 30},
  "light": {"probe": "probe.hdr", "haar": "probe.haar", "table": "probe.table.haar"},
  "materials": {"measured": {"brdf": "brdf.binary", "haar": "brdf.haar", "table": "brdf.table.haar"},
                "floor": {"lambert": [0.5, 0.5, 0.5]}},
  "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "measured"},
              {"type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "material": "floor"}] }
END

# the work
cat >sphere.json <<'END'
{ "film": {"width": 16, "height": 16},
  "camera": {"type": "orthographic", "from": [0, 0, 6], "to": [0, 0, 0], "height": 2.2},
  "light": {"probe": "probe.hdr", "haar": "probe.haar", "table": "probe.table.haar"},
  "materials": {"measured": {"brdf": "brdf.binary", "haar": "brdf.haar", "table": "brdf.table.haar"}},
  "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "measured"}] }
END
expect 0 haarrender --help
samplers=$(samplers_of "$log/out")
[ "$(wc -w <<<"$samplers")" -ge 19 ] || fail "haarrender --help lists few samplers: $samplers"
for sampler in $samplers; do
  scene=scene.json
  case $sampler in product-table | wais) scene=sphere.json ;; esac
  expect 0 haarrender $scene -o "$sampler.exr" --sampler "$sampler" --spp 4
  check "$sampler.exr is a picture" "$bin/haarsheet" "$sampler.exr" -o sheet.png
  rm "$sampler.exr" sheet.png
done
expect 0 haarrender scene.json -o a.exr --spp 4 --threads 1
expect 0 haarrender scene.json -o b.exr --spp 4 --threads 2 --json
same a.exr b.exr
mkdir elsewhere
(cd elsewhere && "$bin/haarrender" ../scene.json -o b.exr --spp 4 >/dev/null)
same a.exr elsewhere/b.exr
rm -r elsewhere
expect 0 haarrender scene.json -o b.exr --spp 4 --seed 1
cmp -s a.exr b.exr && fail "--seed changes nothing"
for estimator in bidirectional ratio; do
  expect 0 haarrender scene.json -o b.exr --spp 2 --estimator $estimator
done
expect 0 haarrender scene.json -o b.exr --spp 2 --points random --brdf-lookup nearest --probe-lookup bilinear
expect 0 haarrender scene.json -o b.exr --image b.png --size 8x6 --spp 1 --time-limit 0.1
check "b.png is a picture" "$bin/haarsheet" b.png -o sheet.png
rm a.exr b.exr b.png sheet.png sphere.json

# paths, and what shines
sed 's/"floor": {"lambert": \[0.5, 0.5, 0.5\]/&, "emission": [0.5, 0.5, 0.5]/' scene.json >shining.json
expect 0 haarrender scene.json -o a.exr --spp 4 --integrator path --depth 1
for sampler in product mis; do
  expect 0 haarrender shining.json -o a.exr --spp 4 --integrator path --sampler $sampler --threads 1
  expect 0 haarrender shining.json -o b.exr --spp 4 --integrator path --sampler $sampler --threads 2
  same a.exr b.exr
done
strings a.exr | grep -q '^integrator=path$' || fail "the picture does not say its integrator"
expect 2 haarrender scene.json -o x.exr --depth 3
expect 2 haarrender scene.json -o x.exr --integrator path --depth -1
expect 2 haarrender scene.json -o x.exr --integrator path --estimator ratio
rm a.exr b.exr shining.json

# no samples at all
expect 0 haarrender scene.json -o a.exr --integrator product-integral --resolution 32 --threads 1
expect 0 haarrender scene.json -o b.exr --integrator product-integral --resolution 32 --threads 2
same a.exr b.exr
strings a.exr | grep -q '^resolution=32$' || fail "the picture does not say its resolution"
expect 2 haarrender scene.json -o x.exr --resolution 64
expect 2 haarrender scene.json -o x.exr --integrator product-integral --resolution 100
expect 2 haarrender scene.json -o x.exr --integrator product-integral --spp 4
rm a.exr b.exr

# usage
expect 2 haarrender scene.json
expect 2 haarrender scene.json -o x.exr --sampler magic
expect 2 haarrender scene.json -o x.exr --spp 0
for size in 8 8x 0x8 -1x8 axb 99999999x99999999; do
  expect 2 haarrender scene.json -o x.exr --size $size
done

# scenes that are wrong: exit code 3, and the message names what is
refuses_bad_input x.exr haarrender @ -o x.exr
wrong() {
  sed "$1" scene.json >wrong.json
  expect 3 haarrender wrong.json -o x.exr
  says "$2"
}
wrong 's/"fov"/"fow"/' fov
wrong 's/probe.hdr/missing.hdr/' missing.hdr
wrong 's/brdf.haar/missing.haar/' missing.haar
wrong 's/"material": "floor"/"material": "flor"/' floor
wrong 's/"radius": 1/"radius": -1/' radius
wrong 's/probe.hdr/scene.json/' scene.json
wrong 's/"brdf": "brdf.binary"/"brdf": "probe.hdr"/' probe.hdr
wrong 's/"haar": "brdf.haar"/"haar": "probe.haar"/' probe.haar
wrong 's/"haar": "probe.haar"/"haar": "brdf.haar"/' brdf.haar
wrong 's/}] }/}] /' wrong.json
head -c 400 brdf.haar >cut.haar
wrong 's/brdf.haar/cut.haar/' cut.haar
"$bin/maps2haar" brdf.haar --pack -o packed.haar >/dev/null
wrong 's/brdf.haar/packed.haar/' "packed.haar: byte 0: is packed; maps2haar --unpack makes"
rm wrong.json cut.haar packed.haar

# outputs that cannot be written
refuses_bad_output .exr haarrender scene.json -o @ --spp 1
expect 4 haarrender scene.json -o x.exr --spp 1 --image missing/x.png
leaves scene.json "${inputs[@]}"
finish
