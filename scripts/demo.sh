#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The main job on a bundled source: an LED ray file, a small model of it, a paraboloid, a light distribution; and how far the
# model's light is from the rays'; then a mirror shaped for a target. Usage: scripts/demo.sh LUCERNA
set -eu
lucerna=$(realpath "$1")
here=$(realpath "$(dirname "$0")/..")
mkdir -p "$here/demo"
cd "$here/demo"

echo "== an LED of four dies as a ray file"
"$lucerna" make-source led -n 1e6 -o led.tm25ray
"$lucerna" info led.tm25ray

echo "== the same as a model, and rays drawn from it"
"$lucerna" compress led.tm25ray -o led.nfl
"$lucerna" sample led.nfl -n 1e6 -o sampled.tm25ray
"$lucerna" compare led.tm25ray sampled.tm25ray

echo "== the rays, then the model, through a paraboloid"
"$lucerna" init --force -o model.toml
sed -i 's|^kind = "led".*|file = "led.nfl"|' model.toml
sed 's|led.nfl|led.tm25ray|' model.toml > rays.toml
"$lucerna" trace rays.toml -o rays --force
"$lucerna" trace model.toml -o model --rays 1e6 --force --report model.html
"$lucerna" compare rays model

echo "== a mirror for a beam that is wanted: an oval of 64 x 32 degrees (scripts/demo_data/oval-beam.ldt), at most 60 seconds"
cat > design.toml <<'END'
[[source]]
file = "led.nfl"
[[reflector]]
family = "bspline"
focal_mm = 15.0
diameter_mm = 80.0
hole_diameter_mm = 8.0
position_mm = [0, 0, 15]
axis = "-z"
reflectance = 0.9
[[detector]]
name = "far"
kind = "far-field"
[target]
file = "oval-beam.ldt"
[design]
[design.limits]
symmetry = "both"
max_height_mm = 35.0
END
cp "$here/scripts/demo_data/oval-beam.ldt" .
"$lucerna" design design.toml -o mirror --force --time 60 --tolerances --report mirror.html

echo "== the mirror as it would be checked: traced again, and held against the target"
"$lucerna" trace mirror/reflector.toml -o mirror-traced --force

echo "== look at demo/model/far.svg (polar diagram), demo/model/far.ldt, far.ies, and demo/model.html (the report)"
echo "== and, of the mirror, at demo/mirror.html, demo/mirror/reflector.step, .stl, far.ldt and result.json"
