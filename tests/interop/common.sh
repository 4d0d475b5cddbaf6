# For the scripts of this folder: a server with a terrain of 40 x 30 cells, tilted and rough, in UTM 17 N.
#
#   . "$(dirname "$0")/common.sh"     # $base is the server's address, "rough" the TIN's id
set -euo pipefail
tinsmith=$1 root=$2

. "$(dirname "${BASH_SOURCE[0]}")/../support/serve.sh"

need() { command -v "$1" >/dev/null || { echo "skipped: there is no $1"; exit 77; }; }
same() { [ "$1" = "$2" ] || fail "$3: $1 is not $2"; }

# start_server [CONFIGURATION [TOKEN]]
start_server() {
  serve "$tinsmith" "${1:-"{}"}"
  {
    printf 'ncols 40\nnrows 30\nxllcorner 500000\nyllcorner 4500000\ncellsize 30\nNODATA_value -9999\n'
    awk 'BEGIN { for (j = 0; j < 30; j++) { for (i = 0; i < 40; i++) printf "%s ", 200 + i / 4 - j / 2 + (i * 7 + j * 13) % 11; print "" } }'
  } >"$work/rough.asc"
  curl -fsS -o /dev/null ${2:+-H "Authorization: Bearer $2"} --data-binary @"$work/rough.asc" "$base/tins?id=rough&crs=EPSG:32617" || fail "no terrain"
}
