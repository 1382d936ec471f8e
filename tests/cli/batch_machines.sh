#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# `batch` as several machines run it: GNU parallel deals out the shards, one of the processes is killed in the middle.
# Usage: batch_machines.sh DOMEWARP REPOSITORY
set -u
domewarp=$1
root=$2
command -v parallel >/dev/null || { echo "GNU parallel is not here"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
export PARALLEL_HOME=$work/parallel
mkdir -p "$PARALLEL_HOME" shows/sub
touch "$PARALLEL_HOME/will-cite"
failures=0
same() { # NAME EXPECTED GOT
  [ "$2" = "$3" ] || { failures=$((failures + 1)); echo "FAILED: $1: expected '$2', got '$3'"; }
}
for i in $(seq 12); do cp "$root/data/cubes.glb" "shows/sub/$i.glb"; done
quick="--lens equidistant --size 256x256 --jobs 1 --quiet"

"$domewarp" batch shows --out alone $quick
parallel --no-notice -j 2 "$domewarp" batch shows --out shared $quick --shard {}/3 ::: 1 2 3
same "parallel" 0 $?
same "files" 12 "$(find shared -name '*.glb' | wc -l)"
same "the files of one run" "" "$(diff -r alone/sub shared/sub)"
same "a summary for each shard" 3 "$(ls shared/summary*.json | wc -l)"

# Killed: whatever is there is whole, and the next run makes the rest.
for pause in 0.05 0.1 0.2; do
  "$domewarp" batch shows --out killed $quick &
  sleep $pause
  kill -9 $!
  wait $! 2>/dev/null
  for file in $(find killed -name '*.glb' 2>/dev/null); do same "$file after kill -9" "" "$(cmp "alone/${file#killed/}" "$file" 2>&1)"; done
done
parallel --no-notice -j 2 "$domewarp" batch shows --out killed $quick --shard {}/3 ::: 1 2 3
same "parallel after kill -9" 0 $?
same "the files of one run after kill -9" "" "$(diff -r -x .domewarp alone/sub killed/sub)"

echo "$failures failed"
[ "$failures" = 0 ]
