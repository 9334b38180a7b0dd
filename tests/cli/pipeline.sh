#!/usr/bin/env bash
# pipelines/Makefile: the chain over lists, incrementally, both ways with the same trees.
# Usage: pipeline.sh PROGRAMS_FOLDER SOURCE_FOLDER
source "$(dirname "$0")/lib.sh" "$1"
pipelines=$2/pipelines

"$bin/brdfsynth" --model ggx -q -o a.binary >/dev/null
"$bin/brdfsynth" --model ward -q -o b.binary >/dev/null
zstd -q --rm b.binary
"$bin/probesynth" --scene studio --size 64 -q -o x.hdr >/dev/null
"$bin/probesynth" --scene sun-sky --size 64 -q -o y.hdr >/dev/null

chain() {
  make --no-print-directory -C "$pipelines" BIN="$bin" SPP=1 RENDER_FLAGS="--size 16x16" \
    BRDF_FLAGS="--size 32 --theta 8 --conservation-tolerance 1" PROBE_FLAGS="--size 64" \
    BRDF_TABLE_FLAGS="--size 16 --theta 4 --roll 8 --conservation-tolerance 1" \
    PROBE_TABLE_FLAGS="--size 16 --orientations 4" "$@" >"$log/out" 2>"$log/err" ||
    fail "make $*: $(cat "$log/out" "$log/err")"
}

# two BRDFs x two probes, relative names
chain -j2 BRDF="a.binary b.binary.zst" PROBE="x.hdr y.hdr" OUT=out
for picture in a-x a-y b-x b-y; do
  [ -s out/$picture.exr ] && [ -s out/$picture.png ] || fail "$picture is missing"
done
# nothing to do the second time
chain -j2 BRDF="a.binary b.binary.zst" PROBE="x.hdr y.hdr" OUT=out
grep -q haarrender "$log/out" && fail "renders again: $(cat "$log/out")"
# a newer probe: its pictures only
touch y.hdr
chain BRDF="a.binary b.binary.zst" PROBE="x.hdr y.hdr" OUT=out
[ "$(grep -c haarrender "$log/out")" -eq 2 ] || fail "a newer probe: $(cat "$log/out")"
# with tables, and by EXR files: the same trees
chain -j2 BRDF=a.binary PROBE=x.hdr OUT=tables TABLES=1 KEEP_MAPS=1 SAMPLER=product-table
same out/brdf/a.haar tables/brdf/a.haar
same out/probe/x.haar tables/probe/x.haar
[ -s tables/a-x.exr ] && [ -s tables/brdf/a.table.exr ] || fail "tables are missing"

# what cannot be made leaves nothing
echo nonsense >bad.hdr
make -C "$pipelines" BIN="$bin" BRDF=a.binary PROBE=bad.hdr OUT=bad PROBE_FLAGS= >/dev/null 2>&1 &&
  fail "a bad probe is accepted"
[ -e bad/probe/bad.haar ] && fail "a bad probe leaves a file"
make -C "$pipelines" BIN="$bin" PROBE=x.hdr OUT=bad >/dev/null 2>&1 && fail "no BRDF is accepted"
finish
