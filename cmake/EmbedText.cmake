# SPDX-License-Identifier: Apache-2.0
# Turns text files into a C++ source of string constants. Run at build time:
# cmake -DOUTPUT=FILE.cpp "-DNAMES=a|b" "-DFILES=a.js|b.css" -P EmbedText.cmake
# Each becomes `const std::string_view lucerna::assets::NAME`, declared in src/lucerna/report/html/html_assets.h.
string(REPLACE "|" ";" NAMES "${NAMES}")
string(REPLACE "|" ";" FILES "${FILES}")
set(text "// Made by cmake/EmbedText.cmake.\n#include \"lucerna/report/html/html_assets.h\"\n\nnamespace lucerna::assets {\n")
foreach(name file IN ZIP_LISTS NAMES FILES)
  file(READ "${file}" content)
  string(FIND "${content}" ")LUCERNA\"" clash)
  if(NOT clash EQUAL -1)
    message(FATAL_ERROR "${file} holds the end mark of a raw string")
  endif()
  string(APPEND text "const std::string_view ${name} = R\"LUCERNA(${content})LUCERNA\";\n")
endforeach()
string(APPEND text "}  // namespace lucerna::assets\n")
file(WRITE "${OUTPUT}" "${text}")
