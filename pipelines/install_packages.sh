#!/usr/bin/env bash
# Installs the Debian 12 packages that are missing. Does nothing, and needs no rights, if none is.
# Usage: install_packages.sh build|check   (check: adds the linters, clang for fuzzing, and the programs that tests use)
set -euo pipefail

packages="g++ cmake ninja-build make pkg-config zstd
  libopenexr-dev libeigen3-dev libxxhash-dev libpng-dev libjpeg-dev libtiff-dev
  libcli11-dev nlohmann-json3-dev catch2 libzstd-dev libgsl-dev libbenchmark-dev
  libepoxy-dev libegl-dev libegl1 libgles2 libgl1-mesa-dri libglfw3-dev libimgui-dev"
if [ "${1:-build}" = check ]; then
  packages="$packages clang-format clang-tidy clang libclang-rt-14-dev shellcheck
    libopenimageio-dev xvfb chromium python3 time bsdutils binutils"
fi

missing=""
for package in $packages; do
  status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

as_root=""
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "$0: needs root or sudo to install:$missing" >&2; exit 1; }
  as_root=sudo
fi
echo "installing:$missing"
$as_root apt-get update -q
# shellcheck disable=SC2086
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $missing
