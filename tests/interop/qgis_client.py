"""Opens a TIN's collections as QGIS does: qgis_client.py http://host/tins/rough FOLDER"""
import os
import sys
import urllib.request

from qgis.core import QgsApplication, QgsMeshLayer, QgsRectangle, QgsVectorLayer, QgsWkbTypes

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
# An exported mesh, in the terrain's own CRS: 40 x 30 cell centres from (500015, 4500015) on.
for name in ("2dm", "ply-ascii"):
    file = os.path.join(sys.argv[2], "rough." + name.split("-")[0])
    urllib.request.urlretrieve(f"{sys.argv[1]}/export?f={name}", file)
    mesh = QgsMeshLayer(file, name, "mdal")
    assert mesh.isValid(), mesh.error().message()
    provider = mesh.dataProvider()
    assert provider.vertexCount() == 1200, provider.vertexCount()
    assert provider.faceCount() == 2262, provider.faceCount()
    assert mesh.extent() == QgsRectangle(500015, 4500015, 501185, 4500885), mesh.extent().toString()
    print(name, provider.vertexCount(), provider.faceCount())
sys.stdout.flush()
os._exit(0)  # QGIS 3.22 may fall over its own threads when it ends
