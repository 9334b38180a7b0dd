#!/usr/bin/env bash
# The gallery's scenes, small and noisy, and the order of what the README's pictures need.
# Usage: gallery.sh PROGRAMS_FOLDER SOURCE_FOLDER
source "$(dirname "$0")/lib.sh" "$1"
pipelines=$2/pipelines

gallery() {
  make --no-print-directory -C "$pipelines" gallery -j2 BIN="$bin" OUT="it's a gallery" SPP=1 \
    RENDER_FLAGS="--size 26x16" "$@" >"$log/out" 2>"$log/err" || fail "gallery: $(cat "$log/out" "$log/err")"
}

gallery SHEET="a sheet.png"
same "a sheet.png" "it's a gallery/gallery.png"
ln -s "it's a gallery" gallery
for scene in "$pipelines"/scenes/gallery/*.json; do
  name=$(basename "$scene" .json)
  [ -s "gallery/$name.exr" ] && [ -s "gallery/$name.png" ] || fail "$name is missing"
  grep -q "^width *26 px" "gallery/$name.txt" || fail "$name: $(cat "gallery/$name.txt")"
  grep -q "\`$name\`" "$pipelines/GALLERY.md" || fail "GALLERY.md does not mention $name"
done
expect 0 haarsheet gallery/gallery.png --reference gallery/gallery.png -o again.png
gallery
[ ! -s "$log/out" ] || fail "works again: $(cat "$log/out")"
gallery SPP=2
[ "$(grep -c "/haarrender " "$log/out")" -eq 6 ] && ! grep -q 2maps "$log/out" ||
  fail "another SPP does not make just the pictures again: $(cat "$log/out")"

# a renderer may not make one scene's picture from another's
cmp -s gallery/lamps.exr gallery/room.exr && fail "two scenes, one picture"

make --no-print-directory -n -C "$pipelines" readme BIN="$bin" OUT="it's readme" PICTURES="its pictures" \
  >"$log/out" 2>"$log/err" || fail "readme: $(cat "$log/err")"
for picture in "$pipelines"/pictures/*.png; do
  grep -q "pictures/$(basename "$picture")" "$log/out" || fail "readme does not make $(basename "$picture")"
done

# the part of it that is made from the gallery; the demo installs packages, and haarview takes long
make --no-print-directory -C "$pipelines" readme -o demo -o viewer.png -o turning.png -j2 BIN="$bin" \
  OUT="it's readme" PICTURES="its pictures" SPP=1 RENDER_FLAGS="--size 26x16" >"$log/out" 2>"$log/err" ||
  fail "readme: $(cat "$log/out" "$log/err")"
same "it's readme/gallery/gallery.png" "its pictures/gallery.png"

finish
