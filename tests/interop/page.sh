#!/usr/bin/env bash
# The page at / against a server with bearer tokens, its script run by Node.
. "$(dirname "$0")/common.sh"
need node
token_of() { grep -o 'tinsmith_[A-Za-z0-9_-]*' "$1" | head -n 1; }
entry_of() { grep -o '{"name".*}' "$1"; }
"$tinsmith" token --name editor --write >"$work/editor"
"$tinsmith" token --name feeder --write >"$work/feeder"
feeder=$(entry_of "$work/feeder" | sed 's/"read", //')
start_server "{\"auth\": {\"tokens\": [$(entry_of "$work/editor"), $feeder]}}" "$(token_of "$work/editor")"
node "$(dirname "$0")/page_client.mjs" "$base" "$(token_of "$work/editor")" "$(token_of "$work/feeder")"
