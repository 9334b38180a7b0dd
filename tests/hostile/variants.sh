#!/usr/bin/env bash
# Makes a folder of malformed variants of small valid files of every format, for tests/hostile.sh.
# Usage: bash tests/hostile/variants.sh OUTPUT_FOLDER [BUILD_FOLDER] [FILE…]     (default: build/release)
#   FILE   further valid files to derive variants of, for example TIFF, PNG and JPEG pictures
# Per file: cut at powers of two, at the ends of lines of a text header and near its end; bytes of the
# header set to 0, 127, 128 and 255; 32-bit numbers of the header set to extremes; bits flipped.
set -euo pipefail
output=${1:?OUTPUT_FOLDER is missing}
build=${2:-$(dirname "${BASH_SOURCE[0]}")/../../build/release}
shift $(($# < 2 ? $# : 2))
bin=$(cd "$build/bin" && pwd)
mkdir -p "$output"
output=$(cd "$output" && pwd)
extra=()
for file in "$@"; do
  extra+=("$(realpath "$file")")
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

"$bin/brdfsynth" --model ggx --diffuse 0.2,0.1,0.1 --roughness 0.4 -q -o brdf.binary >/dev/null
"$bin/probesynth" --scene studio --size 16 -q -o probe.hdr >/dev/null
"$bin/brdf2maps" brdf.binary -q --size 8 --theta 2 --conservation-tolerance 1 -o maps.exr >/dev/null
"$bin/probe2maps" probe.hdr -q --size 8 -o light.haar >/dev/null
"$bin/maps2haar" maps.exr -q -o lobe.haar >/dev/null
"$bin/maps2haar" maps.exr -q --pack -o packed.haar >/dev/null
cat >scene.json <<'END'
{"film": {"width": 4, "height": 3},
 "camera": {"type": "perspective", "from": [0, 0.5, 6], "to": [0, 0, 0], "up": [0, 1, 0], "fov": 30},
 "light": {"haar": "light.haar"}, "materials": {"floor": {"lambert": [0.5, 0.5, 0.5]}},
 "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "floor"}]}
END
"$bin/haarrender" scene.json -q --spp 1 -o picture.exr --image picture.png >/dev/null
"$bin/haarrelight" build scene.json -q --vary light --tolerance 0.3 --resolution 8 -o transfer.haar >/dev/null
printf 'PF\n2 1\n-1.0\n%24s' '' >probe.pfm

# patch FILE OFFSET BYTES: writes printf-escaped bytes into a file.
patch() { printf '%b' "$3" | dd of="$1" bs=1 seek="$2" conv=notrunc status=none; }

# variant SOURCE NAME: a copy, whose path is printed.
variant() {
  local path
  path=$output/${1%.*}-$2.${1##*.}
  cp "$1" "$path"
  chmod u+w "$path"
  echo "$path"
}

cut_file() { # SOURCE BYTES
  head -c "$2" "$1" >"$output/${1%.*}-cut-$2.${1##*.}"
}

damage() { # SOURCE
  local source=$1 size at value step
  size=$(stat -c %s "$source")
  for ((at = 1; at < size; at *= 2)); do cut_file "$source" "$at"; done
  for at in 0 $((size - 1)) $((size - 8)) $((size / 3)); do cut_file "$source" "$at"; done
  # The ends of lines and of names are the boundaries of text headers and of EXR attributes.
  for at in $(head -c 400 "$source" | grep -obUaP '[\n\x00]' | cut -d: -f1 | head -n 24); do
    cut_file "$source" $((at + 1))
  done
  head -c "$size" "$source" | cat - <(printf 'more') >"$output/${source%.*}-longer.${source##*.}"
  step=$((size > 6000 ? 16 : 4))
  for ((at = 0; at + 4 <= size && at < 160; at += step)); do
    for value in '\0\0\0\0' '\0377\0377\0377\0177' '\0377\0377\0377\0377' '\0\0\0\0200' '\0\01\0\0'; do
      patch "$(variant "$source" "word-$at-${value//[\\0]/}x")" "$at" "$value"
    done
  done
  RANDOM=1
  for ((at = 0; at < 40; ++at)); do
    local place=$(((RANDOM * 32768 + RANDOM) % size)) byte
    byte=$(od -An -tu1 -j "$place" -N 1 "$source")
    patch "$(variant "$source" "flip-$place")" "$place" "\\0$(printf '%o' $((byte ^ (1 << RANDOM % 8))))"
  done
}

for file in "${extra[@]}"; do cp "$file" .; done
for file in *; do
  if [ "$file" = brdf.binary ]; then
    # 35 MB each, so few of them.
    for at in 0 4 11 12 13 20 34992011; do cut_file "$file" "$at"; done
    patch "$(variant "$file" bins)" 0 '\0377\0377\0377\0177'
    patch "$(variant "$file" nan)" 20 '\0\0\0\0\0\0\0370\0177'
  else
    damage "$file"
  fi
done
echo "$(find "$output" -type f | wc -l) files"
