#!/bin/bash
# Proves on a bare Debian 12 that the demo runs from a clone, and that the Debian packages install and
# work. Everything happens in directories of its own, into which it changes its root.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)

usage() {
  cat << 'END'
Usage: scripts/packaging/chroot_test.sh MIRROR [--work=DIRECTORY] [--ccache=DIRECTORY]

Installs a minimal Debian 12 with debootstrap, and in copies of it

  1. clones what is committed, runs scripts/demo.sh, makes the packages, and builds docs/example
     against libplumbline-dev;
  2. installs the package plumbline, and simulates, maps and evaluates a room.

Needs root, debootstrap and git, 6 GB of disk, a gigabyte to download and some minutes on a free
machine. Where there is lintian, it judges the packages.

  MIRROR    archive of Debian packages (http://...), such as that in /etc/apt/sources.list
  --work    where the directories are made, and kept; without it a temporary place that is removed
  --ccache  a cache of compiled files to use
  --help    this text
END
}

fail() {
  echo "chroot_test.sh: $*" >&2
  exit 1
}

mirror=
work=
ccache=
for argument in "$@"; do
  case "$argument" in
    --help) usage; exit 0 ;;
    --work=*) work=${argument#*=} ;;
    --ccache=*) ccache=$(realpath "${argument#*=}") ;;
    -*) usage >&2; exit 2 ;;
    *) [[ -z "$mirror" ]] || { usage >&2; exit 2; }; mirror=$argument ;;
  esac
done
[[ -n "$mirror" ]] || { usage >&2; exit 2; }
[[ $(id -u) -eq 0 ]] || fail "has to be run as root"
command -v debootstrap > /dev/null || fail "needs the Debian package debootstrap"

mounts=()
temporary=
clean_up() {
  local i
  for (( i = ${#mounts[@]} - 1; i >= 0; --i )); do umount "${mounts[i]}" || umount -l "${mounts[i]}"; done
  # Nothing below it may be mounted any more: what is mounted is not ours to remove.
  if [[ -n "$temporary" ]]; then rm -rf --one-file-system "$temporary"; fi
}
trap clean_up EXIT
if [[ -z "$work" ]]; then
  temporary=$(mktemp -d)
  work=$temporary
fi
mkdir -p "$work"
work=$(realpath "$work")

step() { echo; echo "== $(date -u +%H:%M:%S) $*"; }

mount_into() {  # what is mounted, and where
  mkdir -p "$2"
  mount --bind "$1" "$2"
  mounts+=("$2")
}

# Runs a command in a directory as if it were the whole machine.
inside() {
  local directory=$1
  shift
  chroot "$directory" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 \
    DEBIAN_FRONTEND=noninteractive CCACHE_BASEDIR=/plumbline CCACHE_NOHASHDIR=1 "$@"
}

make_machine() {  # its name
  [[ -e "$work/$1" ]] && fail "$work/$1 is there already"
  cp -a "$work/bare" "$work/$1"
  # What is lost with a crash of the machine is made again.
  echo force-unsafe-io > "$work/$1/etc/dpkg/dpkg.cfg.d/unsafe-io"
  mount_into /proc "$work/$1/proc"
  mount_into /dev "$work/$1/dev"
  mount_into /dev/pts "$work/$1/dev/pts"
}

step "A bare Debian 12"
if [[ ! -e "$work/bare" ]]; then
  debootstrap --variant=minbase bookworm "$work/bare.partial" "$mirror"
  mv "$work/bare.partial" "$work/bare"
fi

step "A clone, and scripts/demo.sh"
make_machine builder
git clone --quiet --no-hardlinks "$root" "$work/builder/plumbline"
if [[ -n "$ccache" ]]; then mount_into "$ccache" "$work/builder/root/.cache/ccache"; fi
inside "$work/builder" /plumbline/scripts/demo.sh
inside "$work/builder" grep -q '"verdict": "consistent"' /plumbline/out/demo/result/summary.json ||
  fail "the demo's map is not consistent"
[[ -s "$work/builder/plumbline/out/demo/floor_plan.png" ]] || fail "the demo drew no floor plan"

step "The packages"
inside "$work/builder" cmake -S /plumbline -B /plumbline/build -DPLUMBLINE_BUILD_TESTS=OFF
inside "$work/builder" /plumbline/scripts/build.sh
inside "$work/builder" /bin/sh -c "cd /plumbline/build && cpack"
if command -v lintian > /dev/null; then
  lintian --allow-root --fail-on=error,warning "$work"/builder/plumbline/build/packages/*.deb
fi
inside "$work/builder" /bin/sh -c "apt-get install --yes --no-install-recommends /plumbline/build/packages/*.deb"
inside "$work/builder" cmake -S /usr/share/plumbline/docs/example -B /tmp/example
inside "$work/builder" cmake --build /tmp/example
inside "$work/builder" /tmp/example/list_surfaces /plumbline/out/demo/simulation/recording.bag \
  /plumbline/out/demo/simulation/rig.yaml /tmp/surfaces

step "The package plumbline on a bare Debian 12"
make_machine user
cp "$work"/builder/plumbline/build/packages/plumbline_*.deb "$work/user/tmp/"
inside "$work/user" apt-get update
inside "$work/user" /bin/sh -c "apt-get install --yes --no-install-recommends /tmp/plumbline_*.deb"
inside "$work/user" plumbline_simulate --output=/tmp/room \
  --experiment=/usr/share/plumbline/configs/experiments/room.yaml
inside "$work/user" plumbline_map --recording=/tmp/room/recording.bag --rig=/tmp/room/rig.yaml \
  --output=/tmp/map
inside "$work/user" plumbline_evaluate --result=/tmp/map --truth=/tmp/room
inside "$work/user" grep -q '"verdict": "consistent"' /tmp/map/summary.json ||
  fail "the room's map is not consistent"
du -sh --one-file-system "$work/bare" "$work/user" "$work/builder"

step "All of it works"
