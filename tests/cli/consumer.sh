#!/usr/bin/env bash
# cmake --install, then find_package(haarlight) from another project, whose program must run; the installed
# programs must run as well. Usage: consumer.sh BUILD_FOLDER SOURCE_FOLDER
set -euo pipefail
build=$1
source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cmake --install "$build" --prefix "$work/prefix" >/dev/null
cmake -S "$source/tests/consumer" -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_PREFIX_PATH="$work/prefix" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
cmake --build "$work/build" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
"$work/build/consumer"
cd "$work"
for tool in brdfsynth probesynth brdf2maps probe2maps maps2haar haarinfo haarrender haarsheet haarbench; do
  "$work/prefix/bin/$tool" --version
done
"$work/prefix/bin/probesynth" --scene studio --size 64 -o studio.hdr >/dev/null
"$work/prefix/bin/probe2maps" studio.hdr -o studio.haar >/dev/null
"$work/prefix/bin/brdfsynth" --model ggx -o ggx.binary >/dev/null
"$work/prefix/bin/brdf2maps" ggx.binary --size 64 --theta 8 --conservation-tolerance 1 -o ggx.haar >/dev/null
"$work/build/example" studio.haar ggx.haar
# The README shows the example as it is compiled.
# shellcheck disable=SC2016
if ! diff <(sed -n '/^```cpp$/,/^```$/p' "$source/README.md" | sed '1d;$d') "$source/tests/consumer/example.cpp"; then
  echo "FAILED: README.md shows another example than tests/consumer/example.cpp"
  exit 1
fi
"$work/prefix/bin/haarinfo" studio.haar --validate
"$work/prefix/bin/haarinfo" studio.haar --image studio.exr >/dev/null
"$work/prefix/bin/probe2maps" studio.exr --mapping octahedral -o again.haar >/dev/null
# No installed file may point back to where it was built.
if grep -rlF "$source" "$work/prefix" --include='*.cmake' --include='*.h'; then
  echo "FAILED: installed files name the source folder"
  exit 1
fi
