#!/usr/bin/env bash
# Builds Tinsmith with its tests and runs them; the last line says how many passed and how many failed.
#
#   deploy/test.sh [--preset release|dev|asan-ubsan|tsan] [OPTION...]
#
#   --preset PRESET   what to build and test (release)
#   OPTION...         goes to ctest: -R arch runs the tests whose names match "arch"
#
# Tests on larger terrains read them from the folder that TINSMITH_TERRAIN names, where there is one.
set -euo pipefail
. "$(dirname "$0")/common.sh"

preset=release options=()
while [ $# -gt 0 ]; do
  case $1 in
    --preset) [ $# -gt 1 ] || die "--preset needs a value"; preset=$2; shift ;;
    --preset=*) preset=${1#*=} ;;
    -h | --help) sed -n '2,9s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) options+=("$1") ;;
  esac
  shift
done
case $preset in
  release | dev | asan-ubsan | tsan) ;;
  *) die "no preset is called '$preset': there are release, dev, asan-ubsan and tsan" ;;
esac

need run build test
for sample in olinda luxembourg; do
  "$ROOT/deploy/sample.sh" "$sample" >/dev/null
done
build "$preset" ON

export TINSMITH_SAMPLES=$ROOT/build/sample
# A run can be repeated; another seed looks at other random input.
export TINSMITH_SEED=${TINSMITH_SEED:-20021128}
if [ -z "${TINSMITH_TERRAIN:-}" ] && [ -d "$ROOT/../shared/terrain" ]; then
  TINSMITH_TERRAIN=$(cd "$ROOT/../shared/terrain" && pwd)
  export TINSMITH_TERRAIN
fi

say "testing the $preset preset"
results=$ROOT/build/$preset/tests.xml
rm -f "$results"
status=0
ctest --test-dir "$ROOT/build/$preset" --parallel 2 --output-on-failure --no-tests=error \
  --output-junit "$results" ${options[@]+"${options[@]}"} || status=$?
[ -s "$results" ] || die "ctest left no results"

# In CTest's words "run" is a test that passed; "notrun" one whose program is missing, or one that skips itself.
awk '
  /<testcase / {
    if (/ status="run"/) passed++
    else if (/ status="disabled"/) skipped++
    else failed++
  }
  /<skipped message="SKIP_/ { failed--; skipped++ }
  END {
    if (skipped) printf "%d skipped\n", skipped
    printf "%d passed, %d failed\n", passed, failed
  }' "$results"
exit "$status"
