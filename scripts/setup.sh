#!/bin/bash
# Installs the Debian packages that plumbline is built from, those that are missing only.
set -euo pipefail

packages=(
  build-essential
  ccache
  cmake
  file
  libbenchmark-dev
  libbz2-dev
  libceres-dev
  libcgal-dev
  libdeflate-dev
  libeigen3-dev
  libgflags-dev
  libgmock-dev
  libgoogle-glog-dev
  libgtest-dev
  libjemalloc-dev
  liblz4-dev
  libnav-msgs-dev
  libpcl-dev
  librosbag-storage-dev
  libsensor-msgs-dev
  libsqlite3-dev
  libsuitesparse-dev
  libtbb-dev
  libyaml-cpp-dev
  libzstd-dev
  ninja-build
  nlohmann-json3-dev
  pkg-config
  python3
  python3-distributed
  python3-matplotlib
  python3-numpy
  python3-shapely
  python3-yaml
  sqlite3
)

if [[ "${1:-}" == "--help" ]]; then
  echo "Usage: scripts/setup.sh"
  echo "Installs what is missing of these Debian packages: ${packages[*]}"
  exit 0
fi

fail() {
  echo "setup.sh: $*" >&2
  exit 1
}

if ! command -v dpkg-query > /dev/null || ! command -v apt-get > /dev/null; then
  fail "needs Debian 12 with apt-get; elsewhere, install the equivalents of: ${packages[*]}"
fi

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2> /dev/null || true)
  [[ "$status" == "installed" ]] || missing+=("$package")
done
[[ ${#missing[@]} -eq 0 ]] && exit 0

as_root=()
if [[ $(id -u) -ne 0 ]]; then
  command -v sudo > /dev/null ||
    fail "not root and no sudo; have these installed: ${missing[*]}"
  as_root=(sudo)
fi
echo "Installing ${#missing[@]} Debian packages: ${missing[*]}"
"${as_root[@]}" apt-get update ||
  fail "apt-get update failed; is the package archive within reach?"
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get install --yes --no-install-recommends "${missing[@]}" ||
  fail "apt-get could not install: ${missing[*]}"
