#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# How the time of one trace falls with the number of ranks on this machine, as a table: for an idle machine. Ranks up to the number
# of cores are timed; 4 and 8 on fewer cores are run for their bits only. Usage: scripts/mpi_scaling.sh LUCERNA LUCERNA_MPI MPIEXEC
# RAYS (default 2e8) are traced three times for each number of ranks; the median counts. Exit code 1: a file differs. Processor seconds say
# what the wall clock cannot on a machine that others use too.
set -eu
[ $# -eq 3 ] || { echo "usage: $0 LUCERNA LUCERNA_MPI MPIEXEC" >&2; exit 2; }
lucerna=$(realpath "$1") lucerna_mpi=$(realpath "$2") mpiexec=$3
rays=${RAYS:-2e8}
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
# Each library's own names for: as root, more ranks than cores, ranks not bound.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_hwloc_base_binding_policy=none
"$lucerna" init --force -o lamp.toml --quiet
"$lucerna" trace lamp.toml -o one --rays 1e7 --quiet

# RANKS RAYS FOLDER: wall and processor seconds of the whole program; the latter count waiting ranks too, which spin.
seconds() {
  local took
  TIMEFORMAT="%R %U %S"
  took=$({ time "$mpiexec" -n "$1" "$lucerna_mpi" trace lamp.toml -o "$3" --rays "$2" --threads 1 --quiet --force >"$dir/log" 2>&1; } 2>&1) ||
    { cat "$dir/log" >&2; exit 1; }
  echo "$took" | awk 'END { print $1, $2 + $3 }'
}
median() { # of three runs: by wall time
  for _ in 1 2 3; do seconds "$@"; done | sort -g | sed -n 2p
}

echo "commit $(git -C "$(dirname "$lucerna_mpi")" rev-parse --short HEAD 2>/dev/null || echo unknown), $(nproc) cores, $rays rays"
echo "| ranks | s | of which start, figures and files | speed-up | processor s | M rays per processor s |"
echo "|---|---|---|---|---|---|"
first=""
for ranks in 1 2 4 8; do
  seconds "$ranks" 1e7 "bits$ranks" >/dev/null
  cmp one/trace.sums "bits$ranks/trace.sums" || exit 1
  if [ "$ranks" -gt "$(nproc)" ]; then
    echo "| $ranks | more ranks than cores: the same bits | | | | |"
    continue
  fi
  # What does not grow with the rays: a run of one block.
  read -r fixed fixed_cpu <<<"$(median "$ranks" 512 fixed)"
  read -r whole whole_cpu <<<"$(median "$ranks" "$rays" whole)"
  [ -n "$first" ] || first=$whole
  awk -v ranks="$ranks" -v fixed="$fixed" -v fixed_cpu="$fixed_cpu" -v whole="$whole" -v cpu="$whole_cpu" -v first="$first" -v rays="$rays" \
    'BEGIN { printf "| %d | %.2f | %.2f | %.2f | %.2f | %.1f |\n", ranks, whole, fixed, first / whole, cpu, 1e-6 * rays / (cpu - fixed_cpu) }'
done
echo
echo "The time of more ranks: scripts/mpi_model.py with the speed and the fixed time of one rank."
