#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Every form that a warped scene can be written in: compressed, lit, within a limit of memory. What cannot be written is said.
# Usage: convert_forms.sh DOMEWARP REPOSITORY
set -u
domewarp=$1
root=$2
source "$(dirname "$0")/checks.sh"
convert() { # OUT ARGUMENTS...
  local out=$1
  shift
  "$domewarp" convert "$@" -o "$out" --quiet 2>stderr
}
smaller() { [ "$(stat -c %s "$1")" -lt "$(stat -c %s "$2")" ]; }

toys="$root/data/toys.glb --curve 1-r^2 --size 512x512"

# A triangle, lines and points.
cat >in_lines.gltf <<J
{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
 "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AACAvwAAAAAAAADAAACAPwAAAAAAAADAAAAAAAAAgD8AAADA"}],
 "bufferViews": [{"buffer": 0, "byteLength": 36}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, 0, -2], "max": [1, 1, -2]}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}, {"attributes": {"POSITION": 0}, "mode": 2}, {"attributes": {"POSITION": 0}, "mode": 0}]}]}
J

# Compressed: sound once decoded, and the picture of the plain file.
convert plain.glb $toys --source-attributes
same "plain" 0 $?
for form in --draco --quantize --meshopt "--meshopt --quantize"; do
  convert packed.glb $toys --source-attributes $form
  same "$form" 0 $?
  check "$form is smaller" smaller packed.glb plain.glb
  check "$form holds no torn position" grep -q '"torn_positions": 0' <("$domewarp" inspect packed.glb --json)
  "$domewarp" compare "$root/data/toys.glb" packed.glb --max-displacement 0.54 --json >compare.json 2>stderr
  same "the picture of $form" 0 $?
done
convert separate.gltf $toys --meshopt
same "a .gltf with --meshopt" 0 $?
check "its .bin is there" [ -s separate.bin ]
convert both.glb $toys --draco --meshopt
same "--draco with --meshopt" 1 $?
check "both are named" grep -q -- '--draco and --meshopt' stderr

# Something near in a wide scene: the one grid is too coarse for it, which is said.
sed 's|"nodes": \[{"mesh": 0}\]|"nodes": [{"mesh": 0}, {"mesh": 0, "scale": [2000, 2000, 2000]}]|; s|"scenes": \[{"nodes": \[0\]}\]|"scenes": [{"nodes": [0, 1]}]|' in_lines.gltf >in_wide.gltf
wide="in_wide.gltf --lens equidistant --size 2048x2048 --eye 0,0,0 --forward 0,0,-1"
convert wide.glb $wide --quantize --report report.json
same "a near thing on a coarse grid" 3 $?
check "rounding is named" grep -q 'rounding in the file moves points by up to' stderr
check "rounding is reported" grep -q '"packing_px": [1-9]' report.json
convert wide.glb $wide --meshopt --report report.json
same "the same without loss" 0 $?
check "nothing is rounded" grep -q '"packing_px": 0.0' report.json

# Light in the colours: shadows change them, quantised ones keep 16 bits.
lit="$root/data/toys.glb --curve 1-r^2 --size 256x256 --shading bake"
convert lit.glb $lit
same "bake" 0 $?
convert shadowed.glb $lit --shadows --report report.json
same "bake with shadows" 0 $?
check "the report tells the lights" grep -q '"lights": 4' report.json
check "shadows change the file" [ "$(cmp -s lit.glb shadowed.glb; echo $?)" = 1 ]
check "every material is unlit" grep -qa KHR_materials_unlit shadowed.glb
check "no normals are left" [ "$(grep -ca '"NORMAL"' shadowed.glb)" = 0 ]
for name in lit shadowed; do "$domewarp" render $name.glb -o $name.png --renderer gl --size 256x256 --quiet; done
check "shadows change the picture" [ "$(cmp -s lit.png shadowed.png; echo $?)" = 1 ]
convert one.glb $lit --shadows --threads 1
convert two.glb $lit --shadows --threads 2
check "the same light for 1 and 2 threads" cmp -s one.glb two.glb

# A limit of memory: refused before it is read, refused on the way, kept.
convert small.glb $toys --max-memory 1
same "--max-memory below the program's own" 1 $?
convert small.glb $toys --max-memory 30
same "--max-memory below the estimate" 3 $?
check "the need is told" grep -q 'toys.glb: needs' stderr
convert small.glb $lit --max-memory 100
same "--max-memory below what the rays need" 3 $?
check "the need of the rays is told" grep -q 'toys.glb: needs about 14[0-9] MiB' stderr
(ulimit -d 120000; convert small.glb $lit)
same "no memory for Embree" 3 $?
check "it says so" grep -q 'not enough memory' stderr
check "nothing is written" [ ! -e small.glb ]
convert small.glb $toys --tolerance 0.002 --max-memory 64
same "memory that runs out on the way" 3 $?
check "the limit is named" grep -q -- '--max-memory allows' stderr
check "no part of a file is left" [ -z "$(ls small* 2>/dev/null)" ]
convert small.glb $toys --source-attributes --max-memory 2000
same "memory enough" 0 $?
check "the limit changes nothing" cmp -s small.glb plain.glb

# Lines and points, which the thesis' recursion cannot divide.
lines="in_lines.gltf --lens equidistant --size 256x256 --eye 0,0,0 --forward 0,0,-1"
"$domewarp" convert $lines -o lines.glb --subdivide isotropic --report report.json >stdout 2>stderr
same "lines with isotropic" 0 $?
check "lines left out are told" grep -q 'left out 3 line(s) and 3 point(s)' stderr
convert lines.glb $lines --shading bake --report report.json
same "lines with bake" 0 $?
check "lines are kept" [ "$(grep -ao '"mode":[01]' lines.glb | sort -u | tr -d '\n')" = '"mode":0"mode":1' ]

echo "$passes passed, $failures failed"
[ "$failures" = 0 ]
