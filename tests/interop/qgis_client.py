"""Opens a TIN's collections as QGIS does: qgis_client.py http://host/tins/rough"""
import os
import sys

from qgis.core import QgsApplication, QgsRectangle, QgsVectorLayer, QgsWkbTypes

QgsApplication.setPrefixPath("/usr", True)
application = QgsApplication([], False)
application.initQgis()
expected = {
    "vertices": (1200, QgsWkbTypes.PointZ),
    "triangles": (2262, QgsWkbTypes.PolygonZ),
    "edges": (3461, QgsWkbTypes.LineStringZ),
}
for name, (count, kind) in expected.items():
    uri = f"pagingEnabled='true' restrictToRequestBBOX='0' typename='{name}' url='{sys.argv[1]}' version='auto'"
    layer = QgsVectorLayer(uri, name, "OAPIF")
    assert layer.isValid(), layer.error().message()
    assert layer.wkbType() == kind, layer.wkbType()
    assert layer.featureCount() == count, layer.featureCount()
    assert sum(1 for _ in layer.getFeatures()) == count
    # 40 x 30 cells of 30 m west of the zone's middle meridian, 81 W.
    assert QgsRectangle(-81.001, 40.64, -80.98, 40.66).contains(layer.extent()), layer.extent().toString()
    print(name, count)
sys.stdout.flush()
os._exit(0)  # QGIS 3.22 may fall over its own threads when it ends
