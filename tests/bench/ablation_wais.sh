#!/usr/bin/env bash
# From wavelet importance sampling as published to the world-frame product, one change at a time, as
# Markdown tables: relative variance per sample (random points, 64 a pixel), errors of pictures of 64
# random, 64 Sobol and 1024 Sobol points, bytes that light and BRDF take mapped, and time per sample
# over that of mis (set-up included, 64 samples). Unoccluded sphere; errors are those of `haarsheet
# --reference`, to a picture of 4096 Sobol points by `product` with a tight bound.
#
#   tests/bench/ablation_wais.sh BIN BRDF_FOLDER PROBE_FOLDER WORK [steps] [bias]
#
# steps: that table; bias: what error is left on 8 × 8 pixels, after 4096 and 65536 Sobol points, of which
# a biased sampler gets rid no more. Both without either word.
# MATERIALS and PROBES name files without .binary and .hdr; FILM is the picture's size. WORK keeps
# the tables, about 1 GB by default; the first run takes about half an hour, later ones half of it.
set -euo pipefail
if [ $# -lt 4 ]; then
  echo "usage: ablation_wais.sh BIN BRDF_FOLDER PROBE_FOLDER WORK [steps] [bias]" >&2
  exit 2
fi
bin=$(realpath "$1") data_brdf=$(realpath "$2") data_probe=$(realpath "$3")
mkdir -p "$4"
work=$(realpath "$4")
what=${*:5}
what=${what:-steps bias}
materials=${MATERIALS:-violet-acrylic gold-paint chrome}
probes=${PROBES:-grace_probe rnl_probe}
FILM=${FILM:-32x32}
source "$(dirname "${BASH_SOURCE[0]}")/ablation_lib.sh"

# light_table PROBE SIZE ORIENTATIONS COMPRESSION…: a table of rotated maps; sets `made`.
light_table() {
  local maps="$work/$1-$2-$3.exr"
  made="$work/$1-$2-$3$(printf '%s' "${@:4}").haar"
  [ -s "$made" ] && return
  make_once "$maps" "$bin/probe2maps" "$(probe_file "$1")" --size "$2" --orientations "$3" \
    --supersample 2 --conservation-tolerance 1
  make_once "$made" "$bin/maps2haar" "$maps" "${@:4}"
}

# brdf_table MATERIAL SIZE THETA ROLL COMPRESSION…: a table with rolls; sets `made`.
brdf_table() {
  local maps="$work/$1-$2-$3-$4.exr"
  made="$work/$1-$2-$3-$4$(printf '%s' "${@:5}").haar"
  [ -s "$made" ] && return
  make_once "$maps" "$bin/brdf2maps" "$(brdf_file "$1")" --size "$2" --theta "$3" --roll "$4" \
    --fold mirrors --conservation-tolerance 1
  make_once "$made" "$bin/maps2haar" "$maps" "${@:5}"
}

# row NAME OPTIONS…: a line of the table for the scene at hand, of $light_bytes and $brdf_bytes.
row() {
  local name=$1 variance random sobol time
  shift
  variance=$(relvar "$@")
  random=$(picture_error "$reference")
  time=$(field thread_ns_per_sample "$work/out.json")
  render --points sobol --spp 64 "$@"
  sobol=$(picture_error "$reference")
  render --points sobol --spp 1024 "$@"
  printf '| %s | %.3g | %.3g | %.3g | %.2g | %.2f / %.2f | %.2f |\n' "$name" "$variance" "$random" \
    "$sobol" "$(picture_error "$reference")" "$(compute "$light_bytes / 1e6" %g)" \
    "$(compute "$brdf_bytes / 1e6" %g)" "$(compute "$time / $mis_time" %g)"
}

# bias_row NAME OPTIONS…: a line of what is left, of the scene at hand.
bias_row() {
  local few
  render --points sobol --spp 4096 "${@:2}"
  few=$(picture_error "$reference")
  render --points sobol --spp 65536 "${@:2}"
  printf '| %s | %.2g | %.2g |\n' "$1" "$few" "$(picture_error "$reference")"
}

# table_scene SIZE ORIENTATIONS THETA ROLL LIGHT_COMPRESSION BRDF_COMPRESSION
table_scene() {
  local light
  # shellcheck disable=SC2086
  light_table "$probe" "$1" "$2" $5
  light=$made
  # shellcheck disable=SC2086
  brdf_table "$material" "$1" "$3" "$4" $6
  scene "$material" "$probe" "$world" "$lobes" "$light" "$made"
  light_bytes=$(bytes_of "$light") brdf_bytes=$(bytes_of "$made")
}

# table_row NAME SAMPLER SIZE ORIENTATIONS THETA ROLL LIGHT_COMPRESSION BRDF_COMPRESSION
table_row() {
  table_scene "${@:3}"
  row "$1" --sampler "$2"
}

# product_row NAME LIGHT_SIZE BRDF_SIZE OPTIONS…
product_row() {
  local name=$1 light="$work/$probe-world-$2.haar" brdf="$work/$material-theta-$3.haar"
  make_once "$light" "$bin/probe2maps" "$(probe_file "$probe")" --size "$2" --conservation-tolerance 1
  make_once "$brdf" "$bin/brdf2maps" "$(brdf_file "$material")" --size "$3" --conservation-tolerance 1
  scene "$material" "$probe" "$light" "$brdf"
  light_bytes=$(bytes_of "$light") brdf_bytes=$(bytes_of "$brdf")
  row "$name" --sampler product "${@:4}"
}

# begin REFERENCE_OPTIONS…: makes the world's trees, the reference picture and its scene.
begin() {
  world="$work/$probe-world-1024.haar" lobes="$work/$material-theta-512.haar"
  reference="$work/reference-$material-$probe-$film.exr"
  make_once "$world" "$bin/probe2maps" "$(probe_file "$probe")" --size 1024
  make_once "$lobes" "$bin/brdf2maps" "$(brdf_file "$material")" --size 512
  scene "$material" "$probe" "$world" "$lobes"
  [ -s "$reference" ] && return
  render --points sobol --seed 99 "$@"
  mv "$work/out.exr" "$reference"
}

# Shares of 4096 and 16384 coefficients: a tenth of the light's, a twentieth of the BRDF's.
k64="--keep 410" b64="--keep 205" k128="--keep 1638" b128="--keep 819"

steps() {
  begin --spp 4096 --product-variance 0.003 --product-leaves 65536
  printf '\n%s under %s:\n\n| | variance | 64 random | 64 Sobol | 1024 Sobol | light / BRDF, MB | time |\n' \
    "$material" "$probe"
  printf '|---|---|---|---|---|---|---|\n'
  mis_time=1 light_bytes=0 brdf_bytes=0
  relvar --sampler mis >/dev/null
  mis_time=$(field thread_ns_per_sample "$work/out.json")
  row mis --sampler mis
  table_row "wais: 64², 16² orientations, 16 × 32 rolls, 10 %/5 % by L2" wais 64 16 16 32 \
    "--criterion l2 $k64" "--criterion l2 $b64"
  table_row "… by variance" wais 64 16 16 32 "$k64" "$b64"
  table_row "… and 32² orientations, 32 × 64 rolls" wais 64 32 32 64 "$k64" "$b64"
  table_row "… and 64² orientations, 64 × 128 rolls" wais 64 64 64 128 "$k64" "$b64"
  table_row "… 32² by L2" wais 64 32 32 64 "--criterion l2 $k64" "--criterion l2 $b64"
  table_row "… 32² by variance, and 128² maps" wais 128 32 32 64 "$k128" "$b128"
  table_row "… and reachable throughout: product-table" product-table 128 32 32 64 "$k128" "$b128"
  table_row "… and nearly nothing dropped" product-table 128 32 32 64 "--tolerance 0.0005" \
    "--tolerance 0.0005"
  product_row "one frame, rotated look-ups: product, light 128², BRDF 128²" 128 128
  product_row "… light 256², BRDF 256²" 256 256
  product_row "… light 512², BRDF 512²" 512 512
  product_row "… light 1024², the default" 1024 512
  product_row "… and a bound of 0.003" 1024 512 --product-variance 0.003 --product-leaves 65536
  scene "$material" "$probe" "$world" "$lobes"
  light_bytes=$(bytes_of "$world") brdf_bytes=0
  row "pps" --sampler pps
}

bias() {
  local film=8x8
  begin --spp 65536
  printf '\n%s under %s:\n\n| | 4096 | 65536 |\n|---|---|---|\n' "$material" "$probe"
  bias_row mis --sampler mis
  table_scene 64 16 16 32 "--criterion l2 $k64" "--criterion l2 $b64"
  bias_row "wais: 64², 16² orientations, by L2" --sampler wais
  bias_row "the same tables, product-table" --sampler product-table
  table_scene 64 32 32 64 "--criterion l2 $k64" "--criterion l2 $b64"
  bias_row "wais: 64², 32² orientations, by L2" --sampler wais
  table_scene 64 32 32 64 "$k64" "$b64"
  bias_row "wais: 64², 32² orientations, by variance" --sampler wais
}

for part in $what; do
  for probe in $probes; do
    for material in $materials; do
      "$part"
    done
  done
done
