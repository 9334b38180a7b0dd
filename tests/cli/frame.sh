#!/usr/bin/env bash
# What all programs have in common: no arguments, --help, --version, wrong options, a closed stdout.
source "$(dirname "$0")/lib.sh" "$1"

tools="brdfsynth probesynth brdf2maps probe2maps maps2haar haarinfo haardiff haarrender haarrelight haarsheet haarbench"
[ ! -x "$bin/haarview" ] || tools="$tools haarview"
for tool in $tools; do
  expect 2 "$tool"
  says "--help"
  expect 2 "$tool" --no-such-option
  expect 2 "$tool" --threads x
  expect 2 "$tool" --threads -1

  expect 0 "$tool" --version
  grep -qE "^$tool \(haarlight\) [0-9]+\.[0-9]+\.[0-9]+$" "$log/out" || fail "$tool --version: $(cat "$log/out")"
  expect 0 "$tool" --help
  for option in --help --version --quiet --verbose --threads; do
    prints "$option"
  done
  # Every option has a description: on its own line after two blanks, or on the next one.
  awk '/^ +-/ && NF < 2 { getline next_line; if (next_line !~ /^ {10}/) exit 1 }' "$log/out" ||
    fail "$tool has an option without a description"
  "$bin/$tool" --help >/dev/full 2>"$log/err"
  [ $? -eq 4 ] || fail "$tool --help >/dev/full does not give 4"
done
# shellcheck disable=SC2119 # the folder is empty
leaves
finish
