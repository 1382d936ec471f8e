# SPDX-License-Identifier: Apache-2.0
# Bash completion of domewarp and domewarp-bench: commands, options and the values of options that name them, as `--help` says.
_domewarp() {
  local program=$1 word=$2 previous=$3 command=${COMP_WORDS[1]} help values
  if [ "$COMP_CWORD" -eq 1 ]; then
    mapfile -t COMPREPLY < <(compgen -W "$("$program" --help 2>/dev/null | sed -n '/^Subcommands:/,/^$/s/^  \([a-z]*\) .*/\1/p')" -- "$word")
    return
  fi
  help=$("$program" "$command" --help 2>/dev/null)
  values=$(sed -nE "s/^ *([^ ]*,)?${previous}(,[^ ]*)? ([a-z]+(\\|[a-z]+)+).*/\\3/p" <<<"$help")
  if [[ $previous == -* && -n $values ]]; then
    mapfile -t COMPREPLY < <(compgen -W "${values//|/ }" -- "$word")
  elif [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(grep -oE '^ *-[^ ]*' <<<"$help" | tr ',' '\n' | grep -oE -- '--[a-z][a-z-]*')" -- "$word")
  fi # else files, by the default of `complete`
}
complete -o default -F _domewarp domewarp domewarp-bench
