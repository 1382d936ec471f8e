#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Converts scenes for several surfaces at a tolerance of 0.5 px and compares rasterised points with traced rays: one row per
# pair, and the worst of every column. Judged: displacement at most the tolerance and a subpixel step, no pinhole but where
# pieces abut, no hidden surface but there, no overlap.
# DOMEWARP_PARITY=full: also the shared sample scenes. DOMEWARP_PARITY_SCENES, DOMEWARP_PARITY_SURFACES ("a;b;c") choose others.
# Usage: parity_matrix.sh DOMEWARP REPOSITORY [ROWS]
set -u
domewarp=$1
root=$2
rows=${3:-4096}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
surfaces=("--curve 1-r^2" "--curve 3-sqrt(4+6*r^2)" "--lens equidistant --fov 180"
          "--curve 1-r^2 --projector 1" "--curve 1-r^2 --projector 0.25")
scenes=("$root"/data/*.glb)
[ "${DOMEWARP_PARITY:-}" = full ] && mapfile -t -O ${#scenes[@]} scenes < <(find "$root/../shared/assets/scenes" -name '*.gl[bt]*' 2>/dev/null | sort)
[ -n "${DOMEWARP_PARITY_SCENES:-}" ] && read -ra scenes <<<"$DOMEWARP_PARITY_SCENES"
[ -n "${DOMEWARP_PARITY_SURFACES:-}" ] && IFS=';' read -ra surfaces <<<"$DOMEWARP_PARITY_SURFACES"

# figure KEY: of the comparison, first match; "-" where there is none
figure() {
  local value
  value=$(tr -d '\n ' <"$work/compare.json" | grep -oE "\"$1\":[0-9.e+-]+" | head -1)
  echo "${value#*:}" | sed 's/^$/-/'
}
exceeds() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a > b) }'; }

row="%-26s %-28s %9s %8s %8s %8s %5s %9s %5s %8s %7s\n"
# shellcheck disable=SC2059 # one format for all rows
printf "$row" scene surface triangles max_px p999_px pinholes seams mismatch seams overlaps seconds
worst=0 unsound=0 runs=0
for scene in "${scenes[@]}"; do
  name=$(basename "$scene")
  [ "${name%.*}" = scene ] && name=$(basename "$(dirname "$scene")")
  for surface in "${surfaces[@]}"; do
    start=$SECONDS
    # shellcheck disable=SC2086 # options of several words
    "$domewarp" convert "$scene" -o "$work/warped.glb" $surface --size "${rows}x${rows}" --tolerance 0.5 --source-attributes \
      --report "$work/report.json" --quiet 2>"$work/said"
    status=$?
    triangles=$(tr -d '\n ' <"$work/report.json" 2>/dev/null | grep -oE '"triangles":\{[^}]*' | grep -oE '"output":[0-9]+' | grep -oE '[0-9]+$')
    if [ $status != 0 ] || [ "${triangles:-0}" = 0 ]; then
      echo "$name $surface: convert exits with $status, $triangles triangles: $(head -c 200 "$work/said")"
      [ $status = 0 ] || unsound=$((unsound + 1))
      continue
    fi
    if ! "$domewarp" compare "$scene" "$work/warped.glb" --json >"$work/compare.json" 2>"$work/said"; then
      echo "$name $surface: compare stopped: $(head -c 200 "$work/said")"
      unsound=$((unsound + 1))
      continue
    fi
    runs=$((runs + 1))
    max=$(tr -d '\n ' <"$work/compare.json" | grep -oE '"displacement_px":\{"max":[0-9.e+-]+' | grep -oE '[0-9.e+-]+$')
    pinholes=$(figure pinholes) pinholes_at_seams=$(figure pinholes_at_seams) mismatch=$(figure surface_mismatch) mismatch_at_seams=$(figure surface_mismatch_at_seams)
    overlaps=$(figure overlaps)
    # shellcheck disable=SC2059
    printf "$row" "$name" "${surface#--}" "$triangles" "${max:0:7}" "$(figure p999 | head -c 7)" "$pinholes" "$pinholes_at_seams" "$mismatch" "$mismatch_at_seams" "$overlaps" $((SECONDS - start))
    exceeds "$max" "$worst" && worst=$max
    if exceeds "$max" 0.50390625 || [ "$pinholes" != "$pinholes_at_seams" ] || [ "$mismatch" != "$mismatch_at_seams" ] || [ "$overlaps" != 0 ]; then unsound=$((unsound + 1)); fi
  done
done
echo "$runs pairs at $rows rows, displacement at most $worst px, $unsound beyond the promise"

# Negative control: a file for another tolerance must not pass.
"$domewarp" convert "$root/data/cubes.glb" -o "$work/coarse.glb" --curve '1-r^2' --size 512x512 --tolerance 4 --source-attributes --quiet
"$domewarp" compare "$root/data/cubes.glb" "$work/coarse.glb" --max-displacement 0.504 >/dev/null 2>&1
[ $? = 3 ] || { echo "a coarse file went unnoticed"; exit 1; }
[ $runs -gt 0 ] && [ $unsound = 0 ]
