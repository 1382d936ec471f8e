#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Every command and option that the README shows exists in the program's help, and every command of the help is in the README.
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

# options_unknown FILE: options that stand alone in code spans and that no command's help knows
options_unknown() {
  local option
  for option in $(grep -oE '`--[a-z][a-z-]*' "$1" | tr -d '`' | sort -u); do
    grep -qE -- "(^|[ ,])$option([ ,=]|\$)" <<<"$all_help" || echo "$option"
  done
}

# commands_of PROGRAM: the subcommands that its help lists
commands_of() { "$bin/$1" --help | sed -n '/^Subcommands:/,/^$/p' | sed -nE 's/^  ([a-z]+) .*/\1/p'; }

# commands_unsaid FILE: commands of the programs that no code of FILE names
commands_unsaid() {
  local program command
  for program in domewarp domewarp-bench; do
    for command in $(commands_of $program); do
      grep -E "^    |\`" "$1" | grep -E "$program " | grep -qwE -- "$command" || echo "$program $command"
    done
  done
}

set -f
all_help=$(for program in domewarp domewarp-bench; do for command in $(commands_of $program); do "$bin/$program" "$command" --help; done; done)
count=$(shown_in "$readme" | wc -l)
[ "$count" -ge 6 ] || { echo "found only $count commands in $readme"; exit 1; }
check_file "$readme"
for wrong in $(options_unknown "$readme"); do echo "in no help: $wrong"; failures=$((failures + 1)); done
while read -r unsaid; do [ -z "$unsaid" ] || { echo "not in the README: $unsaid"; failures=$((failures + 1)); }; done < <(commands_unsaid "$readme")
[ $failures = 0 ] || exit 1

# Negative controls: invented options and an invented command must be found, and a command that is left out.
invented=$(mktemp)
trap 'rm -f "$invented"' EXIT
printf '    domewarp convert IN -o OUT --no-such-option 3\n    domewarp nosuchcommand\n' >"$invented"
check_file "$invented" >/dev/null
[ $failures = 2 ] || { echo "an invented command went unnoticed"; exit 1; }
printf 'Use `--no-such-option X` or `--json`.\n' >"$invented"
[ "$(options_unknown "$invented")" = --no-such-option ] || { echo "an invented option went unnoticed"; exit 1; }
sed 's/domewarp inspect//' "$readme" >"$invented"
[ "$(commands_unsaid "$invented")" = "domewarp inspect" ] || { echo "a command that the README leaves out went unnoticed"; exit 1; }
echo "$count commands of the README are as the help says"
