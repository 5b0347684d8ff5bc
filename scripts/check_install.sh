#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs a build, moves what was installed, and uses it there as others would: the program, its manual pages and completion, and the
# library through CMake and pkg-config, shared and static. Usage: scripts/check_install.sh BUILD (target `installable` is built).
set -eu
cd "$(dirname "$0")/.."
build=$1
work=$PWD/build/check/install
place=$work/moved
rm -rf "$work"
cmake --install "$build" --prefix "$work/first" >/dev/null
mkdir -p "$place/far"
mv "$work/first" "$place/far/away"
place=$place/far/away
lib=$(dirname "$(find "$place" -name liblucerna.a)")

fail() {
  echo "error: $*" >&2
  exit 1
}

echo "== the program"
"$place/bin/lucerna" --version
"$place/bin/lucerna" make-source disk -n 20000 -o "$work/disk.tm25ray"
"$place/bin/lucerna" check "$work/disk.tm25ray"
! readelf -d "$place/bin/lucerna" "$lib/liblucerna.so" | grep -E 'RPATH|RUNPATH' || fail "a path of this machine is in a program"
! grep -rIlF -e "$work" -e "$PWD" "$place" || fail "these files name a place of this machine"

echo "== manual pages and completion"
commands=$("$place/bin/lucerna" --help | awk '/^Subcommands:/ { inside = 1; next } inside && NF { print $1 }')
[ -n "$commands" ] || fail "no commands in the help text"
for name in lucerna $(for c in $commands; do echo "lucerna-$c"; done); do
  page=$(find "$place/share/man/man1" -name "$name.1*")
  [ -s "$page" ] || fail "no manual page $name"
  ! command -v man >/dev/null || LC_ALL=C.UTF-8 MANWIDTH=80 man --warnings -E UTF-8 -l -Tutf8 -Z "$page" 2>"$work/man.err" >/dev/null
  [ ! -s "$work/man.err" ] || fail "$name: $(cat "$work/man.err")"
done
bash -c ". '$place/share/bash-completion/completions/lucerna' && complete -p lucerna"

# docs/install.md: below another prefix PYTHONPATH names the folder.
package=$(find "$place/lib" -type d -path '*/python3*-packages/lucerna')
python=$(sed -n 's/^_Python_EXECUTABLE:INTERNAL=//p' "$build/CMakeCache.txt")
if [ -n "$package" ] && [ -n "$python" ]; then
  echo "== the Python package"
  version=$("$python" -c 'import sys; print("python%d.%d" % sys.version_info[:2])')
  case $package in
    "$place/lib/$version/dist-packages/lucerna" | "$place/lib/$version/site-packages/lucerna") ;;
    *) fail "the Python package is in $package" ;;
  esac
  PYTHONPATH=$(dirname "$package") "$python" -B -c 'import lucerna; print(lucerna.__file__, lucerna.__version__)'
fi

echo "== the shared library's names: all of the headers' functions, nothing but ours"
nm -DC --defined-only "$lib/liblucerna.so" | cut -c20- | sed 's/\[abi:cxx11\]//g' >"$work/names"
! grep -vE '^(typeinfo (name )?for |vtable for )?lucerna::' "$work/names" || fail "names that are not ours"
! grep -E 'Eigen|nlohmann|toml::|tbb::|fmt::' "$work/names" || fail "names of other libraries"
sed 's/^\[\[nodiscard\]\] //' include/lucerna/*.h |
  awk '/^[a-zA-Z]/ && /\(/ && !/^(inline|constexpr|static|using|struct|class|enum|namespace|typedef|LUCERNA_HD)/ && before !~ /^template/ {
         name = $0; sub(/\(.*/, "", name); n = split(name, w, /[ &*]/); print w[n] }
       { before = $0 }' | sort -u >"$work/functions"
[ "$(wc -l <"$work/functions")" -gt 80 ] || fail "the functions of the headers were not found"
while read -r function; do
  grep -qF "lucerna::$function(" "$work/names" || fail "$function is in a header and not in the shared library"
done <"$work/functions"
echo "$(wc -l <"$work/names") names, $(wc -l <"$work/functions") functions of headers among them"

# The first rays of a file become a model, a beam and an LDT file; every way of linking gives the same bits.
use() {  # PROGRAM NAME
  LD_LIBRARY_PATH=${libraries:-} "$1" "$work/disk.tm25ray" "$work/$2.ldt" | tee "$work/$2.txt"
  "$place/bin/lucerna" check "$work/$2.ldt" >/dev/null
  cmp "$work/$2.txt" "$work/${reference:=$2}.txt"
  cmp "$work/$2.ldt" "$work/$reference.ldt"
}

links_shared() { ldd "$1" | grep -q 'liblucerna\.so'; }

for kind in "" shared static; do
  echo "== find_package(Lucerna COMPONENTS $kind)"
  cmake -S tests/consumers/find_package -B "$work/cmake$kind" -DCMAKE_PREFIX_PATH="$place" -DLUCERNA_KIND="$kind" >/dev/null
  cmake --build "$work/cmake$kind" >/dev/null
  use "$work/cmake$kind/ray_file_to_ldt" "cmake$kind"
done
for kind in "" shared; do links_shared "$work/cmake$kind/ray_file_to_ldt" || fail "not the shared library"; done
! links_shared "$work/cmakestatic/ray_file_to_ldt" || fail "not the static library"
! cmake -S tests/consumers/find_package -B "$work/cmakeother" -DCMAKE_PREFIX_PATH="$place" -DLUCERNA_KIND=other >"$work/other.log" 2>&1 ||
  fail "a component that is not there was found"

echo "== pkg-config"
export PKG_CONFIG_PATH="$lib/pkgconfig"
[ "$(pkg-config --modversion lucerna)" = "$("$place/bin/lucerna" --version)" ] || fail "versions differ"
# shellcheck disable=SC2046  # words are meant
c++ -std=c++20 tests/consumers/ray_file_to_ldt.cpp $(pkg-config --cflags --libs lucerna) -o "$work/pkg_shared"
# shellcheck disable=SC2046
c++ -std=c++20 tests/consumers/ray_file_to_ldt.cpp $(pkg-config --static --cflags --libs lucerna | sed 's/-llucerna/-l:liblucerna.a/') \
  -o "$work/pkg_static"
libraries=$lib use "$work/pkg_shared" pkg_shared
use "$work/pkg_static" pkg_static
! links_shared "$work/pkg_static" || fail "not the static library"
echo "installed, moved and used"
