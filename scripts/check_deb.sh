#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs the packages of `make deb` in a bare Debian 12, uses them there as a newcomer would, and removes them. Usage:
# scripts/check_deb.sh FOLDER. Needs root and debootstrap; $LUCERNA_BARE may name a tree that
# `debootstrap --variant=minbase bookworm TREE` has made, which is copied then. Ends with 77 where it cannot run.
set -eu
cd "$(dirname "$0")/.."
packages=$1
tree=$PWD/build/check/bare
skip() {
  echo "skipped: $*"
  exit 77
}
[ "$(id -u)" -eq 0 ] || skip "chroot needs root"
[ -n "${LUCERNA_BARE:-}" ] || command -v debootstrap >/dev/null || skip "no debootstrap, and no LUCERNA_BARE"

clear_tree() {
  if mountpoint -q "$tree/proc"; then umount "$tree/proc"; fi
  rm -rf --one-file-system "$tree"
}
mkdir -p build/check
clear_tree
trap clear_tree EXIT
if [ -n "${LUCERNA_BARE:-}" ]; then
  cp -a "$LUCERNA_BARE" "$tree"
else
  debootstrap --variant=minbase bookworm "$tree" >build/check/debootstrap.log
fi
mkdir "$tree/lucerna"
cp "$packages"/*.deb scripts/demo_data/oval-beam.ldt tests/consumers/ray_file_to_ldt.cpp tests/consumers/find_package/CMakeLists.txt \
  scripts/run_tutorial.py "$tree/lucerna"
cp -r docs/tutorials "$tree/lucerna"
mount -t proc proc "$tree/proc"

# A compiler launcher or flags of ours mean nothing in there.
env -i PATH="$PATH" HOME=/root chroot "$tree" sh -eu <<'END'
cd /lucerna
export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8
install="apt-get install -y -qq --no-install-recommends"
apt-get update -qq

echo "== the program alone"
$install ./lucerna_*.deb >install.log 2>&1 || { cat install.log; exit 1; }
lucerna --version
! ldd /usr/bin/lucerna | grep 'not found' || exit 1
lucerna make-source led -n 50000 -o led.tm25ray
lucerna compress led.tm25ray -o led.nfl
lucerna init -o lamp.toml
lucerna trace lamp.toml -o light --rays 1e5 --report light.html
test -s light/far.ldt
test -s light.html
cat >design.toml <<'TOML'
[[source]]
file = "led.nfl"
[[reflector]]
family = "bspline"
focal_mm = 15.0
diameter_mm = 80.0
hole_diameter_mm = 8.0
position_mm = [0, 0, 15]
axis = "-z"
[[detector]]
name = "far"
kind = "far-field"
[target]
file = "oval-beam.ldt"
[design]
TOML
lucerna design design.toml -o mirror --time 15
test -s mirror/reflector.step
for page in lucerna lucerna-trace lucerna-design; do test -s /usr/share/man/man1/$page.1.gz; done
bash -c '. /usr/share/bash-completion/completions/lucerna; complete -p lucerna'
test -s /usr/share/doc/lucerna/copyright

echo "== the library, with no other development package"
$install ./liblucerna*.deb g++ cmake make pkgconf >install.log 2>&1 || { cat install.log; exit 1; }
test ! -e /usr/include/fmt && test ! -e /usr/include/tbb && test ! -e /usr/include/oneapi
g++ -std=c++20 ray_file_to_ldt.cpp $(pkg-config --cflags --libs lucerna) -o by_pkg_config
./by_pkg_config led.tm25ray beam.ldt
mkdir consumer
sed 's|\.\./ray_file|ray_file|' CMakeLists.txt >consumer/CMakeLists.txt
cp ray_file_to_ldt.cpp consumer
cmake -S consumer -B consumer/build >/dev/null
cmake --build consumer/build >/dev/null
./consumer/build/ray_file_to_ldt led.tm25ray beam2.ldt
cmp beam.ldt beam2.ldt
lucerna check beam.ldt

echo "== the Python module"
$install ./python3-lucerna_*.deb >install.log 2>&1 || { cat install.log; exit 1; }
python3 -c 'import lucerna as lu; lu.Scene(["led.nfl"]).trace(rays=1e5)["far-field"].save("beam3.ldt")'
lucerna check beam3.ldt
test "$(python3 -m lucerna --version)" = "$(lucerna --version)"

echo "== the tutorials, block by block"
$install python3-scipy >install.log 2>&1 || { cat install.log; exit 1; }
python3 run_tutorial.py tutorials/led-to-model.md tutorials/paraboloid-to-ldt.md tutorials/design-a-floodlight.md \
  tutorials/as-a-library.md tutorials/python.md tutorials/lens-for-a-desk.md

if ls lucerna-mpi_*.deb >found.log 2>&1; then
  echo "== many machines"
  $install ./lucerna-mpi_*.deb openmpi-bin >install.log 2>&1 || { cat install.log; exit 1; }
  mpirun --allow-run-as-root --oversubscribe --quiet -n 2 lucerna-mpi trace lamp.toml -o by_ranks --rays 1e5
  cmp light/far.csv by_ranks/far.csv
fi

echo "== gone again"
own=$(ls *.deb | sed 's/_.*//') # all that lie here were installed above
apt-get purge -y -qq $own >remove.log 2>&1 || { cat remove.log; exit 1; }
test ! -e /usr/bin/lucerna
left=$(find / -xdev -path /proc -prune -o -path /lucerna -prune -o -iname '*lucerna*' -print)
[ -z "$left" ] || { echo "error: left behind: $left"; exit 1; }
END
echo "installed, used and removed in a bare Debian 12"
