# For the scripts of this folder: a server with a terrain of 40 x 30 cells, tilted and rough, in UTM 17 N.
#
#   . "$(dirname "$0")/common.sh"     # $base is the server's address, "rough" the TIN's id
set -euo pipefail
tinsmith=$1 root=$2

work=$(mktemp -d)
server=
cleanup() {
  [ -z "$server" ] || { kill -TERM "$server" && wait "$server"; } 2>/dev/null || true
  rm -rf "$work"
}
trap cleanup EXIT
fail() { printf 'FAILED: %s\n' "$*" >&2; exit 1; }
need() { command -v "$1" >/dev/null || { echo "skipped: there is no $1"; exit 77; }; }
same() { [ "$1" = "$2" ] || fail "$3: $1 is not $2"; }

# start_server [CONFIGURATION [TOKEN]]
start_server() {
  printf '%s' "${1:-"{}"}" >"$work/config.json"
  "$tinsmith" serve --config "$work/config.json" --listen 127.0.0.1:0 --data "$work/data" >"$work/out" 2>"$work/err" &
  server=$!
  for _ in $(seq 300); do
    base=$(grep -o 'http://[0-9.:]*' "$work/out" | head -n 1) && break
    kill -0 "$server" 2>/dev/null || { cat "$work/err" >&2; fail "the server did not start"; }
    sleep 0.1
  done
  [ -n "$base" ] || fail "the server did not say where it listens"
  {
    printf 'ncols 40\nnrows 30\nxllcorner 500000\nyllcorner 4500000\ncellsize 30\nNODATA_value -9999\n'
    awk 'BEGIN { for (j = 0; j < 30; j++) { for (i = 0; i < 40; i++) printf "%s ", 200 + i / 4 - j / 2 + (i * 7 + j * 13) % 11; print "" } }'
  } >"$work/rough.asc"
  curl -fsS -o /dev/null ${2:+-H "Authorization: Bearer $2"} --data-binary @"$work/rough.asc" "$base/tins?id=rough&crs=EPSG:32617" || fail "no terrain"
}
