#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The site of the documentation in build/docs: the pages by Sphinx (docs/conf.py), warnings as errors, then the API by Doxygen.
set -eu
cd "$(dirname "$0")/.."
rm -rf build/docs build/docs-cache
mkdir -p build
sphinx-build -q -W --keep-going -b html -c docs -d build/docs-cache . build/docs
# Debian's Furo imports a file from a web server that is not there.
cp /usr/share/javascript/normalize.css/normalize.css build/docs/_static/
sed -i 's|/javascript/normalize.css/normalize.css|../normalize.css|' build/docs/_static/styles/furo.css
# And its script is a module that the pages load as a plain one: the menu of a page's headings and the themes would not work.
scripts=build/docs/_static/scripts
{ cat $scripts/gumshoe-patched.js; sed '/^import Gumshoe from/d' $scripts/furo.js; } >$scripts/joined.js
mv $scripts/joined.js $scripts/furo.js
scripts/api.sh
echo "build/docs/index.html"
