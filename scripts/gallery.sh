#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The pictures of the README (docs/gallery), made by the program and photographed in the browser of make test-report.
# Usage: scripts/gallery.sh LUCERNA
set -eu
lucerna=$(realpath "$1")
here=$(realpath "$(dirname "$0")/..")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

"$lucerna" init -o lamp.toml --quiet
"$lucerna" trace lamp.toml -o led --rays 2e6 --report led.html --quiet

# A filament across the axis of a mirror with a hole: light that misses the mirror, and a beam that is not round.
cat > filament.toml <<TOML
[[source]]
kind = "filament"
flux_lm = 1200
axis = "+z"
surface = "none"
[[reflector]]
family = "revolution"
preset = "parabola"
focal_mm = 12.0
diameter_mm = 70.0
hole_diameter_mm = 8.0
position_mm = [0, 0, 13]
axis = "-z"
reflectance = 0.9
[[detector]]
name = "far"
kind = "far-field"
c_step_deg = 2.5
gamma_step_deg = 1.0
TOML
"$lucerna" trace filament.toml -o filament --rays 2e6 --report filament.html --quiet

cd "$here/tests/report"
npm ci --no-audit --no-fund --silent
mkdir -p "$here/docs/gallery"
LUCERNA="$lucerna" node gallery.mjs "$work" "$here/docs/gallery"
