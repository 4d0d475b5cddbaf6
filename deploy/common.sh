# What serve.sh, test.sh and sample.sh share; sourced by bash.

ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
PACKAGES=$ROOT/deploy/packages.txt

say() { printf '==> %s\n' "$*" >&2; }
die() { printf 'error: %s\n' "$*" >&2; exit 1; }

# as_root COMMAND...: runs it as root, by sudo where we are somebody else.
as_root() {
  if [ "$(id -u)" -eq 0 ]; then
    "$@"
  elif command -v sudo >/dev/null 2>&1; then
    sudo "$@"
  else
    die "this must be done as root, and there is no sudo: $*"
  fi
}

# packages GROUP...: the names that packages.txt lists for these groups.
packages() {
  local group
  for group in "$@"; do
    awk -v group="$group" '$1 == group { print $2 }' "$PACKAGES"
  done
}

# missing PACKAGE...: those that are not installed.
missing() {
  local name
  for name in "$@"; do
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$name" 2>/dev/null)" = installed ] || printf '%s\n' "$name"
  done
}

# need GROUP...: installs what is missing of these groups; touches neither apt nor the network when nothing is.
need() {
  local names absent log
  command -v dpkg-query >/dev/null 2>&1 || die "the packages are Debian's: this needs Debian 12 (bookworm)"
  mapfile -t names < <(packages "$@")
  mapfile -t absent < <(missing "${names[@]}")
  [ ${#absent[@]} -eq 0 ] && return
  [ "$(id -u)" -eq 0 ] || command -v sudo >/dev/null 2>&1 ||
    die "these packages are missing, and installing them takes root or sudo: ${absent[*]}"
  say "installing ${#absent[@]} packages and what they depend on: ${absent[*]}"
  log=$(mktemp)
  as_root apt-get update -qq >"$log" 2>&1 ||
    { cat "$log" >&2; rm -f "$log"; die "apt-get update failed: is the package mirror within reach?"; }
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${absent[@]}" >"$log" 2>&1 ||
    { cat "$log" >&2; rm -f "$log"; die "apt-get could not install them; deploy/packages.txt names packages of Debian 12 (bookworm)"; }
  rm -f "$log"
}

# build PRESET TESTS: configures and builds build/PRESET, with tests if TESTS is ON.
build() {
  say "building the $1 preset"
  (cd "$ROOT" && cmake --preset "$1" -DTINSMITH_TESTS="$2" >&2 && cmake --build --preset "$1" >&2) ||
    die "the $1 preset did not build"
}
