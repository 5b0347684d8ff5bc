#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the fuzz targets and runs each for its share of MINUTES, as many at a time as there are processors. Prints executions and
# findings, and adds a line per target to fuzz/executions.csv, whose total docs/benchmarks/gate.md quotes. Usage: scripts/fuzz.sh MINUTES [TARGET...]
# What is new stays in build/fuzz/grown; with KEEP=1 it is minimised into fuzz/corpus (files of at most 4096 bytes). A finding is left
# in build/fuzz/grown/TARGET-*; the script then ends with 1.
set -eu
cd "$(dirname "$0")/.."
minutes=$1
shift
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz --target fuzzers
targets=${*:-$(cd build/fuzz/fuzz && ls -- *_fuzz | sed 's/_fuzz$//')}
count=$(echo "$targets" | wc -w)
jobs=${JOBS:-$(nproc)}
seconds=$((minutes * 60 * jobs / count))
[ "$seconds" -gt 0 ] || seconds=1
mkdir -p build/fuzz/grown

corpus_of() { case $1 in ray_*) echo fuzz/corpus/ray_file ;; *) echo "fuzz/corpus/$1" ;; esac; }

echo "$targets" | tr ' ' '\n' | sed '/^$/d' | xargs -P "$jobs" -I NAME sh -c '
  mkdir -p build/fuzz/grown/NAME
  case NAME in ray_*) corpus=fuzz/corpus/ray_file ;; *) corpus=fuzz/corpus/NAME ;; esac
  build/fuzz/fuzz/NAME_fuzz -max_total_time='"$seconds"' -max_len=4096 -timeout=20 -rss_limit_mb=3072 -print_final_stats=1 \
    -artifact_prefix=build/fuzz/grown/NAME- build/fuzz/grown/NAME $corpus >build/fuzz/grown/NAME.log 2>&1 || true'

found=0
for name in $targets; do
  log=build/fuzz/grown/$name.log
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  finding=none
  if [ -z "$executions" ]; then
    finding="did not run to its end"
    found=1
  fi
  if grep -q '^SUMMARY:\|ERROR: libFuzzer' "$log"; then
    finding=$(grep -m1 '^SUMMARY:\|ERROR: libFuzzer' "$log" | cut -c1-100 | tr ',' ' ')
    found=1
  fi
  printf '%-22s %12s executions %5s s  %s\n' "$name" "${executions:-0}" "$seconds" "$finding"
  echo "$(date -u +%Y-%m-%d),$(git rev-parse --short HEAD),$name,${executions:-0},$seconds,$finding" >>fuzz/executions.csv
  if [ "${KEEP:-}" ] && [ "$finding" = none ]; then
    "build/fuzz/fuzz/${name}_fuzz" -merge=1 -max_len=4096 "$(corpus_of "$name")" "build/fuzz/grown/$name" >/dev/null 2>&1
  fi
done
awk -F, 'NR > 1 { n += $4 } END { printf "%.0f executions in all (fuzz/executions.csv)\n", n }' fuzz/executions.csv
exit $found
