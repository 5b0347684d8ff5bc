#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The API pages of include/lucerna by Doxygen, in build/docs/api (docs/Doxyfile). Ends with 1, and says why, where a public type or
# function has no comment, a comment is not understood, or a header has no page. Variables may speak for themselves.
set -eu
cd "$(dirname "$0")/.."
rm -rf build/docs/api
mkdir -p build/docs
LUCERNA_VERSION=$(sed -n 's/^project(lucerna VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
export LUCERNA_VERSION
doxygen docs/Doxyfile
status=0
# Messages go on in indented lines; those of one variable are one line.
if grep -vE '\(variable\) of (struct|class) .* is not documented\.$' build/docs/doxygen.log >&2; then status=1; fi
for header in include/lucerna/*.h; do
  page=build/docs/api/$(basename "$header" .h | sed 's/_/__/g')_8h.html
  [ -s "$page" ] || { echo "$header: error: no page; say in docs/api/files.dox what it is" >&2; status=1; }
done
[ $status -eq 0 ] && echo "build/docs/api/index.html"
exit $status
