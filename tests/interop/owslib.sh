#!/usr/bin/env bash
# OWSLib: landing page, contract, conformance, features.
. "$(dirname "$0")/common.sh"
/usr/bin/python3 -c 'import owslib.ogcapi.features' 2>/dev/null || { echo "skipped: there is no python3-owslib"; exit 77; }
start_server
/usr/bin/python3 "$(dirname "$0")/owslib_client.py" "$base/tins/rough"
