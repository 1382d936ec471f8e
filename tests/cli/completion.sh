#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Bash completes commands, options and named values as the help has them.
# Usage: completion.sh BINARY_FOLDER REPOSITORY
set -eu
PATH=$1:$PATH
source "$2/apps/domewarp/completion.bash"

# completes EXPECTED WORDS...: the last word is being typed; exactly EXPECTED must come, in order
completes() {
  local expected=$1
  shift
  COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMPREPLY=()
  _domewarp "$1" "${COMP_WORDS[-1]}" "${COMP_WORDS[-2]}"
  [ "${COMPREPLY[*]}" = "$expected" ] || { echo "$*: expected '$expected', got '${COMPREPLY[*]}'"; exit 1; }
}
completes "convert compare curve" domewarp c
completes "thesis" domewarp-bench th
completes "--tolerance" domewarp convert IN --tol
completes "--lens" domewarp convert --le
completes "equidistant equisolid" domewarp convert --lens equi
completes "direct" domewarp curve --method d
completes "" domewarp convert --nothing-such
completes "" domewarp convert scene
echo "completion is as the help says"
