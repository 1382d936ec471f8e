#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The fast unit tests and the fuzz targets under AddressSanitizer and UndefinedBehaviorSanitizer, by clang (preset fuzz).
# Usage: sanitized.sh REPOSITORY build|test
set -euo pipefail
root=$1
cd "$root"
rooms=(profile transform mesh scene gltf)

if [ "$2" = build ]; then
  cmake --preset fuzz >/dev/null
  cmake --build --preset fuzz --target fuzzers planted_overflow "${rooms[@]/%/_test}"
  exit
fi

bin=build/fuzz/bin
log=$(mktemp -d)
trap 'rm -rf "$log"' EXIT

# Negative controls: what is planted must be found.
for planted in heap int; do
  ! "$bin/planted_overflow" $planted >/dev/null 2>&1 || { echo "a planted $planted overflow went unnoticed"; exit 1; }
done
"$bin/planted_overflow" || { echo "the negative control fails without a defect"; exit 1; }

# Two at a time. The slowest tests look for accuracy, not for memory, and run without the sanitizers.
failed=0
printf '%s\n' "${rooms[@]}" | xargs -P 2 -I ROOM sh -c '
  "$1/ROOM_test" --gtest_brief=1 --gtest_filter="-$3" >"$2/ROOM" 2>&1 || { cat "$2/ROOM"; echo "ROOM_test fails under the sanitizers"; exit 1; }
  echo "ROOM_test: $(grep -E "^\[  PASSED" "$2/ROOM")"' sh "$bin" "$log" "${DOMEWARP_SLOW_TESTS:-Stability*}" || failed=1
exit $failed
