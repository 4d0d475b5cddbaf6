#!/usr/bin/env bash
# GDAL's OGCAPI driver reads the surface as a coverage; what it gets is what a GeoTIFF of the same cells holds.
. "$(dirname "$0")/common.sh"
need gdal_translate
start_server
export GDAL_DEFAULT_WMS_CACHE_PATH=$work/cache
gdal_translate -q -of GTiff "OGCAPI:$base/tins/rough/collections/surface" "$work/read.tif" --config GDAL_CACHEMAX 64
gdalinfo "$work/read.tif" >"$work/info"
size=$(sed -n 's/^Size is \([0-9]*\), \([0-9]*\)/\1 \2/p' "$work/info")
domain=$(curl -fsS "$base/tins/rough/collections/surface/coverage/domainset")
width=$(grep -o '"upperBound":[0-9]*}' <<<"$domain" | sed -n '1s/[^0-9]//gp') height=$(grep -o '"upperBound":[0-9]*}' <<<"$domain" | sed -n '2s/[^0-9]//gp')
same "$size" "$((width + 1)) $((height + 1))" "size"
# The driver asks for blocks of its own; in the middle of the terrain both agree.
value() { gdallocationinfo -valonly -wgs84 "$1" -80.9935 40.6545; }
curl -fsS -o "$work/direct.tif" "$base/tins/rough/collections/surface/coverage"
awk -v a="$(value "$work/read.tif")" -v b="$(value "$work/direct.tif")" 'BEGIN { exit !(a > 100 && (a - b) ^ 2 < 25) }' ||
  fail "$(value "$work/read.tif") is not near $(value "$work/direct.tif")"
echo "a coverage of $size pixels read"
