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

# Four dies under a dome as a model, beside the rays it was made from.
"$lucerna" make-source led -n 1e6 -o dies.tm25ray --quiet
"$lucerna" compress dies.tm25ray -o dies.nfl --report dies.html --quiet

# A mirror found for the beam of another one.
cat > wanted.toml <<TOML
[[source]]
kind = "disk"
radius_mm = 0.5
flux_lm = 1000
[[reflector]]
family = "revolution"
preset = "parabola"
focal_mm = 16.0
diameter_mm = 60.0
position_mm = [0, 0, 15]
axis = "-z"
reflectance = 0.9
[[detector]]
name = "far"
kind = "far-field"
c_step_deg = 5.0
gamma_step_deg = 0.5
TOML
"$lucerna" trace wanted.toml -o wanted --rays 2e6 --quiet
sed 's/focal_mm = 16.0/focal_mm = 15.0/' wanted.toml > mirror.toml
printf '[target]\nfile = "wanted/far.ldt"\n[design]\ntime_s = 30\n' >> mirror.toml
"$lucerna" design mirror.toml -o mirror --report mirror.html --quiet

cd "$here/tests/report"
npm ci --no-audit --no-fund --silent
mkdir -p "$here/docs/gallery"
LUCERNA="$lucerna" node gallery.mjs "$work" "$here/docs/gallery"
