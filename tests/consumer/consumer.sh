#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs a build into an empty folder, then builds and runs a stranger's project against it.
# Usage: consumer.sh BUILD_FOLDER REPOSITORY static|shared
set -euo pipefail
build=$1 root=$2 kind=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

if [ "$kind" = shared ]; then
  cmake -S "$root" -B "$build/shared" -G Ninja -DCMAKE_BUILD_TYPE=None -DBUILD_SHARED_LIBS=ON -DDOMEWARP_TESTS=OFF >/dev/null
  cmake --build "$build/shared"
  build=$build/shared
fi
cmake --install "$build" --prefix "$work/prefix" >/dev/null
cmake -S "$root/tests/consumer" -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$work/prefix" >/dev/null
cmake --build "$work/build"
"$work/build/consumer" "$root/data/cubes.glb" "$work/out.glb"
"$work/prefix/bin/domewarp" inspect "$work/out.glb"

# A negative control: without the package the stranger's project must not configure.
if cmake -S "$root/tests/consumer" -B "$work/none" -G Ninja -DCMAKE_PREFIX_PATH="$work/nowhere" >/dev/null 2>&1; then
  echo "the consumer configured without the package" && exit 1
fi
