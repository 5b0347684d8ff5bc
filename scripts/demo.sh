#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The main job on a bundled source: an LED ray file, a small model of it, a paraboloid, a light distribution; and how far the
# model's light is from the rays'. Usage: scripts/demo.sh LUCERNA
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

echo "== look at demo/model/far.svg (polar diagram), demo/model/far.ldt, far.ies, and demo/model.html (the report)"
