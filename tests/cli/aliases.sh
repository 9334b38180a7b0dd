#!/usr/bin/env bash
# Old spellings of options: accepted with the same result, and absent from --help.
source "$(dirname "$0")/lib.sh" "$1"

"$bin/probesynth" --scene studio --size 32 -q -o studio.hdr >/dev/null
"$bin/probesynth" --scene sun-sky --size 32 -q -o sky.hdr >/dev/null
"$bin/probe2maps" studio.hdr -q --size 16 -o studio.exr >/dev/null
"$bin/maps2haar" studio.exr -q --tolerance 0.05 -o studio.haar >/dev/null
grey_scene scene.json 8 6 '"probe": "studio.hdr"'
"$bin/haarrelight" build scene.json -q --resolution 8 -o light.haar >/dev/null

# hidden OLD COMMAND…: --help of the command does not show the old spelling.
hidden() {
  local old=$1
  shift
  expect 0 "$@" --help
  ! grep -qE -- "$old([ =]|\$)" "$log/out" || fail "$* --help shows $old"
}

# renamed OLD NEW OUTPUT TOOL ARGUMENTS…: @ among the arguments stands for the option. The output has the same
# bytes with either spelling.
renamed() {
  local old=$1 new=$2 output=$3 tool=$4
  shift 4
  expect 0 "$tool" "${@/@/$new}"
  mv "$output" new
  expect 0 "$tool" "${@/@/$old}"
  same new "$output"
  rm new
}

renamed --against --reference page.html haarinfo studio.haar --html page.html @ studio.exr
renamed --against=studio.exr --reference=studio.exr page.html haarinfo studio.haar --html page.html @
hidden --against haarinfo
renamed --tolerance --threshold product.haar haarprod studio.haar studio.haar -o product.haar @ 0.05
hidden --tolerance haarprod
renamed --png --image a.png haarrender scene.json --spp 1 -o a.exr @ a.png
hidden --png haarrender
renamed --png --image b.png haarrelight apply light.haar -o b.exr @ b.png
renamed --light --probe b.exr haarrelight apply light.haar -o b.exr @ sky.hdr
renamed --light --probe c-0001.png haarrelight sweep light.haar -o c.png --pictures 2 @ sky.hdr
renamed --frames --pictures c-0002.png haarrelight sweep light.haar -o c.png @ 3
hidden --png haarrelight apply
for command in apply sweep; do
  hidden --light haarrelight $command
done
hidden --frames haarrelight sweep

if [ -x "$bin/haarview" ]; then
  make_brdf brdf
  renamed --export --html view.html haarview brdf.haar --size 8x8 @ view.html
  renamed --light --probe view.html haarview brdf.haar --size 8x8 --html view.html @ sky.hdr
  renamed --tolerance --split-threshold view.html haarview brdf.haar --size 8x8 --probe sky.hdr --html view.html @ 0.1
  for old in --frame --export --tolerance --light --against; do
    hidden "$old" haarview
  done
  expect 2 haarview brdf.haar --frame picture.jpg
  says "--image: 'picture.jpg'"
  expect 2 haarview brdf.haar --html view.html --against brdf.haar
  says "--beside: "
  rm brdf.binary brdf.haar view.html
fi

# messages use the present spelling, and a name after "--" is no option
expect 2 haarprod studio.haar --tolerance x
says "--threshold: 'x'"
expect 3 haarinfo -- --against
says "--against"
expect 2 haarrender scene.json -o a.exr --image b.exr
says "--image: 'b.exr' is written as PNG"
leaves studio.hdr sky.hdr studio.exr studio.haar scene.json light.haar page.html product.haar a.exr a.png b.exr b.png \
  c.png c-0000.png c-0001.png c-0002.png
finish
