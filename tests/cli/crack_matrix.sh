#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Converts scenes for several surfaces and tolerances, also packed, and lets inspect judge every file against its source:
# torn positions, open edges, T-junctions, flips, lost and overlapping samples must all be 0. One row per run that is not
# sound, and a table of sums. DOMEWARP_MATRIX=full takes all scenes of data/ and of the assets, tolerances 4 to 0.05 px.
# Usage: crack_matrix.sh DOMEWARP REPOSITORY
set -u
domewarp=$1
root=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
surfaces=("--curve 1-r^2" "--curve 3-sqrt(4+6*r^2)" "--lens equidistant --fov 180" "--lens equidistant --fov 270" "--curve 1-2.5*r^2")
scenes=("$root"/data/cubes.glb)
tolerances=(1)
packings=("" --draco --quantize --meshopt)
if [ "${DOMEWARP_MATRIX:-}" = full ]; then
  mapfile -t scenes < <(ls "$root"/data/*.glb; find "$root/../shared/assets/scenes" "$root/../shared/assets/features" -name '*.gl[bt]*' 2>/dev/null | sort)
  tolerances=(4 1 0.5 0.2 0.05)
fi
[ -n "${DOMEWARP_MATRIX_TOLERANCES:-}" ] && read -ra tolerances <<<"$DOMEWARP_MATRIX_TOLERANCES"

count() { grep -o "\"$1\": *[0-9]*" "$work/audit.json" | tail -1 | grep -o '[0-9]*$'; }

runs=0 unsound=0 triangles=0 samples=0 failed=0 turned=0 coarse=0
declare -A sums
for scene in "${scenes[@]}"; do
  for surface in "${surfaces[@]}"; do
    for tolerance in "${tolerances[@]}"; do
      for packing in "${packings[@]}"; do
        # shellcheck disable=SC2086 # options of several words
        "$domewarp" convert "$scene" -o "$work/warped.glb" $surface --tolerance "$tolerance" --source-attributes $packing --quiet 2>"$work/said"
        status=$?
        # A packed file that says how far rounding moves points has kept its promise and is judged like any other.
        if [ $status = 3 ] && [ -n "$packing" ] && grep -q 'rounding in the file moves points' "$work/said"; then
          coarse=$((coarse + 1))
        elif [ $status != 0 ]; then
          failed=$((failed + 1))
          echo "convert exits with $status: $(basename "$scene") $surface $tolerance $packing: $(head -c 200 "$work/said")"
        fi
        [ -s "$work/warped.glb" ] || continue
        "$domewarp" inspect "$work/warped.glb" --source "$scene" --strict --json >"$work/audit.json" 2>/dev/null
        status=$?
        runs=$((runs + 1))
        triangles=$((triangles + $(grep -o '"triangles": *[0-9]*' "$work/audit.json" | head -1 | grep -o '[0-9]*$')))
        samples=$((samples + $(count samples)))
        row="" rest=0
        # open_edges of the cracks comes after that of the mesh
        for name in torn_positions open_edges t_junctions_out flips lost overlapping; do
          value=$(count $name)
          sums[$name]=$((${sums[$name]:-0} + ${value:-0}))
          row="$row $name=$value"
          [ $name = flips ] || rest=$((rest + ${value:-0}))
        done
        # Rounding to 16 bits turns slivers over that are thinner than a step of the grid: a known shortcoming, counted.
        if [ $status = 3 ] && [ "$packing" = --quantize ] && [ $rest = 0 ]; then
          turned=$((turned + $(count flips)))
        elif [ $status != 0 ]; then
          unsound=$((unsound + 1))
          echo "not sound: $(basename "$scene") $surface --tolerance $tolerance $packing:$row"
        fi
        rm -f "$work/warped.glb"
      done
    done
  done
done
echo "$runs files, $triangles triangles, $samples samples, $unsound not sound, $failed conversions stopped:"
for name in torn_positions open_edges t_junctions_out flips lost overlapping; do echo "  $name ${sums[$name]:-0}"; done
echo "  of the flips by --quantize $turned"
echo "  packed coarser than the tolerance, as their reports say $coarse"

# Negative control: the thesis' scheme must fail here.
"$domewarp" convert "$root/data/cubes.glb" -o "$work/cracked.glb" --curve '1-r^2' --subdivide isotropic --source-attributes --quiet
"$domewarp" inspect "$work/cracked.glb" --source "$root/data/cubes.glb" --strict >/dev/null 2>&1
[ $? = 3 ] || { echo "the cracks of the thesis' scheme were not seen"; exit 1; }
[ $unsound = 0 ] && [ $failed = 0 ]
