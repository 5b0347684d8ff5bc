#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The main job on a bundled source: an LED, a paraboloid, a light distribution. Usage: scripts/demo.sh LUCERNA
set -eu
lucerna=$(realpath "$1")
here=$(realpath "$(dirname "$0")/..")
mkdir -p "$here/demo"
cd "$here/demo"

"$lucerna" make-source led -n 1e6 -o led.tm25ray
"$lucerna" info led.tm25ray
"$lucerna" init --force -o led.toml
sed -i 's|^kind = "led".*|file = "led.tm25ray"|' led.toml
"$lucerna" trace led.toml -o led --force --report led.html
echo "The light distribution: demo/led/far.svg (polar diagram), far.ldt, far.ies, far.csv"
echo "The report: demo/led.html, for any browser"
