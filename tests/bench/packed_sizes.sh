#!/usr/bin/env bash
# Size of .haar files against their error, as Markdown tables: both sets of maps, both forms.
# Usage: bash tests/bench/packed_sizes.sh A.binary…    (TOLERANCES="0.1 0.03" BIN=folder to change them)
# By mapped is meant what maps2haar makes by default, by packed what --quantize --pack makes of the
# same maps at the same bound of the relative L2 error; both hold it for every single map.
set -euo pipefail
bin=${BIN:-$(dirname "${BASH_SOURCE[0]}")/../../build/release/bin}
read -r -a tolerances <<<"${TOLERANCES:-0.1 0.05 0.03 0.02 0.01}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# field NAME: the number of that name in the last report.
field() { sed -n "s/^ *\"$1\": \([^,]*\),*$/\1/p" "$work/report" | tail -n 1; }

# size OPTIONS…: bytes of the set's maps as a .haar file; leaves the report.
size() {
  "$bin/maps2haar" "$work/maps.exr" -q --json --criterion l2 "$@" -o "$work/set.haar" >"$work/report"
  field bytes
}

# table TITLE OPTIONS…: one line for each BRDF; sizes in KB of 1000 bytes.
table() {
  local title=$1 brdf tolerance line worst
  shift
  printf '\n%s: mapped / packed KB by bound of the relative L2 error\n\n|' "$title"
  printf ' %s |' "BRDF" "${tolerances[@]}" "file / packed at 0.03" "L2 error at 0.03" "albedo error, worst map"
  printf '\n|---|'
  printf '%s---|' "${tolerances[@]}" "" "" "" | sed 's/[0-9.]*---/---/g'
  printf '\n'
  for brdf in "${files[@]}"; do
    "$bin/brdf2maps" "$brdf" -q --json "$@" -o "$work/maps.exr" >"$work/report"
    worst="$(field mean_error) $(field worst_error)"
    line="| $(basename "$brdf" .binary) |"
    for tolerance in "${tolerances[@]}"; do
      line="$line $(size --tolerance "$tolerance") $(size --tolerance "$tolerance" --quantize --pack)"
      line=$(awk -v line="$line" 'BEGIN { n = split(line, w, " "); s = w[1]
        for (i = 2; i < n - 1; ++i) s = s " " w[i]
        printf "%s %.3g / %.3g |", s, w[n - 1] / 1000, w[n] / 1000 }')
    done
    line="$line 1/$(($(stat -L -c %s "$brdf") / $(size --tolerance 0.03 --quantize --pack))) |"
    awk -v line="$line" -v l2="$(field relative_l2_error)" -v albedo="$worst" \
      'BEGIN { split(albedo, a, " "); printf "%s %.2f %% | %.3f %%, %.2f %% |\n", line, 100 * l2, 100 * a[1], 100 * a[2] }'
  done
}

files=("$@")
table "theta_r only, 64 maps of 128 x 128" --size 128
table "64 theta_r x 128 rolls of 128 x 128" --roll 128 --fold mirrors
