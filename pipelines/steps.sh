# shellcheck shell=bash
# What the recipes of Makefile, gallery.mk and readme.mk call. Reads `settings`, as settings.sh prints it, into
# variables of these names. Everything runs in the folder OUT, and names of outputs are relative to it.
set -euo pipefail
export LC_ALL=C
unset CDPATH

# shellcheck disable=SC2034 # the recipes use here, pictures and sheet
here='' out='' bin='' scene='' pictures='' sheet='' sampler='' spp='' threads='' tables='' keep_maps=''
brdf_flags=() probe_flags=() haar_flags=() render_flags=() brdf_table_flags=() probe_table_flags=()

# decode VARIABLE WORD
decode() { printf -v "$1" '%b' "${2//+/\\x}"; }

read_settings() {
  local word key value
  # shellcheck disable=SC2154 # make exports it
  for word in $settings; do
    key=${word%%=*}
    decode value "${word#*=}"
    case $key in
    brdf | probe) ;;
    *_flags)
      local -n list=$key
      list+=("$value")
      ;;
    *) printf -v "$key" '%s' "$value" ;;
    esac
  done
  if [ -z "$threads" ]; then
    threads=0
    [[ " ${MAKEFLAGS%% -- *}" != *" -j"* ]] || threads=1
  fi
}
read_settings

fail() {
  printf 'pipeline: %s\n' "$*" >&2
  exit 1
}

# identity FILE…: changes when a file does. A link counts as what it points to.
identity() { stat -L -c '%.9Y %s %n' -- "$@"; }

# update OUTPUT… -- INPUT… -- COMMAND ARGUMENT…: runs the command unless the outputs are as the same command,
# with the same inputs and program, left them. The command is a program in BIN, or any other. If the last output
# ends in .txt, it receives stdout. The record of the first output holds its subject, the outputs' names, the
# command, and the identities of inputs and outputs; the outputs' identities are written last, so that an
# interrupted command counts as not run.
subject=
update() {
  local outputs=() inputs=() command record header expected report=/dev/null code=0 owner output
  while [ "$1" != -- ]; do outputs+=("$1") && shift; done && shift
  while [ "$1" != -- ]; do inputs+=("$1") && shift; done && shift
  command=("$@")
  if [ -x "$bin/$1" ]; then
    inputs+=("$bin/$1")
    command=("$bin/$1" "${@:2}" --quiet --threads "$threads")
  fi
  mkdir -p -- "$out"
  cd -- "$out"
  record=.made/${outputs[0]#./}
  header=$(printf '%s\n' "for $subject" "${outputs[@]/#/made }")
  expected=$header$'\n'$(printf ' %q' "$@" && printf '\n' && identity "${inputs[@]}")
  if [ -f "$record" ]; then
    [ "$(<"$record")" != "$expected"$'\n'"$(identity "${outputs[@]}" 2>/dev/null)" ] || return 0
    IFS= read -r owner <"$record" || true
    [ -z "$owner" ] || [ "$owner" = "for $subject" ] ||
      fail "$out/${outputs[0]#./}: was made ${owner}, not for $subject; remove it with $out/$record, or use another OUT"
  else
    for output in "${outputs[@]}"; do
      [ ! -e "$output" ] && [ ! -L "$output" ] ||
        fail "$out/${output#./}: was not made here and is not overwritten; remove it, or use another OUT"
    done
  fi

  [[ ${MAKEFLAGS-} =~ ^[a-zA-Z]*s ]] || declare -F "$1" >/dev/null || { printf '%q ' "${command[@]}" && echo; }
  for output in "${outputs[@]}" "$record"; do mkdir -p -- "$(dirname -- "$output")"; done
  printf '%s\n' "$header" >"$record"
  [[ ${outputs[-1]} != *.txt ]] || report=.made/report.$$
  trap 'rm -f ".made/report.$$" ".made/unpacked.$$"' EXIT
  "${command[@]}" >"$report" || code=$?
  if [ "$code" -ne 0 ]; then
    identity "${outputs[0]}" >/dev/null 2>&1 || rm -f -- "$record"
    exit "$code"
  fi
  [ "$report" = /dev/null ] || mv -f -- "$report" "${outputs[-1]}"
  printf '%s\n' "$expected" "$(identity "${outputs[@]}")" >"$record"
}

# publish OUTPUT FILE: copies an output to a file that the user named, unless they are equal.
publish() {
  ! cmp -s -- "$1" "$2" || return 0
  mkdir -p -- "$(dirname -- "$2")"
  cp -- "$1" "$2.part.$$" && mv -f -- "$2.part.$$" "$2"
}

# take_source FILE OUTPUT: unpacked, or as a link.
take_source() {
  case $1 in
  *.zst)
    zstd -q -d "$1" -o ".made/unpacked.$$" && mv -f -- ".made/unpacked.$$" "$2"
    ;;
  *) ln -sfn -- "$1" "$2" ;;
  esac
}

# split_word WORD: sets `name` and `file` from NAME/PATH/OF/FILE.
split_word() {
  decode name "${1%%/*}"
  decode file "/${1#*/}"
}

# brdf_source WORD
brdf_source() {
  local name file
  split_word "$1"
  subject="BRDF $name"
  update "brdf/$name.binary" -- "$file" -- take_source "$file" "brdf/$name.binary"
}

# tree STEM SOURCE PROGRAM FLAG…: STEM.haar, directly or from an EXR file of the same name.
tree() {
  local stem=$1 source=$2
  shift 2
  if [ -z "$keep_maps" ]; then
    update "$stem.haar" "$stem.txt" -- "$source" -- "$1" "$source" -o "$stem.haar" "${@:2}" "${haar_flags[@]}"
  else
    update "$stem.exr" "$stem.maps.txt" -- "$source" -- "$1" "$source" -o "$stem.exr" "${@:2}"
    update "$stem.haar" "$stem.txt" -- "$stem.exr" -- maps2haar "$stem.exr" -o "$stem.haar" "${haar_flags[@]}"
  fi
}

# brdf_tree maps|table WORD
brdf_tree() {
  local name file
  split_word "$2"
  subject="BRDF $name"
  case $1 in
  maps) tree "brdf/$name" "brdf/$name.binary" brdf2maps "${brdf_flags[@]}" ;;
  table) tree "brdf/$name.table" "brdf/$name.binary" brdf2maps "${brdf_table_flags[@]}" ;;
  esac
}

# probe_tree maps|table WORD
probe_tree() {
  local name file
  split_word "$2"
  subject="PROBE $name"
  case $1 in
  maps) tree "probe/$name" "$file" probe2maps "${probe_flags[@]}" ;;
  table) tree "probe/$name.table" "$file" probe2maps "${probe_table_flags[@]}" ;;
  esac
}

# json_text TEXT: as it stands between the quotes of a JSON string.
json_text() {
  local text=$1 code character escape
  text=${text//\\/\\\\}
  text=${text//\"/\\\"}
  for ((code = 1; code < 32; ++code)); do
    printf -v escape '\\u%04x' "$code"
    printf -v character '%b' "\\x${escape: -2}"
    text=${text//"$character"/"$escape"}
  done
  printf '%s' "$text"
}

# fill_scene TEMPLATE OUTPUT BRDF_NAME PROBE_NAME PROBE_FILE: in one pass, as a name may look like a placeholder.
fill_scene() {
  local rest filled="" value
  rest=$(<"$1")
  while [[ $rest =~ @(BRDF|BRDF_HAAR|BRDF_TABLE|PROBE|PROBE_HAAR|PROBE_TABLE)@ ]]; do
    case ${BASH_REMATCH[1]} in
    BRDF) value=../brdf/$3.binary ;;
    BRDF_HAAR) value=../brdf/$3.haar ;;
    BRDF_TABLE) value=../brdf/$3.table.haar ;;
    PROBE) value=$5 ;;
    PROBE_HAAR) value=../probe/$4.haar ;;
    PROBE_TABLE) value=../probe/$4.table.haar ;;
    esac
    filled+=${rest%%"${BASH_REMATCH[0]}"*}$(json_text "$value")
    rest=${rest#*"${BASH_REMATCH[0]}"}
  done
  printf '%s\n' "$filled$rest" >"$2"
}

# picture BRDF_WORD PROBE_WORD: depends on the files that the scene names.
picture() {
  local name file brdf probe pair template inputs
  split_word "$1"
  brdf=$name
  split_word "$2"
  probe=$name
  pair=$brdf-$probe
  subject="BRDF $brdf under PROBE $probe"
  update "scene/$pair.json" -- "$scene" -- \
    fill_scene "$scene" "scene/$pair.json" "$brdf" "$probe" "$file"
  template=$(<"$scene")
  inputs=("scene/$pair.json")
  [[ $template != *@BRDF@* ]] || inputs+=("brdf/$brdf.binary")
  [[ $template != *@BRDF_HAAR@* ]] || inputs+=("brdf/$brdf.haar")
  [[ $template != *@BRDF_TABLE@* ]] || inputs+=("brdf/$brdf.table.haar")
  [[ $template != *@PROBE@* ]] || inputs+=("$file")
  [[ $template != *@PROBE_HAAR@* ]] || inputs+=("probe/$probe.haar")
  [[ $template != *@PROBE_TABLE@* ]] || inputs+=("probe/$probe.table.haar")
  update "./$pair.exr" "./$pair.png" "./$pair.txt" -- "${inputs[@]}" -- \
    haarrender "scene/$pair.json" -o "./$pair.exr" --image "./$pair.png" --sampler "$sampler" --spp "$spp" \
    "${render_flags[@]}"
}

# clean: removes what has a record in a folder of OUT; pictures, directly in OUT, are results and stay.
clean() {
  local records record line file
  [ -d "$out/.made" ] || return 0
  cd -- "$out"
  mapfile -d '' -t records < <(find .made -mindepth 2 -type f -print0)
  for record in "${records[@]}"; do
    while IFS= read -r line; do
      [[ $line == "made "* ]] || continue
      file=${line#made }
      rm -f -- "$file"
      [[ $file != */* ]] || rmdir -p --ignore-fail-on-non-empty -- "${file%/*}" 2>/dev/null || true
    done <"$record"
    rm -f -- "$record"
  done
  rm -f -- .made/report.* .made/unpacked.*
  find .made -depth -type d -empty -delete
}
