# SPDX-License-Identifier: Apache-2.0
# What Doxygen reads instead of a header: the same, but every variable of `double a, b;` has the comment that stands above the first,
# and so has a defaulted comparison.
/^ *\/\/\/( |$)/ { comment = comment $0 "\n"; print; next }

/friend .*operator==.*= default;/ {
  match($0, /^ */)
  if (comment == "") print substr($0, 1, RLENGTH) "/// Equal in every field."
}

# Two variables or more, the values of which have no comma.
/^ +[a-zA-Z0-9_:]+(<[^>]*>)? [a-z0-9_]+( = [^,;(){}]+|\{\})?(, [a-z0-9_]+( = [^,;(){}]+|\{\})?)+;/ {
  match($0, /^ +[a-zA-Z0-9_:]+(<[^>]*>)? /)
  type = substr($0, 1, RLENGTH)
  rest = substr($0, RLENGTH + 1)
  behind = rest
  sub(/^[^;]*;/, "", behind)
  sub(/;.*/, "", rest)
  count = split(rest, names, ", ")
  print type names[1] ";" behind
  for (i = 2; i <= count; ++i) printf "%s%s%s;%s\n", comment, type, names[i], behind
  comment = ""
  next
}

{ comment = ""; print }
