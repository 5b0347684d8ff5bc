#!/bin/sh
# On a machine with a CUDA compiler and device: builds, runs the tests labelled gpu, compute-sanitizer where it is
# installed, and the benchmark; prints what belongs in docs/validation.md. Usage: scripts/gpu_check.sh [BUILD FOLDER]
set -eu
cd "$(dirname "$0")/.."
build=${1:-build/cuda}

cmake --preset release -B "$build" -DLUCERNA_CUDA=ON
build=$(cd "$build" && pwd)
start=$(date +%s)
cmake --build "$build" --target trace_tests design_tests bench_gpu bench_design lucerna_cli
echo "build: $(($(date +%s) - start)) s on $(nproc) cores"

echo "== device"
if command -v nvidia-smi >/dev/null; then
  nvidia-smi --query-gpu=name,driver_version,memory.total,clocks.max.sm --format=csv,noheader
fi

echo "== tests"
"$build/tests/trace_tests" --gtest_filter='*Gpu.*'
"$build/tests/design_tests" --gtest_filter='*Gpu.*'

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

echo "== bench_gpu"
"$build/bench/bench_gpu" "${RAYS_M:-1000}"

echo "== a design with 400 coefficients, on the CPU and on the device"
"$build/bench/bench_design" n400 -n1
"$build/bench/bench_design" n400 -n1 --device cuda

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
for device in cuda cpu; do
  "$build/lucerna" trace "$work/project.toml" -o "$work/$device" --rays 1e8 --device "$device"
done
"$build/lucerna" compare "$work/cuda/far-field.ldt" "$work/cpu/far-field.ldt"
