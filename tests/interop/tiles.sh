#!/usr/bin/env bash
# From npm: CesiumJS samples the terrain at 1,000 places, and two other decoders read every tile of three levels. They are taken
# from the folder that TINSMITH_NODE_MODULES names (see README.md).
. "$(dirname "$0")/common.sh"
need node
modules=${TINSMITH_NODE_MODULES:-}
for module in cesium @here/quantized-mesh-decoder @loaders.gl/terrain @loaders.gl/core; do
  [ -n "$modules" ] && [ -d "$modules/$module" ] || { echo "skipped: TINSMITH_NODE_MODULES has no $module"; exit 77; }
done
start_server
cp "$(dirname "$0")/tiles_client.mjs" "$work/"
ln -s "$(readlink -f "$modules")" "$work/node_modules"
node "$work/tiles_client.mjs" "$base/tins/rough"
