"""Walks through a TIN's service with OWSLib: owslib_client.py http://host/tins/rough"""
import sys

from owslib.ogcapi.features import Features

service = Features(sys.argv[1])
assert service.response["title"] == "rough"
assert "http://www.opengis.net/spec/ogcapi-features-1/1.0/conf/core" in service.conformance()["conformsTo"]
assert service.api()["openapi"].startswith("3.0")
assert sorted(service.feature_collections()) == ["edges", "triangles", "vertices"], service.feature_collections()
assert service.collection("vertices")["itemType"] == "feature"

page = service.collection_items("vertices", limit=7)
assert page["numberMatched"] == 1200 and page["numberReturned"] == len(page["features"]) == 7
first = page["features"][0]
assert service.collection_item("vertices", str(first["id"]))["geometry"] == first["geometry"]
lon, lat = first["geometry"]["coordinates"][:2]
near = service.collection_items("vertices", bbox=[lon - 1e-5, lat - 1e-5, lon + 1e-5, lat + 1e-5])
assert [feature["id"] for feature in near["features"]] == [first["id"]]
print("OWSLib found", page["numberMatched"], "vertices")

from owslib.ogcapi.coverages import Coverages

service = Coverages(sys.argv[1])
assert service.coverages() == ["surface"], service.coverages()
assert service.coverage_domainset("surface")["generalGrid"]["axisLabels"] == ["Long", "Lat"]
assert service.coverage_rangetype("surface")["field"][0]["name"] == "elevation"
tiff = service.coverage("surface").read()
assert tiff[:2] in (b"II", b"MM"), tiff[:20]
print("OWSLib read a coverage of", len(tiff), "bytes")
