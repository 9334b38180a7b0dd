#!/usr/bin/env bash
# maps2haar, haarinfo and haarsheet.
source "$(dirname "$0")/lib.sh" "$1"

"$bin/probesynth" --scene studio --size 64 -o studio.hdr >/dev/null
"$bin/probe2maps" studio.hdr -q -o set.exr --size 32 --orientations 3 >/dev/null

# maps2haar: exact at tolerance 0, smaller otherwise, for every criterion
expect 0 maps2haar set.exr -o exact.haar --tolerance 0 --coefficients float --json
prints '"kept_coefficients"'
grep -q '"relative_l2_error": \(0.0\|[0-9.]*e-0[78]\|[0-9.]*e-1[0-9]\)' "$log/out" ||
  fail "tolerance 0 is not exact: $(grep l2 "$log/out")"
for criterion in variance l2 linf; do
  expect 0 maps2haar set.exr -o $criterion.haar --criterion $criterion --tolerance 0.05
  [ "$(stat -c %s $criterion.haar)" -lt "$(stat -c %s exact.haar)" ] || fail "$criterion.haar is not smaller"
done
expect 0 maps2haar set.exr -o count.haar --criterion count --keep 50 --json
prints '"kept_coefficients": 450'
expect 0 maps2haar set.exr -o one.haar --threads 1
expect 0 maps2haar set.exr -o two.haar --threads 2
same one.haar two.haar
expect 0 maps2haar set.exr -o grey.haar --luminance
rm variance.haar l2.haar linf.haar count.haar two.haar

# haarinfo
expect 0 haarinfo exact.haar
prints "negative mass share"
expect 0 haarinfo exact.haar --json
valid_json
expect 0 haarinfo grey.haar
prints "luminance"
expect 0 haarinfo one.haar --validate
prints "yes"
expect 0 haarinfo one.haar --validate --json
prints '"valid": true'
expect 0 haarinfo exact.haar --tree 2,1 --image tree.exr
expect 0 haarinfo exact.haar --tree 2,1 --level 3 --image tree.png
expect 0 haarinfo exact.haar --image atlas.png --threads 1
expect 0 haarinfo exact.haar --image again.png --threads 2
same atlas.png again.png
expect 0 haarinfo exact.haar --image atlas.exr --level 5
# the atlas of an exact set at full level is the map set itself
expect 0 haarsheet atlas.exr -o sheet.png --reference set.exr --json
grep -qE '"relative_error": ([0-9.]+e-0[6789]|0\.0)' "$log/out" || fail "the atlas is not the set: $(cat "$log/out")"
expect 0 haarinfo one.haar --tree 0,0 --dump csv
head -n 1 "$log/out" | grep -q '^column,row,level,x,y,type,r,g,b$' || fail "no head line in the CSV"
[ $((($(wc -l <"$log/out") - 1) % 3)) -eq 0 ] || fail "a node has not three lines in the CSV"
expect 2 haarinfo one.haar --tree 3,0
expect 2 haarinfo one.haar --tree 1
expect 2 haarinfo one.haar --level 6
expect 2 haarinfo one.haar --image x.jpg
expect 2 haarinfo one.haar --dump xml
rm tree.exr tree.png atlas.png again.png sheet.png grey.haar exact.haar

# haarinfo --validate says no, and everything else refuses the file
size=$(stat -c %s one.haar)
for offset in 9 20 30 70 120 $((size / 2)) $((size - 40)); do
  cp one.haar bad.haar
  patch bad.haar "$offset" '\245'
  expect 1 haarinfo bad.haar --validate
  prints "bad.haar"
  expect 3 haarinfo bad.haar
done
for length in 8 100 200 $((size / 2)) $((size - 1)); do
  head -c "$length" one.haar >bad.haar
  expect 1 haarinfo bad.haar --validate
  expect 3 haarinfo bad.haar --image x.png
done
rm bad.haar
refuses_bad_input x.png haarinfo @ --validate
refuses_bad_input x.png haarinfo @ --image x.png
refuses_bad_output .png haarinfo one.haar --image @
refuses_bad_output .exr haarinfo one.haar --image @
leaves studio.hdr set.exr one.haar atlas.exr

# maps2haar on bad input and output
refuses_bad_input x.haar maps2haar @ -o x.haar
refuses_bad_output .haar maps2haar set.exr -o @ --tolerance 0
for length in 7 300 1200 5000; do
  head -c "$length" set.exr >bad.exr
  expect 3 maps2haar bad.exr -o x.haar
  says bad.exr
done
expect 3 maps2haar studio.hdr -o x.haar
expect 3 maps2haar one.haar -o x.haar
rm bad.exr
expect 2 maps2haar set.exr -o x.exr
expect 2 maps2haar set.exr -o x.haar --criterion count
expect 2 maps2haar set.exr -o x.haar --tolerance -1
expect 2 maps2haar set.exr -o x.haar --coefficients double

# the packed form: both ways to it give the same bytes, and it becomes what it was
expect 0 maps2haar one.haar --pack -o packed.haar --json
prints '"form": "packed"'
expect 0 maps2haar set.exr -o direct.haar --pack --threads 1
same packed.haar direct.haar
[ "$(stat -c %s packed.haar)" -lt "$(stat -c %s one.haar)" ] || fail "packing does not shrink"
expect 0 maps2haar packed.haar --unpack -o unpacked.haar --threads 2
same one.haar unpacked.haar
expect 0 maps2haar set.exr -o rounded.haar --criterion l2 --tolerance 0.03 --quantize --pack --json
prints '"quantize": true'
[ $((2 * $(stat -c %s rounded.haar))) -lt "$(stat -c %s packed.haar)" ] || fail "--quantize hardly shrinks"
for form in packed one; do
  expect 0 haarinfo $form.haar --json
  expect 0 haarinfo $form.haar --validate
  prints "yes"
  expect 0 haarinfo $form.haar --tree 1,1 --image $form.exr
done
same packed.exr one.exr
expect 0 haarinfo packed.haar
prints "packed"
expect 0 haarinfo one.haar
prints "mapped"
TMPDIR=$log/missing expect 0 haarinfo packed.haar # no such folder: /tmp serves
size=$(stat -c %s packed.haar)
for offset in 9 20 30 70 120 155 $((size / 2)) $((size - 10)); do
  cp packed.haar bad.haar
  patch bad.haar "$offset" '\245'
  expect 1 haarinfo bad.haar --validate
  prints "bad.haar"
  expect 3 haarinfo bad.haar
  expect 3 maps2haar bad.haar --unpack -o x.haar
  says bad.haar
done
expect 3 maps2haar one.haar --unpack -o x.haar
expect 3 maps2haar packed.haar --pack -o x.haar
expect 3 maps2haar set.exr --unpack -o x.haar
expect 2 maps2haar one.haar --pack --unpack -o x.haar
expect 2 maps2haar one.haar --pack --tolerance 0.1 -o x.haar
refuses_bad_input x.haar maps2haar @ --unpack -o x.haar
refuses_bad_output .haar maps2haar one.haar --pack -o @
refuses_bad_output .haar maps2haar packed.haar --unpack -o @
rm packed.haar direct.haar unpacked.haar rounded.haar packed.exr one.exr bad.haar

# haarsheet
expect 0 haarsheet atlas.exr atlas.exr --caption a --caption b -o sheet.png
expect 2 haarsheet atlas.exr atlas.exr --caption a -o sheet.png
expect 3 haarsheet atlas.exr set.exr one.haar -o x.png
expect 3 haarsheet missing.png -o x.png
# a header of an EXR image of 2^26 pixels without any of them
head -c "$(($(stat -c %s atlas.exr) / 2))" atlas.exr >bad.exr
expect 3 haarsheet bad.exr -o x.png
patch bad.exr "$(($(grep -abo dataWindow bad.exr | head -1 | cut -d: -f1) + 29))" '\377\37\0\0\377\37\0\0'
(ulimit -v 300000; failures=0; expect 3 haarsheet bad.exr -o x.png; says bad.exr; exit "$failures") ||
  fail "a small file takes much memory"
rm bad.exr
refuses_bad_output .png haarsheet atlas.exr -o @
leaves studio.hdr set.exr one.haar atlas.exr sheet.png
finish
