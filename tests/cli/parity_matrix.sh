#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Converts scenes for several surfaces at a tolerance of 0.5 px and compares rasterised points with traced rays: one row per
# pair. A pair keeps the promise when
#   displacement   is at most the tolerance and a subpixel step,
#   pinholes       are none, but for the rule below,
#   mismatches     (a surface that is hidden everywhere within the bound) are none, likewise,
#   overlaps       are none,
#   depth          is off by at most --depth-tolerance.
# The rule "meeting outlines": every connected piece of surface in the pixel ends within the bound, and pieces are connected
# when they share a vertex by its bits. The outlines of such pieces move on their own, so what lies behind may show
# where two meet. Every such pixel is counted by `compare` with exact rays, and printed here. The bundled scenes must have no
# pinhole at all.
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

# figure KEY FILE: a number of a JSON file, first match; "-" where there is none. KEY may lead into objects: a.b
figure() {
  local value
  value=$(tr -d '\n ' <"$2" | grep -oE "\"${1/./\":\\{[^\}]*\"}\":[0-9.e+-]+" | head -1)
  value=${value##*:}
  echo "${value:--}"
}
exceeds() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a > b) }'; }

# misses COMPARE_JSON SEAMS: what a pair misses, one word each. SEAMS: pinholes where outlines meet are let pass
misses() {
  for k in displacement_px.max depth_rel.max; do [ "$(figure $k "$1")" = - ] && echo "${k%%_*} unknown"; done
  exceeds "$(figure displacement_px.max "$1")" 0.50390625 && echo displacement
  [ "$(figure pinholes "$1")" = "$([ "$2" = yes ] && figure pinholes_at_seams "$1" || echo 0)" ] || echo pinholes
  [ "$(figure surface_mismatch "$1")" = "$(figure surface_mismatch_at_seams "$1")" ] || echo mismatches
  [ "$(figure overlaps "$1")" = 0 ] || echo overlaps
  exceeds "$(figure depth_rel.max "$1")" 0.002501 && echo depth
}

row="%-26s %-28s %9s %8s %8s %8s %8s %5s %9s %5s %8s %7s\n"
# shellcheck disable=SC2059 # one format for all rows
printf "$row" scene surface triangles max_px p999_px depth_% pinholes meet mismatch meet overlaps seconds
worst=0 missed=0 runs=0 met=0
for scene in "${scenes[@]}"; do
  name=$(basename "$scene")
  [ "${name%.*}" = scene ] && name=$(basename "$(dirname "$scene")")
  seams=$(case $scene in "$root"/data/*) echo no ;; *) echo yes ;; esac)
  for surface in "${surfaces[@]}"; do
    start=$SECONDS
    # shellcheck disable=SC2086 # options of several words
    "$domewarp" convert "$scene" -o "$work/warped.glb" $surface --size "${rows}x${rows}" --tolerance 0.5 --source-attributes \
      --report "$work/report.json" --quiet 2>"$work/said"
    status=$?
    triangles=$(figure triangles.output "$work/report.json")
    if [ $status != 0 ] || [ "${triangles/-/0}" = 0 ]; then
      echo "$name $surface: convert exits with $status, $triangles triangles: $(head -c 200 "$work/said")"
      [ $status = 0 ] || missed=$((missed + 1))
      continue
    fi
    if ! "$domewarp" compare "$scene" "$work/warped.glb" --json >"$work/compare.json" 2>"$work/said"; then
      echo "$name $surface: compare stopped: $(head -c 200 "$work/said")"
      missed=$((missed + 1))
      continue
    fi
    runs=$((runs + 1))
    at() { figure "$1" "$work/compare.json"; }
    max=$(at displacement_px.max)
    # shellcheck disable=SC2059
    printf "$row" "$name" "${surface#--}" "$triangles" "${max:0:7}" "$(at p999 | head -c 7)" \
      "$(awk -v d="$(at depth_rel.max)" 'BEGIN { printf "%.4f", 100 * d }')" "$(at pinholes)" "$(at pinholes_at_seams)" \
      "$(at surface_mismatch)" "$(at surface_mismatch_at_seams)" "$(at overlaps)" $((SECONDS - start))
    exceeds "$max" "$worst" && worst=$max
    flaws=$(tr -d '\n ' <"$work/compare.json" | grep -oE '"flaws":\[[^"]*\]' | cut -d: -f2)
    [ "$flaws" = "[]" ] || { echo "    pixels: $flaws"; met=$((met + $(at pinholes_at_seams) + $(at surface_mismatch_at_seams))); }
    found=$(misses "$work/compare.json" "$seams")
    [ -z "$found" ] || { echo "    MISSES: ${found//$'\n'/, }"; missed=$((missed + 1)); }
  done
done

# Negative controls: a file for another tolerance, and one with the cracks of the thesis' scheme, must miss just that.
control() {
  local name=$1 what=$2
  shift 2
  "$domewarp" convert "$root/data/toys.glb" -o "$work/control.glb" --curve '1-r^2' --source-attributes --quiet "$@"
  "$domewarp" compare "$root/data/toys.glb" "$work/control.glb" --json >"$work/control.json"
  misses "$work/control.json" yes | grep -q "$what" || { echo "control: $name goes unnoticed"; missed=$((missed + 1)); }
}
control "a coarse file" displacement --size 512x512 --tolerance 4
control "a file with cracks" pinholes --size 1024x1024 --subdivide isotropic
control "a file with doubly covered pixels" overlaps --size 1024x1024 --subdivide isotropic
control "a file of coarse depths" depth --size 512x512 --tolerance 4 --depth-tolerance 0.02

echo "summary: $runs pairs at $rows rows, displacement at most $worst px, $missed beyond the promise, $met pixels by the rule of meeting outlines"
[ $runs -gt 0 ] && [ $missed = 0 ]
