#!/usr/bin/env bash
# The whole pipeline on made-up input: BRDFs and probes, trees, pictures, and a sheet that compares the
# samplers at equal samples per pixel. Installs missing Debian packages and builds build/release first.
# Usage: bash pipelines/demo.sh [OUTPUT_FOLDER]   (default pipelines/out/demo)
set -euo pipefail

unset CDPATH
caller=$PWD
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."
out=${1:-$PWD/pipelines/out/demo}
case $out in /*) ;; *) out=$caller/$out ;; esac
bin=$PWD/build/release/bin
jobs=$(nproc)
spp=16

bash pipelines/install_packages.sh build
[ -e build/release/build.ninja ] || cmake --preset release
cmake --build build/release -j "$jobs" --target brdfsynth probesynth brdf2maps probe2maps maps2haar \
  haarinfo haarrender haarsheet
started=$SECONDS

# once TARGET COMMAND…: unless the target is there already.
once() {
  [ -e "$1" ] || "${@:2}" -q -o "$1" >/dev/null
}

mkdir -p -- "$out/source" "$out/scene"
echo "== sources"
once "$out/source/plastic.binary" "$bin/brdfsynth" --model ggx --diffuse 0.25,0.04,0.03 --roughness 0.12
once "$out/source/metal.binary" "$bin/brdfsynth" --model ggx --specular 0.9,0.7,0.4 --roughness 0.06
once "$out/source/paint.binary" "$bin/brdfsynth" --model ashikhmin-shirley --diffuse 0.05,0.15,0.4 \
  --exponent 500 --noise 0.02
once "$out/source/studio.hdr" "$bin/probesynth" --scene studio --size 512
once "$out/source/sun-sky.hdr" "$bin/probesynth" --scene sun-sky --size 512

echo "== trees and pictures"
# make reads $$ as $, and in a list a backslash makes a blank part of a word.
for_make=${out//\$/\$\$}
in_list=${for_make//\\/\\\\}
in_list=${in_list// /\\ }
make --no-print-directory -C pipelines -j "$jobs" OUT="$for_make" TABLES=1 SPP=$spp \
  BRDF="$(printf '%s ' "$in_list"/source/{plastic,metal,paint}.binary)" \
  PROBE="$(printf '%s ' "$in_list"/source/{studio,sun-sky}.hdr)" >/dev/null

echo "== demo picture"
cp pipelines/scenes/demo.json "$out/scene/demo.json"
"$bin/haarrender" "$out/scene/demo.json" -o "$out/demo.exr" --image "$out/demo.png" --spp $spp >/dev/null

echo "== samplers at $spp samples per pixel, and their errors"
scene=$out/scene/paint-sun-sky.json
"$bin/haarrender" "$scene" -o "$out/reference.exr" --sampler mis --spp 512 --seed 1 >/dev/null
pictures=()
captions=()
for sampler in product product-table light brdf mis; do
  "$bin/haarrender" "$scene" -o "$out/sampler-$sampler.exr" --sampler "$sampler" --spp $spp >/dev/null
  pictures+=("$out/sampler-$sampler.exr")
  captions+=(--caption "$sampler $spp spp")
done
"$bin/haarsheet" "${pictures[@]}" "$out/reference.exr" "${captions[@]}" --caption "mis 512 spp" \
  --reference "$out/reference.exr" --columns 3 --tone-map filmic -o "$out/contact-sheet.png"

echo "done in $((SECONDS - started)) s after the build:"
echo "  $out/demo.exr"
echo "  $out/demo.png"
echo "  $out/contact-sheet.png"
