#!/bin/sh
# Compiles every header by itself and names those that need another one before them. A header that its own .cc
# includes first is left out: the build has compiled it so already.
#
#   headers_alone.sh ROOT COMPILER
set -eu
cd "$1"
compiler=$2

find tin proto server tests -name '*.h' | sort | while read -r header; do
  first=$(sed -n '/^ *# *include/{p;q}' "${header%.h}.cc" 2>/dev/null) || first=
  [ "$first" = "#include \"$header\"" ] || printf '%s\n' "$header"
done | xargs -P 2 -I {} sh -c '
  "$1" -std=c++20 -I . -Wall -Wextra -Wpedantic -Werror -fsyntax-only -include "$2" -x c++ /dev/null || {
    echo "$2 does not compile by itself" >&2
    exit 1
  }' compile "$compiler" {}
