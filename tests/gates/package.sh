#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes the Debian package, installs it with apt on a bare Debian 12 (made with debootstrap in a folder, so as root and with a
# mirror in reach; skipped otherwise) and runs it there.
# Usage: package.sh BUILD_FOLDER REPOSITORY
set -euo pipefail
build=$1 root=$2
[ "$(id -u)" = 0 ] && command -v debootstrap >/dev/null || { echo "needs root and debootstrap"; exit 77; }
mirror=$(apt-get indextargets --format '$(REPO_URI)' | grep -m 1 '/debian/*$') || { echo "no Debian mirror among apt's sources"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
debian=$work/debian
debootstrap --variant=minbase bookworm "$debian" "$mirror" >"$work/log" 2>&1 || { tail -3 "$work/log"; echo "no bare Debian could be made"; exit 77; }

(cd "$build" && cpack -G DEB -B "$work/package" >/dev/null)
mkdir "$debian/show"
cp "$work"/package/*.deb "$root/data/toys.glb" "$debian/show"
inside() { env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive chroot "$debian" "$@"; }

# A negative control: without the package there is nothing to run.
! inside domewarp --version >/dev/null 2>&1 || { echo "the bare machine has a domewarp already"; exit 1; }
inside apt-get update -qq
inside sh -c 'apt-get install -y -qq --no-install-recommends /show/*.deb' >"$work/log" 2>&1 || { tail -20 "$work/log"; exit 1; }
inside sh -euc 'cd /show
  domewarp --version
  domewarp convert toys.glb -o dome.glb --curve 1-r^2 --size 1024x1024 --source-attributes
  domewarp inspect dome.glb --source toys.glb --strict
  domewarp compare toys.glb dome.glb --out pictures --max-displacement 0.6 --max-pinholes 0
  domewarp-bench live --quick --out bench'
