#!/bin/sh
# On a machine with a CUDA device: builds, runs the tests labelled gpu, compute-sanitizer where it is installed, and the
# benchmarks; prints what belongs in docs/benchmarks/gpu.md. What was built elsewhere is checked by the steps after the build.
# Usage: scripts/gpu_check.sh [BUILD FOLDER [build] [tests] [sanitizer] [bench] [design] [program]]
set -eu
cd "$(dirname "$0")/.."
build=${1:-build/cuda}
[ $# -eq 0 ] || shift
steps=${*:-build tests sanitizer bench design program}
for step in $steps; do
  case $step in build | tests | sanitizer | bench | design | program) ;; *)
    echo "found step '$step', expected build, tests, sanitizer, bench, design or program" >&2
    exit 2
    ;;
  esac
done
wants() { case " $steps " in *" $1 "*) true ;; *) false ;; esac; }

if wants build; then
  cmake --preset release -B "$build" -DLUCERNA_CUDA=ON
  start=$(date +%s)
  cmake --build "$build" --target trace_tests design_tests bench_gpu bench_real_targets lucerna_cli
  echo "build: $(($(date +%s) - start)) s on $(nproc) cores"
fi
build=$(cd "$build" && pwd)

echo "== device"
if command -v nvidia-smi >/dev/null; then
  nvidia-smi --query-gpu=name,driver_version,memory.total,clocks.max.sm --format=csv,noheader
fi

if wants tests; then
  echo "== tests"
  "$build/tests/trace_tests" --gtest_filter='*Gpu.*'
  "$build/tests/design_tests" --gtest_filter='*Gpu.*'
fi

if wants sanitizer; then
  echo "== compute-sanitizer"
  sanitizer=$(command -v compute-sanitizer || ls /usr/local/cuda/bin/compute-sanitizer 2>/dev/null || true)
  if [ -n "$sanitizer" ]; then
    # Ranges and models: every kernel, few rays; the ten million rays would take hours here.
    for tool in memcheck racecheck initcheck; do
      "$sanitizer" --tool "$tool" --error-exitcode 9 "$build/tests/trace_tests" \
        --gtest_filter='DeviceTraceGpu.TreesAre*:DeviceTraceGpu.SmallScene*'
      "$sanitizer" --tool "$tool" --error-exitcode 9 "$build/tests/design_tests" \
        --gtest_filter='DeviceEvaluatorGpu.FewRays*'
    done
  else
    echo "not installed"
  fi
fi

if wants bench; then
  echo "== bench_gpu"
  "$build/bench/bench_gpu" "${RAYS_M:-1000}"
fi

if wants design; then
  echo "== a design with 400 coefficients, on the CPU and on the device"
  "$build/bench/bench_real_targets" hidden n400 --targets 1 --device cpu
  "$build/bench/bench_real_targets" hidden n400 --targets 1 --device cuda
fi

wants program || exit 0
echo "== the same through the program"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
(cd "$work" && "$build/lucerna" make-source cylinder -o cylinder.tm25ray -n 1e6 >/dev/null &&
  "$build/lucerna" compress cylinder.tm25ray -o cylinder.nfl >/dev/null)
cat >"$work/project.toml" <<'END'
[[source]]
file = "cylinder.nfl"
position_mm = [0, 0, 15]

[[reflector]]
family = "revolution"
preset = "parabola"
focal_mm = 15.0
aperture = "circle"
diameter_mm = 100.0

[[detector]]
kind = "far-field"
c_step_deg = 1.0
gamma_step_deg = 1.0
END
# Everything that is no height field: a profile that closes in again, facets, a glass, a shield of triangles.
cat >"$work/shield.obj" <<'END'
v -4 -6 0
v 4 -6 0
v 4 6 0
v -4 6 0
f 1 2 3 4
END
cat >"$work/parts.toml" <<'END'
[[source]]
file = "cylinder.nfl"
position_mm = [0, 0, 14]

[[reflector]]
family = "revolution"
profile_mm = [[6, 0], [30, 5], [45, 30], [40, 48], [36, 52]]
aperture = "circle"
diameter_mm = 72.0
hole_diameter_mm = 12.0
reflectance = [[0, 0.92], [60, 0.90], [85, 0.95]]
slope_error_mrad = 2.0

[[reflector]]
family = "faceted"
preset = "parabola"
focal_mm = 40.0
pitch_mm = 5.0
aperture = "circle"
diameter_mm = 60.0
position_mm = [60, 0, 90]
axis = [-0.3, 0, -1]

[[body]]
file = "shield.obj"
role = "mirror"
open = true
reflectance = 0.6
position_mm = [0, 0, 45]

[[body]]
role = "glass"
name = "front"
aperture = "circle"
diameter_mm = 90.0
absorption_per_mm = 0.01
position_mm = [0, 0, 60]

[[detector]]
kind = "far-field"
c_step_deg = 5.0
gamma_step_deg = 1.0
bins = "tent"
END
for device in cuda cpu; do
  "$build/lucerna" trace "$work/project.toml" -o "$work/$device" --rays 1e8 --device "$device"
  "$build/lucerna" trace "$work/parts.toml" -o "$work/parts-$device" --rays 1e7 --device "$device"
done
"$build/lucerna" compare "$work/cuda/far-field.ldt" "$work/cpu/far-field.ldt"
"$build/lucerna" compare "$work/parts-cuda/far-field.ldt" "$work/parts-cpu/far-field.ldt"
