# shellcheck shell=bash disable=SC2154 # the scripts set the variables named here
# Shared by the ablation scripts, to be sourced: $bin, $data_brdf, $data_probe and $work must be set.
# What it makes stays in $work and is not made again, so that a run can be taken up and renewed.

film=${FILM:-64x64}

# make_once FILE COMMAND…: runs `COMMAND… -o FILE` unless the file is there.
make_once() {
  local file=$1
  shift
  [ -s "$file" ] || "$@" -q -o "$file" >/dev/null || [ -s "$file" ]
}

brdf_file() { echo "$data_brdf/$1.binary"; }
probe_file() { echo "$data_probe/$1.hdr"; }

# field NAME FILE: the number of a name in one of the programs' JSON.
field() { sed -n "s/^ *\"$1\": \([-0-9.e+]*\),\{0,1\}$/\1/p" "$2" | head -n 1; }

# compute EXPRESSION FORMAT
compute() { awk "BEGIN { printf \"$2\", $1 }"; }

# scene MATERIAL PROBE LIGHT_HAAR BRDF_HAAR [LIGHT_TABLE BRDF_TABLE]: writes $work/scene.json, a
# sphere without background. Angular probes are named as such.
scene() {
  local light_table=${5:+", \"table\": \"$5\""} brdf_table=${6:+", \"table\": \"$6\""} mapping=""
  case $2 in *angular* | *_probe) mapping=', "mapping": "angular"' ;; esac
  cat >"$work/scene.json" <<JSON
{"film": {"width": 64, "height": 64},
 "camera": {"type": "orthographic", "from": [0, 0, 5], "to": [0, 0, 0], "up": [0, 1, 0], "height": 2.2},
 "light": {"probe": "$(probe_file "$2")", "haar": "$3"$light_table$mapping, "background": false},
 "materials": {"m": {"brdf": "$(brdf_file "$1")", "haar": "$4"$brdf_table}},
 "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "m"}]}
JSON
}

# render OPTIONS…: renders $work/scene.json; leaves $work/out.exr and $work/out.json.
render() {
  "$bin/haarrender" "$work/scene.json" -q --json --size "$film" -o "$work/out.exr" "$@" \
    >"$work/out.json"
}

# relvar OPTIONS…: relative variance per sample with random points.
relvar() {
  render --points random --spp 64 "$@"
  field relative_variance_per_sample "$work/out.json"
}

# picture_error REFERENCE.exr: relative error of $work/out.exr, over all pixels of the film.
picture_error() {
  "$bin/haarsheet" "$work/out.exr" --reference "$1" -q --json -o "$work/sheet.png" >"$work/sheet.json"
  field relative_error "$work/sheet.json"
}

bytes_of() { stat -L -c %s "$1"; }
