# A server on a free port for scripts; it and its folder go when the script ends. Sourced by bash.
#
#   serve TINSMITH [CONFIGURATION]     # then $base is its address, $server its process
#   $work                              # a folder for files
work=$(mktemp -d)
server=
cleanup() {
  [ -z "$server" ] || { kill -TERM "$server" && wait "$server"; } 2>/dev/null || true
  rm -rf "$work"
}
trap cleanup EXIT
fail() { printf 'FAILED: %s\n' "$*" >&2; exit 1; }

serve() {
  printf '%s' "${2:-"{}"}" >"$work/config.json"
  "$1" serve --config "$work/config.json" --listen 127.0.0.1:0 --data "$work/data" >"$work/out" 2>"$work/err" &
  server=$!
  for _ in $(seq 300); do
    base=$(grep -o 'http://[0-9.:]*' "$work/out" | head -n 1) && break
    kill -0 "$server" 2>/dev/null || { cat "$work/err" >&2; fail "the server did not start"; }
    sleep 0.1
  done
  [ -n "$base" ] || fail "the server did not say where it listens"
}
