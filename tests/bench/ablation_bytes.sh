#!/usr/bin/env bash
# The gain of `product` over `mis` against bytes and leaves, as Markdown: gain = relative variance per
# sample of mis over that of product, random points, 64 a pixel, unoccluded sphere.
#
#   tests/bench/ablation_bytes.sh BIN BRDF_FOLDER PROBE_FOLDER WORK [curves] [kept]
#
# curves: tolerances of light and BRDF, map sizes, leaves and variance bounds, one varied at a time,
#         for MATERIALS × PROBES
# kept:   what share of the ideal gain the defaults keep, and what fits LIGHT_MB mapped per probe and
#         BRDF_MB per BRDF, for all of ALL_MATERIALS × ALL_PROBES. Ideal: light at 1024², BRDF at 512²,
#         nothing dropped, a bound of 0.003.
# Both without either word. Names of files are without .binary and .hdr; WORK keeps what was made,
# about 1 GB. The first run takes about half an hour.
set -euo pipefail
if [ $# -lt 4 ]; then
  echo "usage: ablation_bytes.sh BIN BRDF_FOLDER PROBE_FOLDER WORK [curves] [kept]" >&2
  exit 2
fi
bin=$(realpath "$1") data_brdf=$(realpath "$2") data_probe=$(realpath "$3")
mkdir -p "$4"
work=$(realpath "$4")
what=${*:5}
what=${what:-curves kept}
materials=${MATERIALS:-violet-acrylic gold-paint chrome}
probes=${PROBES:-grace_probe rnl_probe}
all_materials=${ALL_MATERIALS:-chrome gold-paint nickel-noise5 pink-felt red-metallic-paint red-plastic violet-acrylic}
all_probes=${ALL_PROBES:-grace_probe rnl_probe studio_small_03_angular_256 venice_sunset_angular_256}
light_limit=$((${LIGHT_MB:-40} * 1000000)) brdf_limit=$((${BRDF_MB:-5} * 1000000))
source "$(dirname "${BASH_SOURCE[0]}")/ablation_lib.sh"
ideal_options=(--product-variance 0.003 --product-leaves 65536)
base_options=(--product-variance 0.03)

# light PROBE SIZE TOLERANCE / brdf MATERIAL SIZE TOLERANCE: make trees, set `made`.
light() {
  made="$work/$1-$2-$3.haar"
  make_once "$made" "$bin/probe2maps" "$(probe_file "$1")" --size "$2" --tolerance "$3" \
    --conservation-tolerance 1 --mapping "$(mapping_of "$1")"
}
brdf() {
  made="$work/$1-$2-$3.haar"
  make_once "$made" "$bin/brdf2maps" "$(brdf_file "$1")" --size "$2" --tolerance "$3" \
    --conservation-tolerance 1
}

mapping_of() {
  case $1 in *angular* | *_probe) echo angular ;; *) echo auto ;; esac
}

# load MATERIAL PROBE LIGHT_SIZE LIGHT_TOLERANCE BRDF_SIZE BRDF_TOLERANCE: the scene of these trees;
# sets light_bytes and brdf_bytes.
load() {
  local light_file
  light "$2" "$3" "$4"
  light_file=$made
  brdf "$1" "$5" "$6"
  light_bytes=$(bytes_of "$light_file") brdf_bytes=$(bytes_of "$made")
  scene "$1" "$2" "$light_file" "$made"
}

# curve NAME LIGHT_SIZE LIGHT_TOLERANCE BRDF_SIZE BRDF_TOLERANCE OPTIONS…: a line for the material and
# probe at hand, of $mis.
curve() {
  local variance
  load "$material" "$probe" "${@:2:4}"
  case " ${*:6} " in *" --product-variance "*) ;; *) set -- "$@" "${base_options[@]}" ;; esac
  variance=$(relvar --sampler product "${@:6}")
  printf '| %s | %s | %s | %.0f | %.3g | %.1f |\n' "$1" "$(compute "$light_bytes / 1e6" %.2f)" \
    "$(compute "$brdf_bytes / 1e6" %.2f)" "$(field leaves_per_product "$work/out.json")" "$variance" \
    "$(compute "$mis / $variance" %g)"
}

curves() {
  local tolerance size leaves bound
  load "$material" "$probe" 1024 0.0001 512 0.0005
  mis=$(relvar --sampler mis)
  printf '\n%s under %s, mis %.3g:\n\n' "$material" "$probe" "$mis"
  printf '| | light, MB | BRDF, MB | leaves | variance | gain |\n|---|---|---|---|---|---|\n'
  curve "base" 1024 0.0001 512 0.0005
  curve "ideal" 1024 0 512 0 "${ideal_options[@]}"
  for tolerance in 0 0.00003 0.0003 0.001 0.003; do
    curve "light tolerance $tolerance" 1024 $tolerance 512 0.0005
  done
  for size in 256 512; do
    curve "light ${size}², tolerance 0" $size 0 512 0.0005
  done
  for tolerance in 0 0.0001 0.002 0.008; do
    curve "BRDF tolerance $tolerance" 1024 0.0001 512 $tolerance
  done
  for size in 128 256; do
    curve "BRDF ${size}²" 1024 0.0001 $size 0.0005
  done
  for leaves in 96 192 384 768; do
    curve "at most $leaves leaves" 1024 0.0001 512 0.0005 --product-leaves $leaves
  done
  for bound in 0.003 0.01 0.1 0.3; do
    curve "variance bound $bound" 1024 0.0001 512 0.0005 --product-variance $bound \
      --product-leaves 65536
  done
}

# fitting KIND NAME SIZE LIMIT: the least tolerance of a few whose file fits; sets `fits`.
fitting() {
  for fits in 0 0.0001 0.0005 0.0006 0.0008 0.001 0.002 0.004; do
    "$1" "$2" "$3" "$fits"
    [ "$(bytes_of "$made")" -gt "$4" ] || return 0
  done
}

# kept_row: a line for the material and probe at hand; adds to $work/kept.txt.
kept_row() {
  local mis ideal default fitted tight tightest light_fits
  load "$material" "$probe" 1024 0 512 0
  mis=$(relvar --sampler mis)
  ideal=$(relvar --sampler product "${ideal_options[@]}")
  load "$material" "$probe" 0 0.0001 0 0.0005 # sizes as they are by default
  default=$(relvar --sampler product)
  fitting light "$probe" 1024 "$light_limit"
  light_fits=$fits
  fitting brdf "$material" 512 "$brdf_limit"
  load "$material" "$probe" 1024 "$light_fits" 512 "$fits"
  fitted=$(relvar --sampler product)
  tight=$(relvar --sampler product --product-variance 0.01 --product-leaves 65536)
  tightest=$(relvar --sampler product "${ideal_options[@]}")
  printf '| %s | %s | %.3g | %.3g | %.1f | %.3g = %.0f %% | %s + %s | %.3g = %.0f %% | %.3g = %.0f %% | %.3g = %.0f %% |\n' \
    "$material" "$probe" "$mis" "$ideal" "$(compute "$mis / $ideal" %g)" \
    "$default" "$(compute "100 * $ideal / $default" %g)" \
    "$(compute "$light_bytes / 1e6" %.2f)" "$(compute "$brdf_bytes / 1e6" %.2f)" \
    "$fitted" "$(compute "100 * $ideal / $fitted" %g)" \
    "$tight" "$(compute "100 * $ideal / $tight" %g)" \
    "$tightest" "$(compute "100 * $ideal / $tightest" %g)"
  echo "$ideal $default $fitted $tight $tightest" >>"$work/kept.txt"
}

# median COLUMN: of the shares of the ideal gain, per cent.
median() {
  awk -v c="$1" '{ print 100 * $1 / $c }' "$work/kept.txt" | sort -g |
    awk '{ v[NR] = $1 } END { printf "%.0f", (v[int((NR + 1) / 2)] + v[int((NR + 2) / 2)]) / 2 }'
}

kept() {
  : >"$work/kept.txt"
  printf '\n| BRDF | probe | mis | ideal | gain | defaults | fitted, MB | fitted | … bound 0.01 | … bound 0.003 |\n'
  printf '|---|---|---|---|---|---|---|---|---|---|\n'
  for probe in $all_probes; do
    for material in $all_materials; do
      kept_row
    done
  done
  printf '\nMedian share of the ideal gain: defaults %s %%, fitted %s %%, with bound 0.01 %s %%, with 0.003 %s %%.\n' \
    "$(median 2)" "$(median 3)" "$(median 4)" "$(median 5)"
}

for part in $what; do
  if [ "$part" = curves ]; then
    for probe in $probes; do
      for material in $materials; do
        curves
      done
    done
  else
    kept
  fi
done
