#!/usr/bin/env bash
# Runs all tests of the label interop, those with programs of npm among them: run.sh FOLDER [BUILD]
#
#   FOLDER   outside the tree; what package.json names is installed there, unless it has been
#   BUILD    where Tinsmith was built with its tests (build/release)
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd) root=$(cd "$(dirname "$0")/../.." && pwd)
[ $# -ge 1 ] || { sed -n '2,5s/^# \{0,1\}//p' "$0" >&2; exit 2; }
mkdir -p "$1"
folder=$(cd "$1" && pwd) build=${2:-$root/build/release}
case $folder/ in "$root"/*) echo "choose a folder outside the tree" >&2; exit 2 ;; esac
if ! cmp -s "$here/package.json" "$folder/package.json" || [ ! -d "$folder/node_modules" ]; then
  cp "$here/package.json" "$folder/"
  npm install --prefix "$folder" --no-audit --no-fund
fi
export TINSMITH_NODE_MODULES=$folder/node_modules NODE_PATH=$folder/node_modules
exec ctest --test-dir "$build" -L interop --output-on-failure --no-tests=error
