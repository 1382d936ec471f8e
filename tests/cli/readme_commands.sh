#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Every command and option that the README shows exists in the program's help.
# Usage: readme_commands.sh BINARY_FOLDER README
set -u
bin=$1 readme=$2
failures=0

# shown_in FILE: what its code blocks and code spans call of our programs, one a line: PROGRAM COMMAND OPTIONS...
shown_in() {
  sed -e ':a' -e '/\\$/N; s/\\\n//; ta' "$1" | grep -oE '(^    .*|`)domewarp(-bench)? [a-z]+[^`|]*' |
    grep -oE 'domewarp(-bench)? [a-z]+.*' | sed 's/   .*//'
}

# missing_from_help PROGRAM COMMAND OPTIONS...: prints what the help does not know
missing_from_help() {
  local program=$1 command=$2 help option
  shift 2
  "$bin/$program" --help | grep -qE "^  $command( |\$)" || { echo "$program $command"; return; }
  help=$("$bin/$program" "$command" --help)
  for option in "$@"; do
    [[ $option == -* && ! $option =~ ^-[0-9.] ]] || continue
    grep -qE -- "(^|[ ,])${option%%=*}([ ,=]|\$)" <<<"$help" || echo "$program $command $option"
  done
}

check_file() {
  local line words word missing
  while read -r line; do
    words=()
    for word in $(tr "'\"[]()" '      ' <<<"$line"); do words+=("$word"); done
    missing=$(missing_from_help "${words[@]}")
    [ -z "$missing" ] || { echo "not in the help: $missing"; failures=$((failures + 1)); }
  done < <(set -f; shown_in "$1")
}

set -f
count=$(shown_in "$readme" | wc -l)
[ "$count" -ge 6 ] || { echo "found only $count commands in $readme"; exit 1; }
check_file "$readme"
[ $failures = 0 ] || exit 1

# Negative controls: an invented option and an invented command must be found.
invented=$(mktemp)
trap 'rm -f "$invented"' EXIT
printf '    domewarp convert IN -o OUT --no-such-option 3\n    domewarp nosuchcommand\n' >"$invented"
check_file "$invented" >/dev/null
[ $failures = 2 ] || { echo "an invented command went unnoticed"; exit 1; }
echo "$count commands of the README are as the help says"
