#!/usr/bin/env bash
# Runs the fuzz targets of tests/fuzz, two at a time. Needs clang and its sanitizer runtime.
# Usage: bash tests/fuzz.sh MINUTES|SECONDSs|RUNSx [TARGET…]
#   MINUTES   for each target; 20s means 20 seconds, 1000000x a million executions
#   TARGET    rgbe, pfm, merl, scene, haar_mapped, haar_packed, transfer, map_set_exr (default: all)
# FUZZ_JOBS=1 runs one target at a time.
# Corpora grow in build/fuzz/corpus, inputs that fail are kept in build/fuzz/failures.
# Exit code 1 if any input crashes, leaks, takes more than 1 s of CPU time or more than 512 MiB; 77 without clang.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

duration=${1:?MINUTES, SECONDSs or RUNSx is missing}
shift
case $duration in
  *x) limit=-runs=${duration%x} ;;
  *s) limit=-max_total_time=${duration%s} ;;
  *) limit=-max_total_time=$((duration * 60)) ;;
esac
build=build/fuzz
jobs=$(nproc)

command -v clang++ >/dev/null || { echo "SKIPPED: no clang++"; exit 77; }
start=$SECONDS
cmake -S . -B $build -G Ninja -DCMAKE_CXX_COMPILER=clang++ -DHAARLIGHT_FUZZ=ON -DHAARLIGHT_TESTS=OFF >/dev/null
cmake --build $build -j "$jobs" --target fuzz >$build/build.log || { cat $build/build.log; exit 1; }
echo "built in $((SECONDS - start)) s"
mkdir -p $build/failures $build/log

# run_target NAME: prints one line of figures.
run_target() {
  local name=$1 log=$build/log/$1 dictionary=() seeds=("tests/fuzz/seeds/$1") code=0 longest=4096
  mkdir -p "$build/corpus/$name"
  [ ! -e "tests/fuzz/$name.dict" ] || dictionary=("-dict=tests/fuzz/$name.dict")
  case $name in
    haar_*) seeds+=(tests/golden) ;;
    scene) seeds+=(pipelines/scenes) longest=1536 ;;
    pfm | rgbe | merl) longest=1024 ;;
  esac
  # Without entropic scheduling, long allocation stacks and a large quarantine of freed memory, all of
  # which grow with the corpus, a target runs about twice as fast.
  ASAN_OPTIONS=malloc_context_size=4:quarantine_size_mb=8 \
    "$build/bin/fuzz_$name" "$limit" -timeout=60 -rss_limit_mb=512 -malloc_limit_mb=512 -max_len=$longest -entropic=0 \
    -reload=0 -print_final_stats=1 -artifact_prefix="$build/failures/$name-" "${dictionary[@]}" \
    "$build/corpus/$name" "${seeds[@]}" >"$log" 2>&1 || code=$?
  awk -v name="$name" '
    / cov: / { for (i = 1; i < NF; ++i) { if ($i == "cov:") cov = $(i + 1); if ($i == "corp:") corpus = $(i + 1) } }
    /stat::number_of_executed_units/ { runs = $2 }
    /stat::slowest_unit_time_sec/ { slow = $2 }
    /stat::peak_rss_mb/ { rss = $2 }
    END { printf "%-12s %9d executions, %5d edges, corpus %s, slowest %s s, peak %s MB\n", name, runs, cov, corpus, slow, rss }
  ' "$log"
  if [ "$code" -ne 0 ]; then
    echo "$name: FAILED"
    grep -E -A 12 'ERROR:|SUMMARY:|runtime error:|uncaught exception|terminate called' "$log" | head -n 40
    return 1
  fi
}
export -f run_target
export build limit

if [ $# -eq 0 ]; then
  set -- scene haar_packed map_set_exr haar_mapped transfer rgbe merl pfm
fi
# shellcheck disable=SC2016
printf '%s\n' "$@" | xargs -P "${FUZZ_JOBS:-2}" -I{} bash -c 'run_target "$1"' run_target {}
