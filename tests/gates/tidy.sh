#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# clang-tidy with the checks of .clang-tidy; any finding fails.
# Usage: tidy.sh REPOSITORY BUILD_FOLDER [FILE...]   without files: those of the rooms below; all of lib and apps take a quarter of an hour
set -euo pipefail
root=$1 build=$2
shift 2
cd "$root"
tidy=${CLANG_TIDY:-clang-tidy-16}

# A negative control: the planted defects must be found, each kind of them.
found=$("$tidy" --quiet tests/gates/planted_defect.cpp -- -std=c++20 2>/dev/null || true)
for check in bugprone-use-after-move performance-for-range-copy cppcoreguidelines-init-variables modernize-use-nullptr \
             misc-redundant-expression readability-container-size-empty; do
  grep -q "$check" <<<"$found" || { echo "a planted defect went unnoticed: $check"; exit 1; }
done

files=("$@")
[ ${#files[@]} -gt 0 ] || mapfile -t files < <(find lib/domewarp/{core,profile,transform,mesh,scene,refine,convert} -name '*.cpp' | sort)
if ! printf '%s\n' "${files[@]}" | xargs -P 2 -n 4 "$tidy" -p "$build" --quiet 2>/dev/null; then
  echo "clang-tidy has findings"
  exit 1
fi
echo "clang-tidy: ${#files[@]} files without a finding"
