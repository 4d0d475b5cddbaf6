#!/bin/sh
# Compiles every header by itself and names those that need another one before them. A header with which a source
# of the build begins, or one with which such a header begins, is left out: the build has compiled it so already.
# Of sources that are compiled together (TINSMITH_UNITY_TESTS) that is so for the first one only.
#
#   headers_alone.sh ROOT COMPILER BUILD-FOLDER
set -eu
cd "$1"
compiler=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

first_include() { sed -n '/^ *# *include/{s/^ *# *include "\(.*\)"$/\1/p;q}' "$1"; }

sed -n 's/^ *"file": "\(.*\)",\{0,1\}$/\1/p' "$3/compile_commands.json" | sort -u | while read -r source; do
  first=$source
  while first=$(first_include "$first") && [ -n "$first" ]; do printf '%s\n' "$first"; done
done | sort -u >"$work/compiled"
grep -q '\.h$' "$work/compiled" || { echo "no sources in $3/compile_commands.json" >&2; exit 1; }
find tin proto server tests -name '*.h' | sort >"$work/headers"

comm -23 "$work/headers" "$work/compiled" | xargs -P 2 -I {} sh -c '
  "$1" -std=c++20 -I . -Wall -Wextra -Wpedantic -Werror -fsyntax-only -include "$2" -x c++ /dev/null || {
    echo "$2 does not compile by itself" >&2
    exit 1
  }' compile "$compiler" {}
