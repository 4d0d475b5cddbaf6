#!/usr/bin/env bash
# OGC API EDR: GDAL reads the GeoJSON, and where npm's covjson-reader is in the folder that TINSMITH_NODE_MODULES names, that reads
# the CoverageJSON.
. "$(dirname "$0")/common.sh"
need ogrinfo
start_server
surface=$base/tins/rough/collections/surface
box='bbox=500015,4500015,501185,4500885&crs=EPSG:32617'
# The vertices stand on a grid of 40 x 30: asked for at the same places, the surface is the vertices.
curl -fsS -o "$work/cube.geojson" "$surface/cube?$box&resolution-x=40&resolution-y=30&f=GeoJSON"
count() { ogrinfo -ro -al -so "$1" 2>/dev/null | sed -n 's/^Feature Count: //p'; }
heights() { ogrinfo -ro -q -dialect SQLite -sql "SELECT $2 FROM \"$3\" ORDER BY 1" "$1" | grep -o '= .*' | sort; }
same "$(count "$work/cube.geojson")" 1200 "nodes of the grid"
curl -fsS -o "$work/vertices.geojson" "$base/tins/rough/export?f=geojson&collection=vertices"
same "$(heights "$work/cube.geojson" elevation cube | md5sum)" "$(heights "$work/vertices.geojson" z vertices | md5sum)" "elevations"
ogrinfo -ro -al "$work/cube.geojson" >"$work/cube.txt"
grep -q 'POINT Z' "$work/cube.txt" || fail "no 3D points"
line='coords=LINESTRING(499000%204500450,502000%204500450)&crs=EPSG:32617&f=GeoJSON'
curl -fsS -o "$work/line.geojson" "$surface/trajectory?$line"
same "$(count "$work/line.geojson")" 1 "one stretch of surface"
ogrinfo -ro -al "$work/line.geojson" >"$work/line.txt"
grep -q 'LINESTRING Z' "$work/line.txt" || fail "no 3D line"
echo "GDAL read a grid and a profile"
modules=${TINSMITH_NODE_MODULES:-}
if [ -n "$modules" ] && [ -d "$modules/covjson-reader" ]; then
  cp "$(dirname "$0")/covjson_client.mjs" "$work/"
  ln -s "$(readlink -f "$modules")" "$work/node_modules"
  node "$work/covjson_client.mjs" "$base/tins/rough"
fi
