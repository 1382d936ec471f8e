#!/usr/bin/env bash
# Installs what is missing on Debian 12, then configures and builds (Release). Safe to run again: it is quick then.
set -euo pipefail
cd "$(dirname "$0")"

packages=(
  g++ cmake ninja-build ccache pkg-config libxxhash-dev
  libopenmesh-dev libcgal-dev libglm-dev libtinygltf-dev libdraco-dev libmeshoptimizer-dev libembree-dev libtbb-dev
  libhwy-dev libcairo2-dev fonts-dejavu-core libegl-dev libgl-dev libopengl-dev libegl1 libegl-mesa0 libgl1-mesa-dri
  libcli11-dev nlohmann-json3-dev libopenexr-dev libpng-dev libturbojpeg0-dev libwebp-dev
  libgtest-dev libgmock-dev libmuparser-dev libmpfr-dev libgmp-dev doxygen
)
# Where CI runs, also what the slow gates need.
[ -z "${CI:-}" ] || packages+=(clang-16 libclang-rt-16-dev clang-tidy-16 debootstrap parallel chromium)
missing=()
for package in "${packages[@]}"; do
  [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
done
if [ ${#missing[@]} -gt 0 ]; then
  echo "Installing ${missing[*]}"
  sudo=$([ "$(id -u)" = 0 ] || echo sudo)
  $sudo apt-get -o DPkg::Lock::Timeout=500 update -qq
  $sudo env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=500 install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
fi

# The Khronos validator, for one of the tests; without npm or the registry that test is skipped.
if command -v npm >/dev/null && [ ! -d tests/assets/node_modules/gltf-validator ]; then
  npm ci --prefix tests/assets --silent --no-audit --no-fund || echo "The Khronos validator is not installed: its test will be skipped"
fi

# Where CI runs, a warning is an error, and the slow gates are tests too.
cmake --preset release ${CI:+-DCMAKE_COMPILE_WARNING_AS_ERROR=ON -DDOMEWARP_SLOW_GATES=ON} >/dev/null
cmake --build --preset release
