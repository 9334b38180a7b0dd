#!/usr/bin/env bash
# Runs a test of the measured BRDFs and probes: those in $HAARLIGHT_DATA, else in FOLDER. Exit code 77, which ctest
# reports as skipped, where the folder is absent.
# Usage: with_data.sh FOLDER COMMAND…
folder=${HAARLIGHT_DATA:-$1}
shift
[ -d "$folder" ] || { echo "SKIPPED: no folder $folder; set HAARLIGHT_DATA"; exit 77; }
exec "$@"
