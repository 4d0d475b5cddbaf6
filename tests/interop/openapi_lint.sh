#!/usr/bin/env bash
# redocly lints the contract with its recommended rules. It is taken from the folder that TINSMITH_NODE_MODULES names.
set -euo pipefail
root=$2
modules=${TINSMITH_NODE_MODULES:-}
[ -n "$modules" ] && [ -x "$modules/.bin/redocly" ] || { echo "skipped: TINSMITH_NODE_MODULES has no @redocly/cli"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
REDOCLY_TELEMETRY=off REDOCLY_SUPPRESS_UPDATE_NOTICE=true "$modules/.bin/redocly" lint "$root/proto/openapi.json" --extends recommended
