#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# `batch` as several machines run it: GNU parallel deals out the shards to a host, as the README says; and a process is killed
# in the middle. Nothing half written is left, and what is there is what one run alone writes.
# Usage: batch_machines.sh DOMEWARP REPOSITORY
set -u
domewarp=$1
root=$2
command -v parallel >/dev/null || { echo "GNU parallel is not here"; exit 77; }
source "$(dirname "$0")/checks.sh"
export PARALLEL_HOME=$work/parallel
mkdir -p "$PARALLEL_HOME" shows/sub
for i in $(seq 12); do cp "$root/data/cubes.glb" "shows/sub/$i.glb"; done
quick="--lens equidistant --size 4096x4096 --tolerance 0.2 --jobs 1 --quiet"

"$domewarp" batch shows --out alone $quick
parallel --will-cite -S 2/: --wd . "$domewarp" batch shows --out shared $quick --shard {}/3 ::: 1 2 3
same "parallel" 0 $?
same "files" 12 "$(find shared -name '*.glb' | wc -l)"
same "the files of one run" "" "$(diff -r alone/sub shared/sub)"
same "a summary for each shard" 3 "$(ls shared/summary*.json | wc -l)"

# Killed once it has written N files: what is there is whole, and the next run makes the rest.
written() { find killed -name '*.glb' 2>/dev/null | wc -l; }
kills=0
for files in 2 5 8; do
  "$domewarp" batch shows --out killed $quick &
  until [ "$(written)" -ge $files ] || ! kill -0 $! 2>/dev/null; do sleep 0.005; done
  kill -9 $! 2>/dev/null
  wait $! 2>/dev/null
  [ "$(written)" -ge 12 ] || kills=$((kills + 1))
  for file in $(find killed -name '*.glb'); do same "$file after kill -9" "" "$(cmp "alone/${file#killed/}" "$file" 2>&1)"; done
done
same "killed in the middle" yes "$([ $kills -gt 0 ] && echo yes)"
parallel --will-cite -S 2/: --wd . "$domewarp" batch shows --out killed $quick --shard {}/3 ::: 1 2 3
same "parallel after kill -9" 0 $?
same "the files of one run after kill -9" "" "$(diff -r -x .domewarp alone/sub killed/sub)"

echo "$failures failed"
[ "$failures" = 0 ]
