#!/usr/bin/env bash
# QGIS's own engine, without a screen: the collections as OAPIF layers, exports as mesh layers. Needs python3-qgis.
. "$(dirname "$0")/common.sh"
/usr/bin/python3 -c 'import qgis.core' 2>/dev/null || { echo "skipped: there is no python3-qgis"; exit 77; }
start_server
export QT_QPA_PLATFORM=offscreen XDG_RUNTIME_DIR=$work HOME=$work
/usr/bin/python3 "$(dirname "$0")/qgis_client.py" "$base/tins/rough" "$work"
