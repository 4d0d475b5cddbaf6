#!/usr/bin/env bash
# Runs the tour of README.md as it is printed, line by line, against a server of its own with the sample terrain.
#
#   readme_tour.sh README TINSMITH SAMPLE
#
# The tour is what stands in the sh blocks below "<!-- tour -->". Every command must end with 0, and what it prints must
# hold the text of each "# -> " line below it; spaces do not count. Only the address of the server is another one.
set -uo pipefail
readme=$(readlink -f "$1") tinsmith=$(readlink -f "$2") sample=$(readlink -f "$3")

work=$(mktemp -d)
server=
cleanup() {
  [ -z "$server" ] || { kill -TERM "$server" && wait "$server"; } 2>/dev/null
  rm -rf "$work"
}
trap cleanup EXIT
fail() { printf 'FAILED: %s\n' "$*" >&2; exit 1; }

mkdir -p "$work/build/sample" "$work/build/release" "$work/data"
ln -s "$tinsmith" "$work/build/release/tinsmith"
cp "$sample" "$work/build/sample/olinda.tif" || fail "there is no sample"
cd "$work"

"$tinsmith" serve --listen 127.0.0.1:0 --data "$work/data" >server.out 2>server.err &
server=$!
for _ in $(seq 300); do
  base=$(grep -o 'http://[0-9.:]*' server.out | head -n 1) && break
  kill -0 "$server" 2>/dev/null || { cat server.err >&2; fail "the server did not start"; }
  sleep 0.1
done
[ -n "$base" ] || { cat server.err >&2; fail "the server did not say where it listens"; }
curl -fsS -o /dev/null --data-binary @build/sample/olinda.tif -H 'Content-Type: image/tiff' \
  "$base/tins?id=olinda&title=Olinda,%20Brazil" || { cat server.err >&2; fail "the sample terrain could not be loaded"; }

tour=$(awk '
  /^<!-- tour -->$/ { marked = 1; next }
  marked && /^```sh$/ { inside = 1; next }
  /^```$/ { inside = marked = 0 }
  inside' "$readme")
[ -n "$tour" ] || fail "$readme has no tour"

# Commands run in this shell, since later ones use variables that earlier ones set.
squeezed() { tr -d ' \n'; }
command= commands=0 expected=0
: >answer
while IFS= read -r text; do
  case $text in
    '# -> '*)
      expected=$((expected + 1))
      want=$(printf '%s' "${text#\# -> }" | squeezed)
      case $(squeezed <answer) in
        *"$want"*) ;;
        *) printf '%s\n' "$shown" >&2; head -c 2000 answer >&2; printf '\n' >&2; fail "the answer does not hold ${text#\# -> }" ;;
      esac
      continue
      ;;
    '') continue ;;
  esac
  command+=${command:+$'\n'}$text
  case $text in *\\) continue ;; esac
  bash -n <<<"$command" 2>/dev/null || continue # goes on in the next line
  shown=$command
  commands=$((commands + 1))
  eval "${command//http:\/\/127.0.0.1:8080/$base}" >answer 2>error </dev/null
  status=$?
  [ "$status" -eq 0 ] || { cat error answer >&2; fail "ended with $status: $shown"; }
  command=
done <<<"$tour"
[ -z "$command" ] || fail "the tour ends within a command: $command"
[ "$commands" -gt 0 ] && [ "$expected" -gt 0 ] || fail "the tour is empty"

kill -TERM "$server"
wait "$server"
status=$?
server=
[ "$status" -eq 0 ] || fail "the server ended with $status on SIGTERM"
echo "$commands commands ran, $expected answers were as printed"
