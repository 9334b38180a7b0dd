#!/usr/bin/env bash
# haarbench: every sampler on made-up files, what it writes, what it finds again, and bad input.
source "$(dirname "$0")/lib.sh" "$1"

"$bin/brdfsynth" --model ggx --diffuse 0.2,0.1,0.05 -q -o a.binary >/dev/null
"$bin/probesynth" --scene studio --size 64 -q -o p.hdr >/dev/null
cat >scene.json <<'END'
{ "film": {"width": 24, "height": 16},
  "camera": {"type": "perspective", "from": [0, 0.5, 6], "to": [0, 0, 0], "up": [0, 1, 0], "fov": 30},
  "light": {"probe": "other.hdr"},
  "materials": {"first": {"lambert": [0.9, 0.5, 0.5]}, "floor": {"lambert": [0.5, 0.5, 0.5]}},
  "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "first"},
              {"type": "plane", "point": [0, -1, 0], "normal": [0, 1, 0], "material": "floor"}] }
END
inputs=(a.binary p.hdr scene.json)
small=(--size 8x8 --seeds 2 --reference-spp 64 --brdf-size 32 --probe-size 32)
tables=(--theta 4 --table-size 16 --roll 8 --orientations 4)
run=(--brdf a.binary --probe p.hdr "${small[@]}" "${tables[@]}")

# column NAME FILE.csv: a column of the rows, without its name.
column() {
  awk -F, -v name="$1" 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == name) c = i; next } { print $c }' "$2"
}

# the work: all samplers at equal samples and at equal time, one row for each
expect 0 haarbench "${run[@]}" --samplers all --spp 2,8 -o out --json
prints '"winner"'
prints '"product_over_mis"'
samplers=$(column sampler out/results.csv | sort -u | wc -l)
[ "$(column mode out/results.csv | grep -c equal-samples)" -eq $((2 * samplers)) ] || fail "not 2 rows a sampler"
[ "$(column mode out/results.csv | grep -c equal-time)" -eq $((2 * samplers)) ] || fail "not 2 budgets a sampler"
for sampler in product product-table light brdf mis; do
  column sampler out/results.csv | grep -qx $sampler || fail "no rows of $sampler"
  grep -q "\"sampler\": \"$sampler\"" out/results.json || fail "results.json lacks $sampler"
  grep -q "<b>$sampler</b>" out/report.html || fail "no picture of $sampler"
done
grep -qE 'src="[^d]|href=|url\(' out/report.html && fail "report.html is not self-contained"
grep -q '<svg' out/report.html || fail "report.html has no plots"
[ "$(grep -c '"relmse"' out/results.json)" -eq "$(column relmse out/results.csv | wc -l)" ] ||
  fail "JSON and CSV hold different rows"
paste <(column sampler out/results.csv) <(column spp out/results.csv) <(column mean_ratio out/results.csv) |
  awk '$1 == "product" && $2 == 8 && !($3 > 0.7 && $3 < 1.4) { exit 1 }' || fail "product's mean is far from the reference"

# equal samples come out the same again, whatever the threads; the trees are found again
untimed() { grep equal-samples "$1/results.csv" | cut -d, -f1-6,8-12; }
mkdir kept
cp -p out/cache/* kept
expect 0 haarbench "${run[@]}" --samplers all --spp 2,8 -o out2 --threads 1 -q
untimed out >first
untimed out2 >second
same first second
expect 0 haarbench "${run[@]}" --samplers product,mis --spp 4 --seed 7 -o out -v
grep -q "made in" "$log/err" && fail "trees were made twice"
for file in kept/*; do
  [ "$file" -ot "out/cache/${file#kept/}" ] && fail "${file#kept/} was made twice"
done
expect 0 haarbench "${run[@]/#4/5}" --samplers product,mis --spp 4 -o out -v
says "brdf-a.haar: made in"
printf x >>out/cache/brdf-a.haar
expect 0 haarbench "${run[@]/#4/5}" --samplers product,mis --spp 4 -o out -v
says "brdf-a.haar: made in"
rm -r kept out2 first second

# tables only where a sampler needs them; scenes, points, budgets, estimators
expect 0 haarbench "${run[@]}" --samplers light --spp 4 --seconds 0.001,0.002 --points both -o plain
[ -n "$(find plain/cache -name '*table*')" ] && fail "tables were made for nothing"
[ "$(column points plain/results.csv | sort | uniq -c | awk '{ print $1 }' | sort -u)" = 3 ] || fail "not 3 rows by points"
column budget_seconds plain/results.csv | grep -qx 0.002 || fail "--seconds is not the budget"
expect 0 haarbench "${run[@]}" --scene sphere spheres scene.json --samplers product,mis --spp 4 \
  --estimator ratio -o plain
[ "$(column scene plain/results.csv | sort -u | tr '\n' ' ')" = "scene sphere spheres " ] || fail "not three scenes"
rm -r plain

# usage
expect 2 haarbench
expect 2 haarbench --brdf a.binary -o x
expect 2 haarbench --brdf a.binary --probe p.hdr
wrong() { expect 2 haarbench "${run[@]}" -o x "$@"; }
wrong --samplers magic
says "--samplers: 'magic' is none of all, product"
wrong --spp 0
wrong --spp 4,x
says "--spp: 'x'"
wrong --seconds 0
wrong --seeds 1
wrong --size 8
wrong --brdf-size 33
wrong --estimator bidirectional --samplers mis
wrong --brdf other/a.binary
wrong --scene sphere sphere

# one malformed file among many: reported before any work
rest=(--samplers mis --spp 4 "${small[@]}" -o x)
refuses_bad_input x haarbench --brdf a.binary @ --probe p.hdr "${rest[@]}"
refuses_bad_input x haarbench --brdf a.binary --probe p.hdr @ "${rest[@]}"
refuses_bad_input x haarbench --brdf a.binary --probe p.hdr --scene sphere @ "${rest[@]}"
sed 's/"radius": 1/"radius": -1/' scene.json >broken.json
expect 3 haarbench "${run[@]}" --scene broken.json -o x
says "radius"
sed 's/"from": \[0, 0.5, 6\], "to": \[0, 0, 0\]/"from": [0, 5, 6], "to": [0, 9, 0]/' scene.json >empty.json
expect 3 haarbench "${run[@]}" --scene empty.json --samplers mis --spp 4 -o x
says "empty.json: no pixel of the film hits an object"
rm -r broken.json empty.json x

# outputs that cannot be written
: >file
expect 4 haarbench "${run[@]}" --samplers mis --spp 4 -o file
expect 4 haarbench "${run[@]}" --samplers mis --spp 4 -o file/x
mkdir -p taken/report.html
expect 4 haarbench "${run[@]}" --samplers mis --spp 4 -o taken
expect 4 haarbench "${run[@]}" --samplers mis --spp 4 -o new/../file
[ ! -e new ] || fail "a folder that was made for nothing is left"
too_long=$(printf '%0300d' 0)
expect 4 haarbench "${run[@]}" --samplers mis --spp 4 -o "new/nested/$too_long"
[ ! -e new ] || fail "nested folders that were made for nothing are left"
mkdir old old/taken
expect 4 haarbench "${run[@]}" --samplers mis --spp 4 -o "old/taken/new/$too_long"
[ -d old/taken ] && [ ! -e old/taken/new ] || fail "a folder that was there is removed, or a new one left"
rm -r old
full_disk haarbench "${run[@]}" --samplers mis --spp 4 -o new/full
[ ! -e new ] || fail "folders are left where nothing could be written"
mkdir full
full_disk haarbench "${run[@]}" --samplers mis --spp 4 -o full
[ ! -e full/results.json ] || fail "half of the results are there"
rm -r file taken full out
leaves "${inputs[@]}"
finish
