#!/usr/bin/env bash
# Fetches a small real elevation model and prints its path; build/sample keeps it for the next time.
#
#   deploy/sample.sh [olinda|luxembourg]
#
#   olinda      coast of Olinda, Brazil: 111 x 111 cells of 90 m, metres, UTM zone 25 S (the default)
#   luxembourg  Luxembourg: 95 x 90 cells in degrees, nodata outside the country
#
# Both are files of Debian packages, which are downloaded and opened without being installed.
set -euo pipefail
. "$(dirname "$0")/common.sh"

case ${1:-olinda} in
  olinda) package=r-cran-stars file=usr/lib/R/site-library/stars/tif/olinda_dem_utm25s.tif name=olinda.tif ;;
  luxembourg) package=r-cran-terra file=usr/lib/R/site-library/terra/ex/elev.tif name=luxembourg.tif ;;
  -h | --help) sed -n '2,9s/^# \{0,1\}//p' "$0"; exit 0 ;;
  *) die "no sample is called '$1': there are olinda and luxembourg" ;;
esac

folder=$ROOT/build/sample
sample=$folder/$name
if [ ! -s "$sample" ]; then
  say "fetching the $name sample from the Debian package $package"
  mkdir -p "$folder"
  work=$(mktemp -d "$folder/fetch.XXXXXX")
  trap 'rm -rf "$work"' EXIT
  cd "$work"
  # apt's own user may not write here, so the download runs as whoever we are.
  fetch() { apt-get download -qq -o APT::Sandbox::User="$(id -un)" "$package" >/dev/null; }
  fetch 2>/dev/null || { as_root apt-get update -qq && fetch; } || die "apt-get could not download $package"
  dpkg-deb -x "$package"_*.deb .
  [ -s "$file" ] || die "the package $package holds no $file"
  mv "$file" "$sample"
fi
printf '%s\n' "$sample"
