#!/usr/bin/env bash
# pipelines/Makefile: names of any characters, clashes, relative paths, and what clean removes.
# Usage: pipeline_places.sh PROGRAMS_FOLDER SOURCE_FOLDER
source "$(dirname "$0")/pipeline_lib.sh" "$@"
make_sources

# names of any characters: the same bytes as with plain names, and nothing of them is run
chain BRDF=a.binary PROBE=x.hdr OUT=plain
# shellcheck disable=SC2016
name='it'\''s $(touch ran) `touch ran` & "q" #;|b\\*?[x]{}<>!:%=~'
mkdir "$name"
cp a.binary "$name/$name.binary"
cp a.binary -- -d.binary
cp x.hdr "$name/@BRDF@ $name.hdr"
brdfs=$(printf '%q ' "$name/$name.binary" -d.binary)
probes=$(printf '%q ' "$name/@BRDF@ $name.hdr")
out="my $name"
out=${out//\\/}
odd=(BRDF="$brdfs" PROBE="$probes" OUT="$out")
chain -j2 "${odd[@]}"
same plain/a-x.png "$out/$name-@BRDF@ $name.png"
same plain/a-x.png "$out/-d-@BRDF@ $name.png"
[ ! -e my ] && [ ! -e ran ] && [ ! -e "$pipelines/ran" ] || fail "a name reached a shell"
chain "${odd[@]}"
[ ! -s "$log/out" ] || fail "odd names are made again: $(cat "$log/out")"
chain clean OUT="$out"
[ "$(find "$out" -name '*.haar' -o -name '*.json' | wc -l)" -eq 0 ] || fail "clean leaves $(find "$out")"
[ -s "$out/-d-@BRDF@ $name.exr" ] || fail "clean removes pictures"
# shellcheck disable=SC2016
for value in '$(shell touch ran)' '$(touch ran)' '`touch ran`' $'\ntouch ran\n' "'; touch ran; '"; do
  refuses "no such file" BRDF="a.binary $value" PROBE=x.hdr OUT=new
  make -C "$pipelines" "${small[@]}" BRDF=a.binary PROBE=x.hdr OUT=flags BRDF_FLAGS="$value" >/dev/null 2>&1 &&
    fail "BRDF_FLAGS='$value' is accepted"
  [ ! -e ran ] && [ ! -e "$pipelines/ran" ] || fail "'$value' reached a shell"
done
# shellcheck disable=SC2016
chain trees BRDF=a.binary PROBE=x.hdr OUT='dollar$$x'
# shellcheck disable=SC2016
[ -s 'dollar$x/brdf/a.haar' ] || fail "OUT with \$\$: $(ls)"
mkdir 'repository copy'
cp -r "$pipelines" 'repository copy'
make -s -C "repository copy/pipelines" "${small[@]}" trees BRDF=a.binary PROBE=x.hdr OUT="from copy"
[ -s "from copy/brdf/a.haar" ] || fail "a Makefile in a folder with a blank in its name makes nothing"
rm -r "$name" "$out" -- -d.binary 'repository copy'

# what is refused, in one line and before anything is written
mkdir -p brdf
cp a.binary a-b.binary
cp a.binary a.table.binary
cp x.hdr b-p.hdr
cp x.hdr p.hdr
cp x.hdr brdf/x.exr
refuses "BRDF is not set" PROBE=x.hdr OUT=new
refuses "PROBE is not set" BRDF=a.binary OUT=new
refuses "OUT is not set" BRDF=a.binary PROBE=x.hdr
refuses "$PWD/none.binary: no such file" BRDF="a.binary none.binary" PROBE=x.hdr OUT=new
refuses "$PWD/none.hdr: no such file" BRDF=a.binary PROBE=none.hdr OUT=new
refuses "$PWD/none.json: no such file" BRDF=a.binary PROBE=x.hdr OUT=new SCENE=none.json
refuses "none/brdf2maps: no such program" BRDF=a.binary PROBE=x.hdr OUT=new BIN=none
refuses "brdf: not a file" BRDF=a.binary PROBE=brdf OUT=new
refuses "same base name" BRDF=a.binary PROBE="x.hdr brdf/x.exr" OUT=new
refuses "BRDF a under PROBE b-p and BRDF a-b under PROBE p have one output" \
  BRDF="a.binary a-b.binary" PROBE="b-p.hdr p.hdr" OUT=new
refuses "BRDF a.table and BRDF a have one output" BRDF="a.binary a.table.binary" PROBE=x.hdr OUT=new TABLES=1
refuses "OUT: a blank" BRDF=a.binary PROBE=x.hdr OUT='new\ folder'
refuses "OUT contains a line break" BRDF=a.binary PROBE=x.hdr OUT=$'new\nfolder'
refuses "x.hdr: not a folder" BRDF=a.binary PROBE=x.hdr OUT=x.hdr
refuses "set TABLES=1" BRDF=a.binary PROBE=x.hdr OUT=new SCENE="$pipelines/scenes/sphere_tables.json"
[ ! -e new ] && [ ! -e 'new folder' ] && [ ! -e new\\ ] || fail "a refused call leaves files"
# the same clash in two calls
chain BRDF=a.binary PROBE=b-p.hdr OUT=twice
make -C "$pipelines" "${small[@]}" BRDF=a-b.binary PROBE=p.hdr OUT=twice >/dev/null 2>"$log/err" &&
  fail "another pair overwrites a-b-p.exr"
says "was made for BRDF a under PROBE b-p, not for BRDF a-b under PROBE p"
same twice/a-b-p.png plain/a-x.png

# sources where outputs go are refused; nothing that was not made here is overwritten or removed
mkdir -p mine/brdf mine/probe mine/scene
cp a.binary mine/brdf/a.binary
cp x.hdr mine/probe/x.hdr
cp x.hdr mine/a-x.exr
ln -s mine/brdf/a.binary linked.binary
refuses "sources may not lie in OUT/brdf" BRDF=mine/brdf/a.binary PROBE=x.hdr OUT=mine
refuses "sources may not lie in OUT/brdf" BRDF=linked.binary PROBE=x.hdr OUT=mine
refuses "sources may not lie in OUT/brdf" BRDF=x.hdr PROBE=mine/../mine/brdf/a.binary OUT="$PWD/mine"
refuses "sources may not lie in OUT/probe" BRDF=a.binary PROBE=mine/probe/x.hdr OUT=mine
refuses "would be overwritten" BRDF=a.binary PROBE="x.hdr mine/a-x.exr" OUT=mine
make -C "$pipelines" "${small[@]}" BRDF=a.binary PROBE=x.hdr OUT=mine >/dev/null 2>"$log/err" &&
  fail "a file that was not made here is overwritten"
says "mine/brdf/a.binary: was not made here"
same a.binary mine/brdf/a.binary
rm mine/brdf/a.binary mine/a-x.exr
echo notes >mine/brdf/notes.txt
echo notes >mine/notes.txt
chain BRDF=a.binary PROBE=x.hdr OUT=mine
chain clean OUT=mine
[ "$(cd mine && find . -path ./.made -prune -o -type f -print | sort | tr '\n' ' ')" = \
  "./a-x.exr ./a-x.png ./a-x.txt ./brdf/notes.txt ./notes.txt ./probe/x.hdr " ] || fail "clean leaves $(find mine)"
[ ! -e mine/scene ] || fail "clean leaves an empty folder"
[ -s a.binary ] && [ -s x.hdr ] || fail "clean removes sources"
mkdir my results
echo notes >my/notes
echo notes >results/notes
chain clean OUT="my results"
[ -s my/notes ] && [ -s results/notes ] || fail "clean removes folders that are words of OUT"
chain clean OUT=none
[ ! -e none ] || fail "clean makes a folder"

# relative paths count from the folder of the call, whatever PWD says
trees() { make --no-print-directory -s -C "$pipelines" "${small[@]}" trees BRDF=a.binary PROBE=x.hdr "$@"; }
mkdir call elsewhere
cp a.binary x.hdr call
ln -s ../call elsewhere/link
export pipelines
(cd call && env -u PWD make -s -C "$pipelines" "${small[@]}" trees BRDF=a.binary PROBE=x.hdr OUT=unset; :)
(cd call && PWD=/nonexistent trees OUT=nonexistent)
(cd call && PWD=/usr trees OUT=stale)
(cd elsewhere/link && trees OUT=link)
# shellcheck disable=SC2016
for shell in sh bash; do
  $shell -c 'cd call && make -s -C "$pipelines" "$@"' x "${small[@]}" trees BRDF=a.binary PROBE=x.hdr OUT=$shell
done
# shellcheck disable=SC2016
sh -c 'cd call && make -s -C "$pipelines" "$@"' x "${small[@]}" trees BRDF="$PWD/a.binary" PROBE="$PWD/x.hdr" OUT=absolute
(cd call && PWD=/usr make -s -f "$pipelines/Makefile" "${small[@]}" trees BRDF=a.binary PROBE=x.hdr OUT=file)
for folder in unset nonexistent stale link sh bash absolute file; do
  [ -s call/$folder/brdf/a.haar ] && [ ! -e $folder ] && [ ! -e "$pipelines/$folder" ] || fail "$folder: made elsewhere"
done
# nothing says where make was called
(cd call && exec env -u PWD make -s -C "$pipelines" "${small[@]}" trees BRDF=a.binary PROBE=x.hdr OUT=new 2>"$log/err") &&
  fail "relative paths without PWD are accepted"
says "\$PWD is missing or wrong: use absolute paths"
PWD=$PWD/call refuses "Relative paths may count from" trees BRDF=a.binary PROBE=x.hdr OUT=new
[ ! -e new ] && [ ! -e call/new ] || fail "an unclear folder is written to"
finish
