#!/usr/bin/env bash
# A client that knows the contract and nothing else imports, edits, simplifies and exports.
. "$(dirname "$0")/common.sh"
need python3
start_server
python3 "$(dirname "$0")/schema_client.py" "$base" "$work/rough.asc"
