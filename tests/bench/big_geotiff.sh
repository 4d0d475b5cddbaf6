#!/usr/bin/env bash
# A GeoTIFF of 20,000 x 20,000 pixels over HTTP, and how much memory the server takes for it: big_geotiff.sh TINSMITH [SIDE]
set -euo pipefail
tinsmith=$1 side=${2:-20000}
. "$(dirname "${BASH_SOURCE[0]}")/../support/serve.sh"
serve "$tinsmith" '{"limits":{"export_seconds":3600}}'
{
  printf 'ncols 500\nnrows 500\nxllcorner 500000\nyllcorner 4500000\ncellsize 40\nNODATA_value -9999\n'
  awk 'BEGIN { srand(1); for (j = 0; j < 500; j++) { for (i = 0; i < 500; i++) printf "%.1f ", 200 + i / 4 - j / 2 + 20 * rand(); print "" } }'
} >"$work/rough.asc"
curl -fsS -o /dev/null --data-binary @"$work/rough.asc" "$base/tins?id=rough&crs=EPSG:32617"
resident() { awk -v name="$1" '$1 == name":" { print $2 }' "/proc/$server/status"; }
before=$(resident VmRSS)
cell=$(awk -v side="$side" 'BEGIN { printf "%.10g", 20000 / side }')
begun=$(date +%s.%N)
curl -fsS -o "$work/big.tif" "$base/tins/rough/export?f=geotiff&cell-size=$cell&bbox=500000,4500000,520000,4520000"
ended=$(date +%s.%N)
size=$(gdalinfo "$work/big.tif" | sed -n 's/^Size is //p')
printf '{"pixels":"%s","seconds":%.1f,"cpu_seconds":%.1f,"file_bytes":%d,"resident_before_kb":%d,"resident_peak_kb":%d}\n' \
  "$size" "$(echo "$ended - $begun" | bc)" \
  "$(awk -v hz="$(getconf CLK_TCK)" '{ print ($14 + $15) / hz }' "/proc/$server/stat")" \
  "$(stat -c %s "$work/big.tif")" "$before" "$(resident VmHWM)"
