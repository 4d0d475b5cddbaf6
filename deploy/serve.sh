#!/usr/bin/env bash
# Builds Tinsmith and serves terrains, one of them a sample. Run it again: what is done already is not done twice.
#
#   deploy/serve.sh [--listen ADDRESS:PORT] [--data FOLDER] [--no-sample] [OPTION...]
#
#   --listen ADDRESS:PORT   where to listen (127.0.0.1:8080)
#   --data FOLDER           where terrains are kept (build/data)
#   --no-sample             do not load the sample terrain, called olinda
#   OPTION...               goes to `tinsmith serve` as it is, --config FILE for example
#
# Ctrl-C or SIGTERM stops the server when it has finished what it was asked to do; its exit status is this script's.
set -euo pipefail
. "$(dirname "$0")/common.sh"

listen=127.0.0.1:8080 data=$ROOT/build/data sample=yes options=()
while [ $# -gt 0 ]; do
  case $1 in
    --listen | --data) [ $# -gt 1 ] || die "$1 needs a value"; declare "${1#--}=$2"; shift ;;
    --listen=* | --data=*) option=${1%%=*}; declare "${option#--}=${1#*=}" ;;
    --no-sample) sample= ;;
    -h | --help) sed -n '2,12s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) options+=("$1") ;;
  esac
  shift
done

need run build
build release OFF
[ -z "$sample" ] || sample=$("$ROOT/deploy/sample.sh" olinda)

mkdir -p "$data"
output=$(mktemp -d)
server=
cleanup() { rm -rf "$output"; }
stop() { [ -z "$server" ] || kill -TERM "$server" 2>/dev/null || true; }
trap cleanup EXIT
trap stop INT TERM HUP

# In a process group of its own, the server gets one signal, ours, when Ctrl-C reaches the terminal's whole group.
mkfifo "$output/line"
set -m
"$ROOT/build/release/tinsmith" serve --listen "$listen" --data "$data" ${options[@]+"${options[@]}"} </dev/null >"$output/line" &
server=$!
set +m

# Ends with the exit status of the server. A signal to this script interrupts the waiting, not the server,
# and bash remembers the status for the one who asks again.
finish() {
  local status=0
  while kill -0 "$server" 2>/dev/null; do
    wait "$server" || true
  done
  wait "$server" || status=$?
  exit "$status"
}

# Its first line says where it listens, and comes when it is ready.
exec 3<"$output/line"
line=
until read -r line <&3; do
  kill -0 "$server" 2>/dev/null || finish
done
url=$(printf '%s\n' "$line" | grep -o 'https\?://[^ ]*' | head -n 1) || die "the server did not say where it listens: $line"
url=${url%/}
cat <&3 &

if [ -n "$sample" ] && ! curl -sS -f -o /dev/null "$url/tins/olinda" 2>/dev/null; then
  say "loading the sample terrain"
  curl -sS --fail-with-body -o "$output/answer" --data-binary "@$sample" -H 'Content-Type: image/tiff' \
    "$url/tins?id=olinda&title=Olinda,%20Brazil" ||
    { cat "$output/answer" >&2; printf '\n' >&2; say "the sample terrain could not be loaded; the server runs on without it"; }
fi

cat <<END

$line

Try, in another terminal:

  curl '$url/tins'
  curl '$url/tins/olinda'
  curl '$url/tins/olinda/collections/vertices/items?limit=2'
  curl -o olinda.tif '$url/tins/olinda/export?f=geotiff'

README.md has a longer tour. Ctrl-C stops the server.
END
finish
