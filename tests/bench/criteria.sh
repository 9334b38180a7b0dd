#!/usr/bin/env bash
# What each criterion keeps of a light tree, and what that costs a sampler: a table of kept
# coefficients, relative L2 and L-infinity error, negative mass, and the relative variance per sample
# of products with real materials on a sphere (random points, 64 samples a pixel, no background).
#
#   tests/bench/criteria.sh BIN PROBE.hdr KEEP… -- MATERIAL.binary…
#
# BIN is the folder of the programs. Takes a minute or two for each KEEP.
set -euo pipefail
if [ $# -lt 5 ]; then
  echo "usage: criteria.sh BIN PROBE.hdr KEEP… -- MATERIAL.binary…" >&2
  exit 2
fi
bin=$(cd "$1" && pwd) probe=$(realpath "$2")
shift 2
keeps=()
while [ "$1" != -- ]; do keeps+=("$1") && shift; done
shift
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$bin/probe2maps" "$probe" -q -o "$work/light.exr" >/dev/null
names=()
for material in "$@"; do
  name=$(basename "$material" .binary)
  names+=("$name")
  "$bin/brdf2maps" "$material" -q -o "$work/$name.haar" >/dev/null
  cat >"$work/$name.json" <<JSON
{"film": {"width": 64, "height": 64},
 "camera": {"type": "orthographic", "from": [0, 0, 5], "to": [0, 0, 0], "up": [0, 1, 0], "height": 2.2},
 "light": {"probe": "$probe", "haar": "light.haar", "background": false},
 "materials": {"m": {"brdf": "$(realpath "$material")", "haar": "$name.haar"}},
 "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "m"}]}
JSON
done

# field NAME FILE: the number of a name in one of the programs' JSON.
field() { sed -n "s/^ *\"$1\": \([-0-9.e+]*\),\{0,1\}$/\1/p" "$2" | head -n 1; }

printf '| kept | criterion | L2 | L∞ | negative mass |'
printf ' %s |' "${names[@]}"
printf '\n|---|---|---|---|---|'
printf -- '---|%.0s' "${names[@]}"
printf '\n'
for keep in "${keeps[@]}"; do
  for criterion in variance l2 linf; do
    "$bin/maps2haar" "$work/light.exr" -q --json -o "$work/light.haar" --criterion $criterion \
      --keep "$keep" >"$work/kept.json"
    printf '| %s | %s | %.3g | %.3g | %.2g |' "$keep" $criterion \
      "$(field relative_l2_error "$work/kept.json")" "$(field relative_linf_error "$work/kept.json")" \
      "$(field negative_mass_share "$work/kept.json")"
    for name in "${names[@]}"; do
      "$bin/haarrender" "$work/$name.json" -q --json -o "$work/out.exr" --sampler product --spp 64 \
        --points random >"$work/render.json"
      printf ' %.3g |' "$(field relative_variance_per_sample "$work/render.json")"
    done
    printf '\n'
  done
done
