#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The page of `compare --html` opens in a browser without a network: its script runs, all pictures show, nothing else is
# asked for. Exits with 77 where there is no Chromium.
# Usage: compare_page.sh DOMEWARP REPOSITORY
set -u
domewarp=$1
root=$2
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || exit 77
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failures=0
check() { # NAME CONDITION...
  local name=$1
  shift
  "$@" || { failures=$((failures + 1)); echo "FAILED: $name"; }
}

# open PAGE: the page as the browser has it after loading, in dom; what it asked for and failed to get, in log
open() {
  timeout 120 "$browser" --headless --no-sandbox --disable-gpu --user-data-dir="$work/profile" --host-resolver-rules='MAP * ~NOTFOUND' \
    --virtual-time-budget=10000 --enable-logging=stderr --dump-dom "file://$work/$1" >dom 2>log
}

"$domewarp" convert "$root/data/cubes.glb" -o warped.glb --curve '1-r^2' --size 320x320 --source-attributes --quiet
"$domewarp" compare "$root/data/cubes.glb" warped.glb --html page.html >/dev/null
check "compare --html" [ $? = 0 ]
open page.html
check "all pictures show" grep -q '<html[^>]* data-pictures="6"' dom
check "the figures are there" grep -q 'displacement, largest' dom
check "the display is drawn" grep -q '<svg' dom
check "no error in the console: $(grep CONSOLE log)" [ -z "$(grep CONSOLE log)" ]

# Negative controls: a broken picture and a script that asks the network must be seen.
sed '0,/base64,iVBOR/s//base64,AAAA/' page.html >broken.html
open broken.html
check "a broken picture is seen" grep -q '<html[^>]* data-pictures="5"' dom
sed 's|<script>|<script>fetch("https://example.org");|' page.html >curious.html
open curious.html
check "a request is seen" grep -q CONSOLE log
[ $failures = 0 ]
