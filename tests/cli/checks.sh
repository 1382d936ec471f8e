# SPDX-License-Identifier: Apache-2.0
# Sourced: a folder of its own to work in, and checks that are counted.
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failures=0
passes=0

check() { # NAME CONDITION...
  local name=$1
  shift
  if "$@"; then passes=$((passes + 1)); else failures=$((failures + 1)); echo "FAILED: $name"; fi
}

same() { # NAME EXPECTED GOT
  check "$1: expected '$2', got '$3'" [ "$2" = "$3" ]
}
