#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs each libFuzzer target (preset fuzz, built if need be) from an empty corpus; a finding fails.
# Usage: fuzz_smoke.sh REPOSITORY [SECONDS [RUNS]]: at most so long and so many runs for each target
set -euo pipefail
root=$1 seconds=${2:-20} runs=${3:-100000}
cd "$root"
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz --target fuzzers
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
found=0
for target in "$root"/build/fuzz/bin/*_fuzz; do
  name=$(basename "$target")
  found=$((found + 1))
  mkdir corpus
  if ! "$target" -seed=1 -max_len=4096 -rss_limit_mb=3000 -timeout=10 -max_total_time="$seconds" -runs="$runs" corpus >log 2>&1; then
    cat log
    echo "$name: FINDING"
    exit 1
  fi
  echo "$name: $(tail -1 log)"
  rm -r corpus
done
written=$(find "$root/tests" -name '*_fuzz.cpp' | wc -l)
[ "$found" = "$written" ] || { echo "$found fuzz targets were built, $written are written"; exit 1; }
