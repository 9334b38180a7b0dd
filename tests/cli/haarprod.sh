#!/usr/bin/env bash
# haarprod: products of stored trees as trees and as integrals.
source "$(dirname "$0")/lib.sh" "$1"

"$bin/probesynth" --scene studio --size 64 -o studio.hdr >/dev/null
"$bin/probesynth" --scene sun-sky --size 64 -o sky.hdr >/dev/null
for name in studio sky; do
  "$bin/probe2maps" $name.hdr -q -o $name.haar --size 64 --tolerance 0 --coefficients float >/dev/null
done
"$bin/probe2maps" studio.hdr -q -o table.haar --size 32 --orientations 2 >/dev/null

# field NAME INDEX: an entry of a list in the last command's JSON.
field() { tr -d ' \n' <"$log/out" | sed "s/.*\"$1\":\[\([^]]*\)\].*/\1/" | cut -d, -f"$2"; }

# one tree: its own mean; a product's integral, its tree's mean and the inner product are one
expect 0 haarprod studio.haar --json
valid_json
expect 0 haarprod studio.haar sky.haar 'table.haar[1,0]' --json
mean=$(field mean 2)
integral=$(field integral 2)
number "$integral > 12.56 * $mean && $integral < 12.57 * $mean"
expect 0 haarprod studio.haar sky.haar 'table.haar[1,0]' -o product.haar --coefficients float
expect 0 haarprod product.haar --json
number "$(field mean 2) > 0.9999 * $mean && $(field mean 2) < 1.0001 * $mean"
for split in 1 2; do
  expect 0 haarprod studio.haar sky.haar 'table.haar[1,0]' --factor $split --json -o factors.haar
  number "$(field mean 2) > 0.999 * $mean && $(field mean 2) < 1.001 * $mean"
done
expect 0 haarinfo factors.haar
prints "factor3"
expect 0 haarinfo --validate factors.haar
expect 0 haarprod 'factors.haar[0,0]' 'factors.haar[1,0]' --integral --json
number "$(field mean 2) > 0.99 * $mean && $(field mean 2) < 1.01 * $mean"

# a note says that frames differ
expect 0 haarprod studio.haar sky.haar
[ ! -s "$log/err" ] || fail "stderr: $(cat "$log/err")"
expect 0 haarprod studio.haar 'table.haar[1,0]'
says "another frame"

# dropping makes it smaller
expect 0 haarprod studio.haar sky.haar -o all.haar
expect 0 haarprod studio.haar sky.haar -o some.haar --threshold 0.05
[ "$(wc -c <some.haar)" -lt "$(wc -c <all.haar)" ] || fail "nothing was dropped"

# what goes wrong
expect 2 haarprod
expect 2 haarprod 'table.haar[9,0]'
says "columns 0 to 1"
expect 2 haarprod 'table.haar[a]'
expect 2 haarprod studio.haar sky.haar --factor 2
says "must be below"
expect 3 haarprod missing.haar
expect 3 haarprod studio.hdr
expect 4 haarprod studio.haar -o /nowhere/out.haar
leaves studio.hdr sky.hdr studio.haar sky.haar table.haar product.haar factors.haar all.haar some.haar
finish
