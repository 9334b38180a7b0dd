#!/usr/bin/env bash
# Checks what make was given for the pipeline's goals, and prints it as one line of words key=value that
# steps.sh reads. A character other than letters, digits and / . _ - is written as + and two hexadecimal
# digits. If anything is wrong, prints one sentence and exits with 1; writes no file.
# Usage, by Makefile: make_pid=… calling_folder=… BRDF=… PROBE=… OUT=… … bash settings.sh [GOAL…]
set -euo pipefail
export LC_ALL=C
: "${make_pid:?}" "${calling_folder=}"
here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd -P)

refuse() {
  printf '%s\n' "$*"
  exit 1
}

# put KEY VALUE…: adds one word for each value.
words=
put() {
  local key=$1 value encoded i
  shift
  for value; do
    encoded=$value
    if [[ $value == *[!A-Za-z0-9/._-]* ]]; then
      encoded=
      for ((i = 0; i < ${#value}; ++i)); do
        case ${value:i:1} in
        [A-Za-z0-9/._-]) encoded+=${value:i:1} ;;
        *) printf -v encoded '%s+%02X' "$encoded" "'${value:i:1}" ;;
        esac
      done
    fi
    words+="$key=$encoded "
  done
}

# split LIST TEXT: the words of the text into the array LIST. A backslash makes a blank part of a word.
split() {
  # shellcheck disable=SC2162 # without -r for the sake of the backslashes
  IFS=$' \t\n' read -d '' -a "$1" <<<"$2" || true
}

# text NAME: a variable's value, with $ for $$ as always with make; empty if it is all blanks.
text() {
  local value=${!1:-}
  value=${value//'$$'/'$'}
  [[ $value == *[![:space:]]* ]] || value=
  printf '%s' "$value"
}

# path VARIABLE NAME DEFAULT: sets the variable to the value of NAME, which is one path.
path() {
  local value=${!2:-}
  value=${value//'$$'/'$'}
  [[ $value == *[![:space:]]* ]] || value=$3
  [[ $value != *$'\n'* ]] || refuse "$2 contains a line break"
  [[ $value != *'\ '* ]] || refuse "$2: a blank in this path needs no backslash: $value"
  printf -v "$1" '%s' "$value"
}

# The folder of the last -C among make's arguments, relative to where make was called if all of them are;
# empty without -C.
folder_of_make() {
  local arguments i folder="" next
  mapfile -d '' -t arguments <"/proc/$make_pid/cmdline"
  for ((i = 1; i < ${#arguments[@]}; ++i)); do
    case ${arguments[i]} in
    --) break ;;
    --directory=?*) next=${arguments[i]#*=} ;;
    -C?*) next=${arguments[i]#-C} ;;
    -f | -I | -o | -W) i=$((i + 1)) && continue ;;
    --directory | -C | -[!-]*C) i=$((i + 1)) && next=${arguments[i]:-} ;;
    *) continue ;;
    esac
    case $next in
    /*) folder=$next ;;
    *) folder=${folder:+$folder/}$next ;;
    esac
  done
  printf '%s' "$folder"
}

# all_exist FOLDER PATH…: all relative paths name something there.
all_exist() {
  local folder=$1 name
  shift
  for name; do
    [[ $name == /* || -e $folder/$name ]] || return 1
  done
}

# find_caller PATH…: sets `caller` to the folder that relative paths count from. Without -C that is the
# current folder. With -C make has left it, and $PWD may be stale or missing. The other candidate is the current
# folder of the process that called make. If that one is OLDPWD, a shell has left it in `cd x && make …` and make
# has replaced the shell. The paths must exist in the right folder.
find_caller() {
  local folder parent candidate fitting=()
  folder=$(folder_of_make)
  if [ -z "$folder" ]; then
    caller=$(pwd -P)
    return
  fi
  parent=$(sed -n 's/^PPid:[[:space:]]*//p' "/proc/$make_pid/status")
  parent=$(readlink "/proc/$parent/cwd" || true)
  caller=
  for candidate in "$calling_folder" "$parent"; do
    [[ $candidate == /* && -d $candidate ]] || continue
    [[ $folder == /* || $candidate/$folder -ef . ]] || continue
    [ -z "$caller" ] || [ ! "$candidate" -ef "$caller" ] || continue
    caller=${caller:-$candidate}
    ! all_exist "$candidate" "$@" || fitting+=("$candidate")
  done
  caller=${fitting[0]:-$caller}
  [ -n "$caller" ] || refuse "The folder that make was called in is unknown: use absolute paths"
  if [ "${OLDPWD:-}" -ef "$parent" ]; then
    [ "$caller" -ef "$calling_folder" ] ||
      refuse "Relative paths do not count from $parent, and \$PWD is missing or wrong: use absolute paths"
  elif [ ${#fitting[@]} -gt 1 ]; then
    refuse "Relative paths may count from ${fitting[0]} (\$PWD) or ${fitting[1]}: use absolute paths"
  fi
  caller=$(cd -- "$caller" && pwd -P)
}

# absolute PATH
absolute() {
  case $1 in
  /*) printf '%s' "$1" ;;
  *) printf '%s' "$caller/$1" ;;
  esac
}

# name_of VARIABLE FILE: without folder and extension, and for BRDFs without .zst.
name_of() {
  local name=${2##*/}
  [ "$1" = PROBE ] || name=${name%.zst}
  printf '%s' "${name%.*}"
}

# claim SUBJECT OUTPUT…: no two things may have one output, nor may a source be one.
declare -A subject_of
claim() {
  local subject=$1 output
  shift
  for output; do
    [ -z "${subject_of[$output]:-}" ] ||
      refuse "${subject_of[$output]} and $subject have one output, OUT/$output: rename a file"
    subject_of[$output]=$subject
  done
}

# check_source VARIABLE FILE: exists, and lies neither in a folder of OUT that is written to nor at an output.
check_source() {
  local file=$2 place relative
  [ -e "$file" ] || refuse "$1: $file: no such file (a blank in a name is written as '\\ ' in a list)"
  [ -f "$file" ] || refuse "$1: $file: not a file"
  [ -r "$file" ] || refuse "$1: $file: cannot be read"
  for place in "$(realpath -- "$(dirname -- "$file")")/${file##*/}" "$(realpath -- "$file")"; do
    for folder in brdf probe scene .made; do
      [[ $place != "$(realpath -m -- "$out/$folder")"/* ]] ||
        refuse "$1: $file: sources may not lie in OUT/$folder, where outputs are written"
    done
    relative=${place#"$(realpath -m -- "$out")"/}
    [ -z "${subject_of[$relative]:-}" ] || refuse "$1: $file: would be overwritten by an output"
  done
}

# check_programs NAME…
check_programs() {
  local name
  for name; do
    [ -x "$bin/$name" ] || refuse "BIN: $bin/$name: no such program; build it first (bash pipelines/demo.sh does)"
  done
}

# put_sources VARIABLE KEY FILE…: words NAME/PATH/OF/FILE.
put_sources() {
  local variable=$1 key=$2 file
  shift 2
  for file; do
    put "$key" "$(name_of "$variable" "$file")$file"
  done
}

# Of a list of files: absolute paths into the array FILES and names into NAMES, all names different.
# files_and_names VARIABLE WORD…
files_and_names() {
  local variable=$1 word file name
  local -A file_of
  shift
  files=() names=()
  for word; do
    file=$(absolute "$word")
    name=$(name_of "$variable" "$file")
    [ -n "$name" ] || refuse "$variable: $file: has no name before its extension"
    [[ $file != *$'\n'* ]] || refuse "$variable: the current folder's name contains a line break"
    [ -z "${file_of[$name]:-}" ] || refuse "$variable: ${file_of[$name]} and $file have the same base name"
    file_of[$name]=$file
    files+=("$file")
    names+=("$name")
  done
}

# The goals all, pictures and trees: checks and puts the sources.
check_pipeline() {
  local files names brdf_files brdf_names probe_files probe_names brdf probe kind file
  [ ${#brdf_words[@]} -gt 0 ] ||
    refuse 'BRDF is not set: name at least one MERL file, as in BRDF="a.binary b.binary.zst"'
  [ ${#probe_words[@]} -gt 0 ] || refuse "PROBE is not set: name at least one probe image, as in PROBE=x.hdr"
  files_and_names BRDF "${brdf_words[@]}"
  brdf_files=("${files[@]}") brdf_names=("${names[@]}")
  files_and_names PROBE "${probe_words[@]}"
  probe_files=("${files[@]}") probe_names=("${names[@]}")
  for kind in "" ${tables:+.table}; do
    for brdf in "${brdf_names[@]}"; do
      claim "BRDF $brdf" "brdf/$brdf$kind.haar" "brdf/$brdf$kind.txt" \
        ${keep_maps:+"brdf/$brdf$kind.exr" "brdf/$brdf$kind.maps.txt"}
    done
    for probe in "${probe_names[@]}"; do
      claim "PROBE $probe" "probe/$probe$kind.haar" "probe/$probe$kind.txt" \
        ${keep_maps:+"probe/$probe$kind.exr" "probe/$probe$kind.maps.txt"}
    done
  done
  for brdf in "${brdf_names[@]}"; do
    claim "BRDF $brdf" "brdf/$brdf.binary"
    for probe in "${probe_names[@]}"; do
      claim "BRDF $brdf under PROBE $probe" "$brdf-$probe.exr" "$brdf-$probe.png" "$brdf-$probe.txt"
    done
  done
  for file in "${brdf_files[@]}"; do check_source BRDF "$file"; done
  for file in "${probe_files[@]}"; do check_source PROBE "$file"; done
  check_source SCENE "$scene"
  [ -n "$tables" ] || ! grep -qE '@(BRDF|PROBE)_TABLE@' -- "$scene" ||
    refuse "SCENE: $scene: uses tables: set TABLES=1"
  check_programs brdf2maps probe2maps haarrender ${keep_maps:+maps2haar}
  put_sources BRDF brdf "${brdf_files[@]}"
  put_sources PROBE probe "${probe_files[@]}"
}

# Values that are not set get their defaults here.
goals=" ${*:-pictures} " # with blanks around each
for lone in gallery readme; do
  [[ $goals != *" $lone "* || $goals == " $lone " ]] || refuse "Make $lone without other goals"
done
out='' bin='' scene='' pictures='' sheet='' brdf_words=() probe_words=() default_out=''
case $goals in
" gallery " | " readme ") default_out=$here/out/${goals//[[:space:]]/} spp=128 ;;
esac
path out OUT "$default_out"
[ -n "$out" ] || refuse "OUT is not set: name the folder for the results"
# On, unless empty or 0.
tables=$(text TABLES) && tables=${tables#0}
keep_maps=$(text KEEP_MAPS) && keep_maps=${keep_maps#0}
path bin BIN "$here/../build/release/bin"
path scene SCENE "$here/scenes/sphere${tables:+_tables}.json"
path pictures PICTURES "$here/pictures"
path sheet SHEET ""
split brdf_words "$(text BRDF)"
split probe_words "$(text PROBE)"

required=("$bin")
case $goals in
*" pictures "* | *" trees "* | *" all "*) required+=("$scene" "${brdf_words[@]}" "${probe_words[@]}") ;;
*" clean "*) required=("$out") ;;
esac
for word in "${required[@]}" "$out" "$pictures" "$sheet"; do
  [[ $word == /* || -z $word ]] || { find_caller "${required[@]}" && break; }
done
out=$(absolute "$out")
[ ! -e "$out" ] || [ -d "$out" ] || refuse "OUT: $out: not a folder"
bin=$(absolute "$bin")
scene=$(absolute "$scene")

put here "$here"
put out "$out"
put bin "$bin"
put scene "$scene"
put pictures "$(absolute "$pictures")"
put sheet "${sheet:+$(absolute "$sheet")}"
sampler=$(text SAMPLER) && put sampler "${sampler:-product}"
given=$(text SPP) && put spp "${given:-${spp:-16}}"
threads=$(text THREADS) && put threads "$threads"
put tables ${tables:+yes}
put keep_maps ${keep_maps:+yes}
for name in BRDF_FLAGS PROBE_FLAGS HAAR_FLAGS RENDER_FLAGS BRDF_TABLE_FLAGS PROBE_TABLE_FLAGS; do
  flags=()
  split flags "$(text "$name")"
  [ ${#flags[@]} -gt 0 ] || case $name in
  BRDF_TABLE_FLAGS) flags=(--size 64 --theta 32 --roll 64) ;;
  PROBE_TABLE_FLAGS) flags=(--size 64 --orientations 32) ;;
  esac
  put "${name,,}" "${flags[@]}"
done
case $goals in
*" pictures "* | *" trees "* | *" all "*) check_pipeline ;;
esac
printf '%s\n' "$words"
