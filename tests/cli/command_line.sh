#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The contract of the command line: exit codes, one sentence on stderr, nothing written when it goes wrong.
# Usage: command_line.sh DOMEWARP REPOSITORY
set -u
domewarp=$1
root=$2
source "$(dirname "$0")/checks.sh"

# refuses CODE WORD ARGUMENTS...: exits with CODE, says one line with WORD on stderr, nothing on stdout, writes no file
refuses() {
  local code=$1 word=$2
  shift 2
  "$domewarp" "$@" >stdout 2>stderr </dev/null
  local got=$?
  check "exit $code, got $got: $*" [ "$got" = "$code" ]
  check "one line on stderr: $*" [ "$(wc -l <stderr)" = 1 ]
  check "stderr names $word: $* -> $(cat stderr)" grep -qF -- "$word" stderr
  check "silent stdout: $*" [ ! -s stdout ]
  check "nothing written: $*" [ -z "$(ls | grep -v -e '^std' -e '^in')" ]
}

scene=$root/data/cubes.glb
head -c 1000 "$scene" >in_broken.glb
refuses 2 missing.glb convert missing.glb -o out.glb --curve '1-r^2'
refuses 2 in_broken.glb convert in_broken.glb -o out.glb --curve '1-r^2'
refuses 1 column convert "$scene" -o out.glb --curve 'r+'
refuses 1 --curve convert "$scene" -o out.glb --curve 'log(-1)'
refuses 1 --tolerance convert "$scene" -o out.glb --curve '1-r^2' --tolerance -1
refuses 1 --tolerance convert "$scene" -o out.glb --curve '1-r^2' --tolerance=nan
refuses 1 0.0001 convert "$scene" -o out.glb --curve '1-r^2' --tolerance 1e-300
refuses 1 --size convert "$scene" -o out.glb --curve '1-r^2' --size 0x0
refuses 1 --size convert "$scene" -o out.glb --curve '1-r^2' --size 99999999x9
refuses 1 --eye convert "$scene" -o out.glb --curve '1-r^2' --eye a,b,c
refuses 1 --eye convert "$scene" -o out.glb --curve '1-r^2' --eye 1,2
refuses 1 --camera convert "$scene" -o out.glb --curve '1-r^2' --camera nobody
refuses 1 --lens convert "$scene" -o out.glb
refuses 1 --lens convert "$scene" -o out.glb --lens fish
refuses 1 --colour convert "$scene" -o out.glb --curve '1-r^2' --colour red
refuses 1 .obj convert "$scene" -o out.obj --curve '1-r^2'
refuses 1 --animation convert "$scene" -o out.glb --curve '1-r^2' --animation walk
refuses 1 --animation convert "$scene" -o out.glb --curve '1-r^2' --time 1
refuses 1 --frames convert "$scene" -o out.glb --curve '1-r^2' --frames 3:1
refuses 1 --frames convert "$scene" -o out.glb --curve '1-r^2' --frames 0:1
refuses 1 --fps convert "$scene" -o out.glb --curve '1-r^2' --fps 3
refuses 1 "did you mean convert?" convrt "$scene"
refuses 1 "did you mean --tolerance?" convert "$scene" -o out.glb --curve '1-r^2' --tolerence 1
refuses 1 "one word too many" convert "$scene" another -o out.glb --curve '1-r^2'
refuses 1 "functions are sqrt" convert "$scene" -o out.glb --curve '1-sqr(r)'
refuses 1 "--fov: needs --lens" convert "$scene" -o out.glb --curve '1-r^2' --fov 200
refuses 1 "--exposure: needs --shading bake" convert "$scene" -o out.glb --curve '1-r^2' --shading keep --exposure 1
refuses 1 "--unlit: contradicts --shading bake" convert "$scene" -o out.glb --curve '1-r^2' --shading bake --unlit
refuses 1 "--extension: contradicts --boundary clip" convert "$scene" -o out.glb --curve '1-r^2' --boundary clip --extension 5
refuses 1 .svg curve --curve '1-r^2' --plot out.png
refuses 1 --threads convert "$scene" -o out.glb --curve '1-r^2' --threads -1
cp "$scene" in_scene.glb
refuses 1 in_scene.glb convert in_scene.glb -o in_scene.glb --curve '1-r^2'
refuses 1 --report convert in_scene.glb -o out.glb --curve '1-r^2' --report in_scene.glb
refuses 1 --report convert in_scene.glb -o out.glb --curve '1-r^2' --report ./out.glb
refuses 1 in_scene.glb batch in_scene.glb --out . --curve '1-r^2'
check "the scene is still itself" cmp -s in_scene.glb "$scene"
refuses 1 --fps convert "$scene" -o out.glb --curve '1-r^2' --fps 0 --frames 0:1 --animation 0
refuses 1 --time convert "$scene" -o out.glb --curve '1-r^2' --time 1 --frames 0:1 --animation 0
refuses 1 --shard batch "$scene" --out out --lens equidistant --shard 3/2
refuses 1 --jobs batch "$scene" --out out --lens equidistant --jobs 0
refuses 1 --max-memory batch "$scene" --out out --lens equidistant --max-memory 1
refuses 1 --boundary convert "$scene" -o out.glb --curve '1-r^2' --boundary open
refuses 1 --extension convert "$scene" -o out.glb --curve '1-r^2' --extension 200
refuses 1 --cull-hidden convert "$scene" -o out.glb --curve '1-r^2' --boundary tangent --cull-hidden
refuses 4 nowhere convert "$scene" -o nowhere/out.glb --curve '1-r^2' --quiet
printf '{"scenes": [\n {"input": "a.glb", "tolerance": -1}]}' >in_jobs.json
refuses 2 in_jobs.json:2:21 batch in_jobs.json --out out --lens equidistant
refuses 2 extras compare "$scene" "$scene"
refuses 1 --animation compare "$scene" "$scene" --animation=
refuses 1 --samples render "$scene" -o out.png --curve '1-r^2' --size 32x32 --samples 0
refuses 1 --samples render "$scene" -o out.png --curve '1-r^2' --size 32x32 --renderer gl --samples 4
refuses 1 --hot-spot render "$scene" -o out.png --curve '1-r^2' --size 32x32 --renderer gl --hot-spot hot.png
refuses 1 --supersample render "$scene" -o out.png --curve '1-r^2' --size 32x32 --supersample 2
refuses 1 --lights render "$scene" -o out.png --curve '1-r^2' --size 32x32 --shadows
"$domewarp" convert "$scene" -o in_unlit.glb --curve "1-r^2" --size 32x32 --unlit --quiet >/dev/null
refuses 2 lights render in_unlit.glb -o out.png --renderer gl --lights
refuses 1 .bmp render "$scene" -o out.bmp --curve '1-r^2' --size 32x32
refuses 2 missing.png simulate missing.png -o out.png --curve '1-r^2'
refuses 1 --lens simulate missing.png -o out.png
refuses 1 --scene simulate missing.png -o out.png --curve '1-r^2' --direct direct.png
refuses 1 --look simulate missing.png -o out.png --curve '1-r^2' --look 0,0,-1 --azimuth 3
refuses 1 --look simulate missing.png -o out.png --curve '1-r^2' --look 1,2
refuses 1 .jpg simulate missing.png -o out.jpg --curve '1-r^2'

# Known points: the parabola's f(1) = 0, so a direction at 90 degrees lands on radius 1; the axis on the centre.
same "project the axis" "0 0 2 visible" "$(echo 0 0 -2 | "$domewarp" project --curve '1-r^2')"
same "project 90 degrees" "1 0 3 visible" "$(echo 3 0 0 | "$domewarp" project --lens equidistant --fov 180 | sed 's/^0\.9999999999999[0-9]*/1/')"
same "a blind point" "nan nan 1 blind" "$(echo 0 0 1 | "$domewarp" project --curve '1-r^2')"
same "inverse of the centre" "0 0 -1 visible" "$(echo 0 0 | "$domewarp" project --curve '1-r^2' --inverse | sed 's/-0 /0 /g')"
same "inverse outside" "nan nan nan outside" "$(echo 3 3 | "$domewarp" project --curve '1-r^2' --inverse)"
printf '0 0 -1\nx y z\n' | "$domewarp" project --curve '1-r^2' >stdout 2>stderr
same "a line that is no point exits with" 2 $?
check "the line is named" grep -q "line 2" stderr
yes '0.1 0.2 -1' | head -399 | "$domewarp" project --curve '1-r^2' --report few.json >/dev/null
yes '0.1 0.2 -1' | head -450 | "$domewarp" project --curve '1-r^2' --report many.json >/dev/null
check "few points are mapped directly" grep -q '"direct": 399' few.json
check "many points are mapped by a table" grep -q '"lut": 51' many.json
# There and back: unit directions within 100 degrees of the axis return to 1e-12.
awk 'BEGIN { srand(1); for (i = 0; i < 500; ++i) { t = 1.74 * rand(); p = 6.3 * rand(); printf "%.17g %.17g %.17g\n", sin(t) * cos(p), sin(t) * sin(p), -cos(t) } }' >directions
"$domewarp" project --curve '1-r^2' <directions | cut -d' ' -f1,2 | "$domewarp" project --curve '1-r^2' --inverse >returned
same "directions that return" "500" "$(paste -d' ' directions returned | awk '{ d = ($1-$4)^2 + ($2-$5)^2 + ($3-$6)^2 } d < 1e-24 && $7 == "visible"' | wc -l)"
same "a curve that starts with a minus" 0 "$(echo 0 0 -1 | "$domewarp" project --curve '-r+1' >stdout 2>&1; echo $?)"

# The whole chain, small: convert both projections, compare within the tolerance plus a subpixel step.
for projection in perspective orthographic; do
  "$domewarp" convert "$scene" -o warped.glb --curve '1-r^2' --size 512x512 --projection $projection --source-attributes --report report.json --quiet
  same "convert $projection" 0 $?
  "$domewarp" compare "$scene" warped.glb --out compared --max-displacement 0.504 --max-pinholes 0 --json >compare.json
  same "compare $projection" 0 $?
  check "pictures of $projection" [ -s compared/rasterised.png -a -s compared/raytraced.png -a -s compared/difference.png ]
  check "no torn position in $projection" grep -q '"torn_positions": 0' <("$domewarp" inspect warped.glb --json)
done
# Negative control: without subdivision the same comparison must fail.
"$domewarp" convert "$scene" -o coarse.glb --curve '1-r^2' --size 512x512 --subdivide none --source-attributes --quiet
"$domewarp" compare "$scene" coarse.glb --max-displacement 0.504 >/dev/null 2>&1
same "compare a coarse file" 3 $?
"$domewarp" convert "$scene" -o limited.glb --curve '1-r^2' --max-triangles 500 --quiet 2>/dev/null
same "stopped by --max-triangles" 3 $?
"$domewarp" convert "$scene" -o one.glb --curve '1-r^2' --threads 1 --quiet
"$domewarp" convert "$scene" -o two.glb --curve '1-r^2' --threads 2 --quiet
check "same bytes for 1 and 2 threads" cmp -s one.glb two.glb

# Pictures of rays: samples change the picture and are shown where they went; the same for any number of threads.
quick_render="render $scene --curve 1-r^2 --size 160x120 --quiet"
"$domewarp" $quick_render -o plain.png && "$domewarp" $quick_render -o fine.png --samples 8 --hot-spot hot.png --threads 1 && "$domewarp" $quick_render -o fine2.png --samples 8 --threads 2
same "render with samples" 0 $?
check "samples make another picture" [ "$(cmp -s plain.png fine.png; echo $?)" = 1 ]
check "the same picture for 1 and 2 threads" cmp -s fine.png fine2.png
check "a hot-spot picture" [ -s hot.png ]
"$domewarp" $quick_render -o layers.exr && check "an EXR picture" [ "$(head -c 4 layers.exr | od -An -tx1 | tr -d ' ')" = 762f3101 ]
"$domewarp" $quick_render -o drawn.png --renderer gl --supersample 2
same "render by OpenGL, supersampled" 0 $?

# The dome: seen from the eye a picture for it shows the scene itself; one for another projector does not.
"$domewarp" render "$scene" -o dome.png --curve '3-sqrt(4+6*r^2)' --projector 5 --size 480x360 --samples 16 --quiet
look="--size 320x240 --azimuth 15 --elevation -10 --scene $scene --max-edge-error 0.2"
"$domewarp" simulate dome.png -o eye.png --curve '3-sqrt(4+6*r^2)' --projector 5 $look --direct direct.png --difference difference.png --outside outside.png >stdout
same "simulate" 0 $?
check "simulate says how far edges are" grep -q '^edges .* places, median' stdout
check "pictures of simulate" [ -s eye.png -a -s direct.png -a -s difference.png -a -s outside.png ]
"$domewarp" simulate dome.png -o eye2.png --curve '3-sqrt(4+6*r^2)' --projector 2 $look >stdout 2>stderr
same "simulate with another projector" 3 $?
check "the exceeded limit is named" grep -q -- --max-edge-error stderr
check "simulate --json" grep -q '"median":' <("$domewarp" simulate dome.png -o eye2.png --curve '3-sqrt(4+6*r^2)' --projector 5 --size 320x240 --scene "$scene" --json)
"$domewarp" figures --out figures --quick --quiet
same "figures" 0 $?
check "all figures" [ "$(ls figures/figure_*.png | wc -l)" = 51 -a -s figures/figures.png ]

# Batch: structure kept, a bad scene does not stop the rest, a second run does nothing, shards cover all, killed runs resume.
mkdir -p in_many/sub
for i in 1 2 3 4 5 6; do cp "$root/data/cubes.glb" "in_many/sub/$i.glb"; done
cp in_broken.glb in_many/
quick="--lens equidistant --size 512x512"
"$domewarp" batch in_many --out many $quick >stdout 2>stderr
same "batch with a broken scene" 2 $?
check "the broken scene is named" grep -q in_broken.glb stderr
same "outputs of the others" 6 "$(ls many/sub/*.glb | wc -l)"
same "no progress bar in a pipe" 1 "$(wc -l <stderr)"
rm in_many/in_broken.glb
"$domewarp" batch in_many --out many $quick --json >stdout
same "batch again" 0 $?
check "nothing is done twice" grep -q '"up_to_date": 6,' stdout
for k in 1 2 3; do "$domewarp" batch in_many --out shards $quick --shard $k/3 --quiet; done
check "shards write what one run writes" diff -r many/sub shards/sub
for pause in 0.02 0.05 0.1; do
  "$domewarp" batch in_many --out killed $quick --jobs 1 --quiet &
  sleep $pause
  kill -9 $! 2>/dev/null
  wait $! 2>/dev/null
done
"$domewarp" batch in_many --out killed $quick --quiet
same "batch after kill -9" 0 $?
check "a killed run resumes to the same files and leaves none" diff -r -x .domewarp many/sub killed/sub
rm -rf many shards killed

# Beyond r_max along the tangent: more triangles, and as sound as without.
"$domewarp" convert "$scene" -o clipped.glb --lens equidistant --rmax 0.6 --size 512x512 --quiet --report clipped.json
"$domewarp" convert "$scene" -o tangent.glb --lens equidistant --rmax 0.6 --boundary tangent --extension 15 --size 512x512 --source-attributes --quiet --report tangent.json
check "--boundary tangent draws more" [ "$(grep -m1 -o '"output": *[0-9]*' tangent.json | grep -o '[0-9]*$')" -gt "$(grep -m1 -o '"output": *[0-9]*' clipped.json | grep -o '[0-9]*$')" ]
check "--extension is reported" grep -q '"extension_deg": *15' tangent.json
"$domewarp" inspect tangent.glb --source "$scene" --strict >/dev/null
same "inspect --strict of a file with an extension" 0 $?
"$domewarp" compare "$scene" tangent.glb --max-displacement 0.51 --max-pinholes 0 >stdout
same "compare leaves the extension out" 0 $?
"$domewarp" convert "$scene" -o vertical.glb --curve 'sqrt(1-r^2)' --boundary tangent --size 512x512 >stdout 2>stderr
check "a vertical tangent leads nowhere" grep -q 'tangent is vertical' stderr
rm -f clipped.* tangent.* vertical.*

# What is written through a link or to a device leaves both what they are; a full disk is an error wherever it is met.
touch target.json && ln -s target.json link.json
"$domewarp" convert "$scene" -o linked.glb --curve '1-r^2' --size 64x64 --quiet --report link.json
check "a link stays a link" [ -L link.json ]
check "and leads to what was written" grep -q '"triangles"' target.json
"$domewarp" convert "$scene" -o linked.glb --curve '1-r^2' --size 64x64 --quiet --report /dev/null
same "a report to /dev/null" 0 $?
check "/dev/null stays a device" [ -c /dev/null ]
"$domewarp" convert "$scene" -o linked.glb --curve '1-r^2' --size 64x64 --quiet --report /dev/full 2>stderr
same "a report to a full disk" 4 $?
"$domewarp" curve --curve '1-r^2' >/dev/full 2>stderr
same "standard output on a full disk" 4 $?
rm -f linked.glb link.json target.json

# Hidden folders and what batches have written are no scenes.
mkdir -p folder/.hidden folder/deep
cp "$scene" folder/.hidden && cp "$scene" folder/deep
"$domewarp" batch folder --out folder/first --lens equidistant --size 64x64 --quiet
"$domewarp" batch folder --out folder/second --lens equidistant --size 64x64 --quiet
same "one scene, not its copies" "1 deep/cubes.glb" "$(cd folder/second && find . -name '*.glb' | wc -l) $(cd folder/second && find * -name '*.glb')"
rm -rf folder

# Another scene than the one a file was made of.
"$domewarp" convert "$scene" -o other.glb --curve '1-r^2' --size 64x64 --quiet 2>/dev/null
"$domewarp" compare "$root/data/pool.glb" other.glb >stdout 2>stderr
same "compare with another scene" 2 $?
check "compare says which" grep -q '336 triangles, .*pool.glb has 2020' stderr
rm -f other.glb

# The generator still makes the committed scenes, byte for byte.
"$domewarp" scenes --out scenes >/dev/null
for file in "$root"/data/*.glb; do check "$(basename "$file") is as committed" cmp -s "$file" "scenes/$(basename "$file")"; done

# The Khronos validator, where it is installed (npm install gltf-validator in the build folder).
for folder in "${DOMEWARP_NODE_MODULES:-}" "$root/build/node_modules"; do
  [ -d "$folder/gltf-validator" ] && command -v node >/dev/null || continue
  cat >validate.cjs <<J
const validator = require('$folder/gltf-validator'), fs = require('fs');
(async () => { let errors = 0;
  for (const file of process.argv.slice(2)) errors += (await validator.validateBytes(new Uint8Array(fs.readFileSync(file)))).issues.numErrors;
  process.exit(errors ? 1 : 0); })();
J
  check "validator: 0 errors" node validate.cjs warped.glb coarse.glb one.glb scenes/*.glb
  break
done

echo "$passes passed, $failures failed"
[ "$failures" = 0 ]
