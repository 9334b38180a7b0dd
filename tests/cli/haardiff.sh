#!/usr/bin/env bash
# haardiff: sets against themselves, against the maps they were made of, and against sets of other forms.
source "$(dirname "$0")/lib.sh" "$1"

"$bin/probesynth" --scene studio --size 64 -o studio.hdr >/dev/null
"$bin/probe2maps" studio.hdr -q -o set.exr --size 32 --orientations 3 >/dev/null
"$bin/probe2maps" studio.hdr -q -o world.haar --size 64 >/dev/null
"$bin/brdfsynth" --model ggx --diffuse 0.2,0.1,0.1 --roughness 0.4 -o ggx.binary >/dev/null
rolls=(brdf2maps ggx.binary -q --size 16 --theta 3 --roll 8 --supersample 16 --tolerance 0 --coefficients float)
for fold in none rotations mirrors; do
  expect 0 "${rolls[@]}" --fold $fold -o $fold.haar
done
expect 0 maps2haar set.exr -o exact.haar --tolerance 0 --coefficients float
expect 0 maps2haar set.exr -o grey.haar --tolerance 0 --coefficients float --luminance


# nothing differs from itself
for file in set.exr exact.haar world.haar mirrors.haar; do
  expect 0 haardiff $file $file --max-l2 0 --max-relative-l2 0 --max-linf 0 --max-mean-error 0 --min-psnr 900 --json
  [ "$(value l2)$(value linf)$(value psnr)$(value mean_error)" = "0.00.0null0.0" ] || fail "$file differs from itself"
done

# an exact set is its maps, either way round; a lossy one lies as far from them as its maker said
expect 0 haardiff set.exr exact.haar --max-relative-l2 1e-6 --max-linf 1e-4 --max-mean-error 1e-5 --min-psnr 120
prints "radiance in mirror frames"
expect 0 haardiff exact.haar set.exr --max-relative-l2 1e-6
expect 0 maps2haar set.exr -o lossy.haar --criterion l2 --tolerance 0.05 --json
said=$(value relative_l2_error) peak=$(value relative_linf_error)
expect 0 haardiff set.exr lossy.haar --json
valid_json
number "$(value relative_l2) > 0.999 * $said && $(value relative_l2) < 1.001 * $said"
number "$(value relative_linf) > 0.999 * $peak && $(value relative_linf) < 1.001 * $peak"
sum=$(sed -n 's/^ *"share": \([-0-9.e+]*\)$/\1/p' "$log/out" | paste -sd+)
number "($sum) > 0.999999 && ($sum) < 1.000001"
worst_map

# every bound can break, alone and with others, and says so in one line
for bound in "--max-l2 1e-09" "--max-relative-l2 0.001" "--max-linf 1e-09" "--min-psnr 200"; do
  # shellcheck disable=SC2086
  expect 1 haardiff set.exr lossy.haar $bound --max-mean-error 1
  says "haardiff: lossy.haar: $bound is violated"
  [ "$(wc -l <"$log/err")" -eq 1 ] || fail "more than a line: $(cat "$log/err")"
  prints "no"
done
expect 1 haardiff set.exr lossy.haar --max-relative-l2 0.01 --max-l2 1e-9
says "--max-l2 1e-09"
says "--max-relative-l2 0.01 is violated: "
says "is too large by"
[ "$(wc -l <"$log/err")" -eq 1 ] || fail "more than a line: $(cat "$log/err")"
"$bin/brdfsynth" --model ggx --diffuse 0.4,0.2,0.2 --roughness 0.4 -o bright.binary >/dev/null
"$bin/brdf2maps" bright.binary -q --size 16 --theta 3 --roll 8 --fold none -o bright.haar >/dev/null
expect 1 haardiff none.haar bright.haar --max-mean-error 0.01
says "--max-mean-error 0.01"
rm bright.binary bright.haar

# single maps: the picked ones, by the indices of each side; a plain picture is a set of one
expect 0 haardiff set.exr lossy.haar --tree "$column,$row" --json
number "$(value maps) == 1 && $(value row) == $row"
expect 0 haarinfo exact.haar --tree 2,1 --image tree.exr
expect 0 haardiff exact.haar tree.exr --tree 2,1 --max-linf 0
expect 0 haardiff tree.exr exact.haar --tree 0,0 --tree-b 2,1 --max-linf 0
expect 1 haardiff exact.haar exact.haar --tree 2,1 --tree-b 1,2 --max-relative-l2 0.01
expect 2 haardiff exact.haar set.exr --tree 3,0
says "columns 0 to 2"
expect 2 haardiff exact.haar set.exr --tree 0,0 --tree-b 0,3
says "--tree-b"
expect 2 haardiff exact.haar set.exr --tree-b 0,0
expect 2 haardiff exact.haar set.exr --tree 1
expect 2 haardiff exact.haar set.exr --max-l2 -1
expect 2 haardiff exact.haar set.exr --image x.jpg
expect 2 haardiff exact.haar

# other forms of the same: folded otherwise, luminance only, coarser
# (mirrored maps are sampled at other points: equal but for what averaging over a cell leaves)
for pair in "none rotations 1e-6" "rotations mirrors 0.03" "mirrors none 0.03"; do
  # shellcheck disable=SC2086
  set -- $pair
  expect 0 haardiff "$1.haar" "$2.haar" --max-relative-l2 "$3" --json
  says "folded in different ways; all 8 rolls"
  [ "$(value rows)" = 8 ] || fail "$pair: $(value rows) rows"
done
expect 1 haardiff rotations.haar rotations.haar --tree 2,0 --tree-b 2,1 --max-relative-l2 0.2
expect 0 haardiff set.exr grey.haar --max-relative-l2 1e-6
says "luminance only"
"$bin/probe2maps" studio.hdr -q -o fine.exr --size 128 >/dev/null
expect 0 haardiff world.haar fine.exr --max-relative-l2 0.2 --max-mean-error 0.01
says "fine.exr: maps of 128 px are averaged to the 64 px of world.haar"
[ "$("$bin/haardiff" fine.exr world.haar -q 2>&1 >/dev/null)" = "" ] || fail "-q speaks"

# what cannot be compared, and what would be right
"$bin/brdf2maps" ggx.binary -q --size 16 --theta 4 --roll 8 -o other.haar >/dev/null
expect 3 haardiff none.haar other.haar
says "other.haar: has 4 x 2 maps for 8 rolls, none.haar has 3 x 8 maps for 8 rolls; equal grids are needed"
"$bin/brdf2maps" ggx.binary -q --size 16 --theta 3 --roll 8 --no-cosine -o other.haar >/dev/null
expect 3 haardiff none.haar other.haar
says "holds f_r without the cosine, none.haar holds f_r cos"
expect 3 haardiff none.haar set.exr
expect 3 haardiff none.haar set.exr --tree 0,0
says "radiance in mirror frames"
expect 3 haardiff world.haar set.exr
expect 3 haardiff world.haar studio.hdr
says "studio.hdr: byte 0: is neither a .haar file nor an EXR image"
rm other.haar

# bytes and figures do not depend on threads
expect 0 haardiff set.exr lossy.haar --image one.png --threads 1 --json
cp "$log/out" one.json
expect 0 haardiff set.exr lossy.haar --image two.png --threads 2 --json
same one.png two.png
same one.json "$log/out"
expect 0 haardiff set.exr lossy.haar --image one.exr
# the picture is of the map that differs most, and its channels R, G, B are the difference
expect 0 haardiff set.exr lossy.haar --tree "$column,$row" --image two.exr
l2=$(sed -n 's/^l2 *//p' "$log/out")
for channel in A.R B.R "lossy.haar $column,$row"; do
  grep -qF "$channel" two.exr || fail "two.exr lacks $channel"
done
expect 0 haardiff one.exr two.exr --max-linf 0
expect 0 maps2haar one.exr -o difference.haar --tolerance 0 --coefficients float
expect 0 haarinfo difference.haar --json
number "sqrt($(value mean_energy)) > 0.999 * $l2 && sqrt($(value mean_energy)) < 1.001 * $l2"
rm one.png two.png one.json one.exr two.exr tree.exr difference.haar

# broken files
size=$(stat -c %s lossy.haar)
for offset in 9 30 120 $((size / 2)); do
  cp lossy.haar bad.haar
  patch bad.haar "$offset" '\245'
  expect 3 haardiff set.exr bad.haar
  expect 3 haardiff bad.haar set.exr
  says bad.haar
done
head -c 3000 set.exr >bad.exr
expect 3 haardiff lossy.haar bad.exr --image x.png
rm bad.haar bad.exr
refuses_bad_input x.png haardiff @ set.exr --image x.png
refuses_bad_input x.exr haardiff set.exr @ --image x.exr
refuses_bad_output .png haardiff set.exr lossy.haar --image @
refuses_bad_output .exr haardiff set.exr lossy.haar --image @
leaves studio.hdr set.exr world.haar ggx.binary none.haar rotations.haar mirrors.haar exact.haar grey.haar \
  lossy.haar fine.exr
finish
