#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The gate: each stage in turn, one line each (stage, tests, failures, minutes). Usage: scripts/check.sh [STAGE...]; without one, all.
# What passed for this commit is not run again (build/check/COMMIT/STAGE holds its line); changes that are not committed are, each time.
# Stages of compilers and sanitizers alone look at sources, not at docs: a commit that changes docs keeps what passed before
# (build/check/sources-HASH/STAGE; its line names the commit that it ran on). What reads the docs, release runs too.
# Logs: build/check/STAGE.log. Ends with 1 if a stage failed, after the others have run.
#   format        clang-format changes nothing
#   tidy          clang-tidy on every source, with the rule of 60 lines a function (tidy-changed: on those changed since $BASE)
#   tree          layers, lengths, licences, one type a name
#   docs          every link and path of the docs leads somewhere; measured tables have a commit and a benchmark
#   release       g++, everything with the benchmarks, all tests but the slow ones
#   install       what is installed works where it was moved to: program, manual, completion; the library by CMake and pkg-config
#   consumers     the same program with the sources of Lucerna within its project
#   api           the API pages are made, and no public type or function is without a comment (needs doxygen)
#   site          the site of the documentation is made without a warning (needs sphinx and doxygen)
#   deb           Debian packages, by lintian, and installed, used and removed in a bare Debian 12 (needs root and debootstrap)
#   clang         under that preset, all but the long ones (tests/LongTests.cmake) and the module's, which asan-python has from clang
#   asan          under that preset, all but the long ones
#   tsan          under that preset, those of label unit and cli: statistical tests judge numbers of the same threads, corpora and real
#                 files are read by one
#   asan-python   the Python module with the address sanitizer, and its quick tests (needs scripts/packages-python.txt)
#   asan-long tsan-long clang-long   the long ones, only where they are asked for
set -u
cd "$(dirname "$0")/.."
stages="${*:-format tidy tree docs release install consumers api site deb clang asan asan-python tsan}"
# `make` waits for two compilers at once on two cores; the presets' tests run two at a time too.
jobs=${JOBS:-$(nproc)}
base=${BASE:-origin/main}

# New files count too: CMake builds what lies in the folders of the sources.
if [ -z "$(git status --porcelain -- . ':!fuzz/executions.csv')" ]; then
  commit=$(git rev-parse --short=12 HEAD)
  sources=sources-$(git ls-files -s -- . ':!docs' ':!*.md' ':!fuzz/executions.csv' | git hash-object --stdin | cut -c1-12)
else
  commit=changed
  sources=changed
  rm -rf build/check/changed
fi
mkdir -p "build/check/$commit" "build/check/$sources"

# Where it is written down that a stage passed.
passed_file() {  # STAGE
  case $1 in
    format | tidy | consumers | clang* | asan* | tsan*) echo "build/check/$sources/$1" ;;
    *) echo "build/check/$commit/$1" ;;
  esac
}

# What a preset compiles, unity files for the sources in them; not what only a build makes.
compiled_files() {  # PRESET
  sed -n 's/^ *"file": "\(.*\)",\{0,1\}$/\1/p' "build/$1/compile_commands.json" | sort -u |
    while read -r file; do [ ! -e "$file" ] || echo "$file"; done
}

# Of those that the preset tidy compiles: without MPI or CUDA some are not.
changed_sources() {
  git rev-parse -q --verify "$base" >/dev/null || base=HEAD~1
  from=$(git merge-base HEAD "$base" 2>/dev/null) || return 0
  [ "$from" != "$(git rev-parse HEAD)" ] || from=HEAD~1
  git diff --name-only --diff-filter=d "$from" -- '*.cpp' |
    while read -r file; do
      [ -z "$(compiled_files tidy | grep -F -x "$PWD/$file")" ] || echo "$file"
    done
}

# clang-tidy reads how clang would compile each file; nothing is built. Prints each finding once, though a header is read often;
# not that unity files include sources, and not what its analyzer suspects within headers of other libraries. Findings end clang-tidy
# with 1; anything else is a crash.
tidy() {  # PRESET
  xargs -r -n 1 -P "$jobs" sh -c 'clang-tidy -p "build/$0" --quiet "$1" 2>/dev/null; [ $? -le 1 ] || echo "$1: error: clang-tidy failed"' \
    "$1" >build/check/findings
  grep -E '(warning|error): ' build/check/findings | grep -v -e 'suspicious #include of file' -e '^/usr/' | sort -u >build/check/findings.once
  cat build/check/findings.once
  [ ! -s build/check/findings.once ]
}

build_preset() {  # PRESET TARGETS...
  preset=$1
  shift
  cmake --preset "$preset" >/dev/null && cmake --build --preset "$preset" -j "$jobs" --target "$@"
}

build_and_test() {  # PRESET TARGETS...
  build_preset "$@" && ctest --preset "$1"
}

tree_tests() {  # FILTER
  cmake --preset release >/dev/null && cmake --build --preset release -j "$jobs" --target tree_tests &&
    build/release/tests/tree_tests --gtest_filter="$1"
}

# The first rays of a file become a model, a beam and an LDT file, which the installed program reads.
consume() {  # PROGRAM FOLDER
  "$1" "$2/disk.tm25ray" "$2/beam.ldt" && build/release/lucerna check "$2/beam.ldt"
}

installs() {
  cmake --preset release >/dev/null && cmake --build --preset release -j "$jobs" --target installable &&
    scripts/check_install.sh build/release
}

# A stage that needs what is not here says so and returns 77.
needs() {  # PROGRAM...
  for program in "$@"; do
    command -v "$program" >/dev/null || { echo "skipped: no $program"; return 77; }
  done
}

packages() {
  needs dpkg-shlibdeps file || return
  rm -rf build/deb/packages
  cmake --preset deb -DLUCERNA_UNITY=ON >/dev/null && cmake --build --preset deb -j "$jobs" && cpack --config build/deb/CPackConfig.cmake || return 1
  if command -v lintian >/dev/null; then
    lintian --allow-root --fail-on error,warning --suppress-tags-from-file packaging/debian/lintian-suppressed \
      build/deb/packages/*.deb || return 1
  fi
  scripts/check_deb.sh build/deb/packages
}

# Which headers the compiler opens for the umbrella: ours and the standard library's.
foreign_headers() {
  echo '#include <lucerna/lucerna.h>' | "${CXX:-c++}" -std=c++20 -Iinclude -xc++ -M - | tr ' ' '\n' |
    grep -E '/(Eigen|fmt|nlohmann|toml\+\+|tbb|oneapi|CLI|embree3|zstd|openssl|libqhull)'
}

within_sources() {
  place=build/check/add_subdirectory
  ! foreign_headers || return 1
  cmake -S tests/consumers/add_subdirectory -B "$place" -DCMAKE_BUILD_TYPE=Release -DLUCERNA_CUDA=OFF -DLUCERNA_UNITY=ON &&
    cmake --build "$place" -j "$jobs" --target ray_file_to_ldt && build/release/lucerna make-source disk -n 20000 -o "$place/disk.tm25ray" &&
    consume "$place/ray_file_to_ldt" "$place"
}

module_under_asan() {
  needs clang++ || return
  [ -e /usr/share/cmake/pybind11/pybind11Config.cmake ] || [ -e /usr/lib/cmake/pybind11/pybind11Config.cmake ] ||
    { echo "skipped: no pybind11"; return 77; }
  cmake --preset asan -DLUCERNA_PYTHON=ON >/dev/null && cmake --build --preset asan -j "$jobs" --target python_package lucerna_cli &&
    ctest --preset asan -L python
}

stage() {
  case $1 in
    format) git ls-files '*.h' '*.cpp' '*.cu' | xargs clang-format --dry-run -Werror ;;
    tidy) needs clang-tidy && cmake --preset tidy-unity >/dev/null && compiled_files tidy-unity | tidy tidy-unity ;;
    tidy-changed) needs clang-tidy && cmake --preset tidy >/dev/null && changed_sources | tidy tidy ;;
    tree) tree_tests '-Docs.*' ;;
    docs) tree_tests 'Docs.*' && needs python3 && scripts/benchmarks.py --check ;;
    release) build_and_test release all benchmarks ;;
    install) installs ;;
    api) needs doxygen && scripts/api.sh ;;
    site) needs sphinx-build doxygen && scripts/docs.sh ;;
    deb) packages ;;
    consumers) within_sources ;;
    clang) build_and_test clang all benchmarks ;;
    asan | tsan) build_and_test "$1" all ;;
    asan-long | tsan-long | clang-long) build_preset "${1%-long}" all && ctest --preset "$1" ;;
    asan-python) module_under_asan ;;
    *)
      echo "no stage $1" >&2
      return 2
      ;;
  esac
}

# Tests and failures as ctest or GoogleTest count them; for the others the number of complaints.
counts() {  # LOG
  if grep -q 'tests passed,' "$1"; then
    sed -n 's/.*tests passed, \([0-9]*\) tests\{0,1\} failed out of \([0-9]*\).*/\2 \1/p' "$1" | tail -1
  elif grep -q '^\[==========\] .* ran\.' "$1"; then
    echo "$(sed -n 's/^\[==========\] \([0-9]*\) test.* ran\..*/\1/p' "$1") $(grep -c '^\[  FAILED  \] .*ms)$' "$1")"
  else
    echo "- $(grep -ciE '(warning|error): ' "$1")"
  fi
}

failed=0
for name in $stages; do
  done_line=$(passed_file "$name")
  if [ -s "$done_line" ]; then
    cat "$done_line"
    continue
  fi
  log=build/check/$name.log
  start=$(date +%s)
  stage "$name" >"$log" 2>&1
  result=$?
  seconds=$(($(date +%s) - start))
  # shellcheck disable=SC2046  # two words are meant
  set -- $(counts "$log")
  line=$(printf '%-12s %5s tests %4s failed %3d.%d min  %s' "$name" "$1" "$2" $((seconds / 60)) $((seconds % 60 / 6)) "$commit")
  if [ $result -eq 0 ]; then
    echo "$line" | tee "$done_line"
  elif [ $result -eq 77 ]; then
    echo "$line  SKIPPED: $(sed -n 's/^skipped: //p' "$log" | tail -1)"
  else
    echo "$line  FAILED, see $log"
    failed=1
  fi
done
exit $failed
