#!/usr/bin/env bash
# The main job on a bundled scene: convert it for a dome, rasterise the result, ray-trace the original, compare.
set -euo pipefail
cd "$(dirname "$0")"
./setup.sh

out=build/demo
scene=${1:-data/toys.glb}
mkdir -p "$out"
domewarp=build/release/bin/domewarp
"$domewarp" convert "$scene" -o "$out/warped.glb" --curve '1-r^2' --size 2048x2048 --source-attributes --report "$out/report.json"
echo
"$domewarp" compare "$scene" "$out/warped.glb" --out "$out" --max-displacement 0.51 --max-pinholes 0
echo "
warped scene  $out/warped.glb
report        $out/report.json, $out/compare.json
rasterised    $out/rasterised.png
ray-traced    $out/raytraced.png
difference    $out/difference.png, displacement in $out/displacement.png"
