#!/usr/bin/env bash
# What all programs have in common: no arguments, --help, --version, wrong options, a closed stdout.
source "$(dirname "$0")/lib.sh" "$1"

# default_once COMMAND…: its --help prints no option's default, which is in brackets, twice.
default_once() {
  tr -s ' \n' ' ' <"$log/out" | grep -q '\] \[' && fail "$* --help prints a default twice"
  return 0
}

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
  default_once "$tool"
  "$bin/$tool" --help >/dev/full 2>"$log/err"
  [ $? -eq 4 ] || fail "$tool --help >/dev/full does not give 4"
done
for command in build apply sweep; do
  expect 0 haarrelight $command --help
  prints "haarrelight $command"
  default_once haarrelight $command
done
# shellcheck disable=SC2119 # the folder is empty
leaves
finish
