#!/usr/bin/env bash
# GDAL's OAPIF driver: the layers, and a copy of all features page by page.
. "$(dirname "$0")/common.sh"
need ogrinfo
need ogr2ogr
start_server '{"limits":{"page_size":250,"page_size_max":400}}'

layers=$(ogrinfo -ro "OAPIF:$base/tins/rough")
for layer in 'vertices (title: Vertices) (3D Point)' 'triangles (title: Triangles) (3D Polygon)' 'edges (title: Edges) (3D Line String)'; do
  grep -qF "$layer" <<<"$layers" || fail "no layer $layer in: $layers"
done
ogrinfo -ro -so "OAPIF:$base/tins/rough" vertices | grep -q '^z: Real' || fail "z is no number with decimals"

# All that there is: the surface, which has no features, is none of the layers.
ogr2ogr -f GPKG "$work/copy.gpkg" "OAPIF:$base/tins/rough" --config CPL_LOG /dev/null
count() { ogrinfo -ro -so "$work/copy.gpkg" "$1" | sed -n 's/^Feature Count: //p'; }
same "$(count vertices)" 1200 "vertices"
same "$(count triangles)" 2262 "triangles"
same "$(count edges)" 3461 "edges"

# What was copied is where it was sent from: the cell centres, within the rounding of GeoJSON.
ogr2ogr -f CSV "$work/back.csv" "$work/copy.gpkg" vertices -t_srs EPSG:32617 -lco GEOMETRY=AS_XYZ
awk -F, 'NR > 1 { x = ($1 - 500015) / 30; y = ($2 - 4500015) / 30
                  if ((x - int(x + .5)) ^ 2 > 1e-8 || (y - int(y + .5)) ^ 2 > 1e-8 || $3 != $NF) exit 1 }' "$work/back.csv" ||
  fail "a vertex is not where it was"
echo "1200 vertices, 2262 triangles and 3461 edges copied in pages"
