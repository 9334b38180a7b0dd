#!/usr/bin/env bash
# Runs every file of a folder through every program that reads files, with limits of time and memory,
# and counts outcomes. Exit code 1 if any run ends by a signal, at the time limit, above the memory
# limit or with exit code 5, prints more than one line on an error, or leaves a partial output.
# Usage: bash tests/hostile.sh FOLDER [BUILD_FOLDER]     (default: build/release)
# Exit code 77 if the folder is absent.
set -u
folder=${1:?FOLDER is missing}
build=${2:-$(dirname "${BASH_SOURCE[0]}")/../build/release}
[ -d "$folder" ] || { echo "SKIPPED: no folder $folder"; exit 77; }
folder=$(cd "$folder" && pwd)
bin=$(cd "$build/bin" && pwd)
[ -x "$bin/limited" ] || { echo "$0: $bin/limited is missing; build the target limited"; exit 2; }
export LC_ALL=C bin
export SECONDS_MAX=10 MEBIBYTES_MAX=1024
results=$(mktemp -d)
export results
trap 'rm -rf "$results"' EXIT

# A scene around the file, once for each thing that a scene can name.
write_scene() { # OUTPUT LIGHT MATERIAL
  cat >"$1" <<END
{"film": {"width": 8, "height": 8},
 "camera": {"type": "perspective", "from": [0, 0, 6], "to": [0, 0, 0], "up": [0, 1, 0], "fov": 30},
 "light": {$2}, "materials": {"m": {$3}},
 "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "m"}]}
END
}

# run NAME OUTPUTS TOOL ARGUMENTS…: one line "NAME OUTCOME", and complaints in $results/bad.
run() {
  local name=$1 outputs=$2 tool=$3 line outcome rss lines left complaint=""
  shift 3
  line=$("$bin/limited" "$SECONDS_MAX" "$MEBIBYTES_MAX" "$bin/$tool" "$@")
  read -r outcome rss lines <<<"$line"
  [ "$rss" -le "$MEBIBYTES_MAX" ] || outcome=over-memory
  case $outcome in
    exit-[01]) ;;
    exit-[234]) [ "$lines" -eq 1 ] || complaint="$lines lines on stderr" ;;
    *) complaint=$outcome ;;
  esac
  left=$(ls -A "$scratch")
  for output in $outputs; do
    # An output belongs to exit codes 0 and 1 only.
    case $outcome in
      exit-[01]) left=$(grep -vxF "$output" <<<"$left") ;;
    esac
  done
  [ -z "$left" ] || complaint="$complaint left: $left"
  echo "$name $outcome" >>"$results/counts.$worker"
  [ -z "$complaint" ] || echo "$name: $file: $complaint" >>"$results/bad.$worker"
  find "$scratch" -mindepth 1 -delete
}

try_file() {
  file=$1
  worker=$BASHPID
  local quoted work
  work=$(mktemp -d)
  scratch=$work/out
  mkdir "$scratch"
  cd "$scratch" || exit 1
  export TMPDIR=$work/tmp
  mkdir "$TMPDIR"
  quoted=${file//\\/\\\\}
  quoted=${quoted//\"/\\\"}
  local white='"lambert": [0.5, 0.5, 0.5]'
  write_scene "$work/probe.json" "\"probe\": \"$quoted\"" "$white"
  write_scene "$work/light.json" "\"haar\": \"$quoted\"" "$white"
  write_scene "$work/brdf.json" "\"haar\": \"$good_light\"" "\"brdf\": \"$quoted\""
  write_scene "$work/lobe.json" "\"haar\": \"$good_light\"" "\"haar\": \"$quoted\""
  run probe2maps o.exr probe2maps "$file" -q --size 32 -o o.exr
  run brdf2maps o.exr brdf2maps "$file" -q --size 8 --theta 2 -o o.exr
  run maps2haar o.haar maps2haar "$file" -q -o o.haar
  run maps2haar-unpack o.haar maps2haar "$file" -q --unpack -o o.haar
  run haarinfo "" haarinfo "$file"
  run haarinfo-validate "" haarinfo "$file" --validate
  run haarinfo-html o.html haarinfo "$file" --html o.html
  run haardiff "" haardiff "$file" "$file"
  run haarprod o.haar haarprod "$file" "$file" -o o.haar
  run haarsheet o.png haarsheet "$file" "$file" -o o.png
  run haarrender-scene o.exr haarrender "$file" -q --spp 1 -o o.exr
  run haarrender-probe o.exr haarrender "$work/probe.json" -q --spp 1 --sampler light -o o.exr
  run haarrender-light o.exr haarrender "$work/light.json" -q --spp 1 -o o.exr
  run haarrender-brdf o.exr haarrender "$work/brdf.json" -q --spp 1 --sampler brdf -o o.exr
  run haarrender-lobe o.exr haarrender "$work/lobe.json" -q --spp 1 -o o.exr
  run haarrelight-apply o.png haarrelight apply "$file" --scene "$good_scene" -q -o o.png
  [ ! -x "$bin/haarview" ] || run haarview-frame o.png haarview "$file" --frame o.png
  [ -z "$(ls -A "$TMPDIR")" ] || echo "temporaries: $file: left: $(ls -A "$TMPDIR")" >>"$results/bad.$worker"
  rm -rf "$work"
}
export -f run try_file write_scene

"$bin/probesynth" --scene studio --size 16 -q -o "$results/studio.hdr" >/dev/null
"$bin/probe2maps" "$results/studio.hdr" -q --size 16 -o "$results/light.haar" >/dev/null
export good_light=$results/light.haar good_scene=$results/scene.json
write_scene "$good_scene" "\"haar\": \"$good_light\"" '"lambert": [0.5, 0.5, 0.5]'

# shellcheck disable=SC2016
find "$folder" -type f -print0 | sort -z | xargs -0 -r -P "$(nproc)" -I{} bash -c 'try_file "$1"' try_file {}

printf '%-20s %s\n' runs outcome
cat "$results"/counts.* 2>/dev/null | sort | uniq -c | awk '
  { if (!($2 in row)) order[++n] = $2; row[$2] = row[$2] " " $3 "=" $1; total += $1 }
  END { for (i = 1; i <= n; ++i) printf "%-20s%s\n", order[i], row[order[i]]; print total + 0, "runs" }'
if cat "$results"/bad.* >"$results/all" 2>/dev/null; then
  sort "$results/all"
  echo "FAILED: $(wc -l <"$results/all") complaints"
  exit 1
fi
