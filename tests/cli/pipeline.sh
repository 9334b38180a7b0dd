#!/usr/bin/env bash
# pipelines/Makefile: the chain over lists, incrementally, both ways with the same trees, and what each option,
# input and program makes again.
# Usage: pipeline.sh PROGRAMS_FOLDER SOURCE_FOLDER
source "$(dirname "$0")/pipeline_lib.sh" "$@"
make_sources
all=(-j2 BRDF="a.binary b.binary.zst" PROBE="x.hdr y.hdr" OUT=out)

# two BRDFs x two probes, relative names
chain "${all[@]}"
for picture in a-x a-y b-x b-y; do
  [ -s out/$picture.exr ] && [ -s out/$picture.png ] && [ -s out/$picture.txt ] || fail "$picture is missing"
done
# nothing to do the second time
chain "${all[@]}"
[ ! -s "$log/out" ] || fail "works again: $(cat "$log/out")"
# a newer probe, and one that is replaced by an older file: its tree and pictures only
touch y.hdr
chain "${all[@]}"
makes "a newer probe" 0 1 2
touch -d 2001-01-01 y.hdr
chain "${all[@]}"
makes "an older probe" 0 1 2
mkdir other
cp -p y.hdr other
chain "${all[@]}" PROBE="x.hdr other/y.hdr"
makes "a probe of the same name from another folder" 0 1 2

# each option makes the outputs again that depend on it, and no others
one=(BRDF=a.binary PROBE=x.hdr OUT=one)
chain "${one[@]}"
makes "the first time" 1 1 1
# also OPTION COUNTS…: one more option than before
also() {
  one+=("$1")
  chain "${one[@]}"
  makes "$1" "$2" "$3" "$4"
}
also THREADS=1 0 0 0
also SPP=2 0 0 1
grep -q "samples per pixel *2$" one/a-x.txt || fail "the report is of another SPP: $(cat one/a-x.txt)"
also SAMPLER=mis 0 0 1
also RENDER_FLAGS="--size 8x8" 0 0 1
also BRDF_FLAGS="--size 16 --theta 8 --conservation-tolerance 1" 1 0 1
also PROBE_FLAGS="--size 32" 0 1 1
also HAAR_FLAGS="--tolerance 0.01" 1 1 1
also BRDF_TABLE_FLAGS="--size 32" 0 0 0
also TABLES=0 0 0 0
also KEEP_MAPS=1 1 1 1
also KEEP_MAPS=0 1 1 1
sed 's/"fov": 30/"fov": 40/' "$pipelines/scenes/sphere.json" >wide.json
also SCENE=wide.json 0 0 1
also SCENE=wide.json 0 0 0

# a changed program, and an output that was removed, cut or left half
cp -r "$bin/brdf2maps" "$bin/probe2maps" "$bin/haarrender" "$bin/maps2haar" .
chain "${one[@]}" BIN=.
touch haarrender
chain "${one[@]}" BIN=.
makes "a changed haarrender" 0 0 1
touch -d 2001-01-01 probe2maps
chain "${one[@]}" BIN=.
makes "a replaced probe2maps" 0 1 1
rm brdf2maps probe2maps haarrender maps2haar
chain "${one[@]}"
rm one/a-x.png
chain "${one[@]}"
makes "a picture that was removed" 0 0 1
cp one/brdf/a.haar whole.haar
truncate -s 100 one/brdf/a.haar
chain "${one[@]}"
makes "a tree that was cut" 1 0 1
same one/brdf/a.haar whole.haar

# a program that is killed after it has written half of its output
mkdir killed
for program in brdf2maps probe2maps; do ln -s "$bin/$program" killed; done
cat >killed/haarrender <<'END2'
#!/bin/sh
echo half >"$3"
echo half
kill -9 $PPID
END2
chmod +x killed/haarrender
make -C "$pipelines" "${small[@]}" "${one[@]}" BIN="$PWD/killed" >/dev/null 2>&1 && fail "a killed program is accepted"
[ "$(cat one/a-x.exr)" = half ] || fail "the program was not killed"
rm -r killed
chain "${one[@]}"
[ "$(head -c 4 one/a-x.exr)" != half ] || fail "half of a picture is taken for the whole"

# with tables, and by EXR files: the same trees
chain -j2 BRDF=a.binary PROBE=x.hdr OUT=tables TABLES=1 KEEP_MAPS=1 SAMPLER=product-table
same out/brdf/a.haar tables/brdf/a.haar
same out/probe/x.haar tables/probe/x.haar
[ -s tables/a-x.exr ] && [ -s tables/brdf/a.table.exr ] || fail "tables are missing"
chain BRDF=a.binary PROBE=x.hdr OUT=tables TABLES=1 KEEP_MAPS=1 SAMPLER=product-table HAAR_FLAGS="--tolerance 0.01"
makes "thresholding of kept maps" 0 0 1
runs maps2haar 4 "thresholding of kept maps"
[ "$(grep -c "^output " tables/brdf/a.txt)" -eq 1 ] || fail "reports pile up: $(cat tables/brdf/a.txt)"

# what cannot be made leaves nothing
echo nonsense >bad.hdr
make -C "$pipelines" BIN="$bin" BRDF=a.binary PROBE=bad.hdr OUT=bad PROBE_FLAGS= >/dev/null 2>&1 &&
  fail "a bad probe is accepted"
[ -z "$(find bad/probe -type f)" ] || fail "a bad probe leaves files: $(find bad)"
finish
