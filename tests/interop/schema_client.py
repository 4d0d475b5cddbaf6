"""Drives the main job knowing nothing but the contract: schema_client.py http://host DATA_FILE

Requests are made from operations of openapi.json by their operationId, as a generated client makes them: where each parameter
goes, how it is written, which bodies and media types there are. Parameters and bodies are held against their schemas before they
are sent, answers after they came.
"""
import json
import sys
import time
import urllib.error
import urllib.parse
import urllib.request

KINDS = {"object": dict, "array": list, "string": str, "boolean": bool}


class Contract:
    def __init__(self, base):
        self.base = base
        with urllib.request.urlopen(base + "/api") as answer:
            self.document = json.load(answer)
        self.operations = {}
        for path, item in self.document["paths"].items():
            for method, operation in item.items():
                if method != "parameters":
                    parameters = item.get("parameters", []) + operation.get("parameters", [])
                    self.operations[operation["operationId"]] = (method, path, operation, [self.at(p) for p in parameters])

    def at(self, node):
        while "$ref" in node:
            target = self.document
            for step in node["$ref"][2:].split("/"):
                target = target[step]
            node = target
        return node

    def wrong(self, schema, value, place):
        """The first thing that is wrong with a value, or None."""
        schema = self.at(schema)
        if value is None and schema.get("nullable"):
            return None
        for name in ("anyOf", "oneOf"):
            if name in schema:
                found = [self.wrong(part, value, place) for part in schema[name]]
                fits = found.count(None)
                if fits == 0 or (name == "oneOf" and fits > 1):
                    return f"{place}: fits {fits} of {name}: {found}"
        for part in schema.get("allOf", []):
            if bad := self.wrong(part, value, place):
                return bad
        if "enum" in schema and value not in schema["enum"]:
            return f"{place}: {value!r} is none of {schema['enum']}"
        kind = schema.get("type")
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if kind == "integer" and not (number and float(value).is_integer()) or kind == "number" and not number:
            return f"{place}: {value!r} is no {kind}"
        if kind in KINDS and not isinstance(value, KINDS[kind]):
            return f"{place}: {value!r} is no {kind}"
        if number:
            if value < schema.get("minimum", value) or value > schema.get("maximum", value):
                return f"{place}: {value} is out of range"
        if isinstance(value, list):
            if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)):
                return f"{place}: {len(value)} items"
            for i, item in enumerate(value):
                if bad := self.wrong(schema.get("items", {}), item, f"{place}/{i}"):
                    return bad
        if isinstance(value, dict):
            known = schema.get("properties", {})
            for name in schema.get("required", []):
                if name not in value:
                    return f"{place}: no {name}"
            others = schema.get("additionalProperties", True)
            for name, member in value.items():
                if name not in known and others is False:
                    return f"{place}: {name} is not known"
                rule = known.get(name, others if isinstance(others, dict) else {})
                if bad := self.wrong(rule, member, f"{place}/{name}"):
                    return bad
        return None

    def check(self, schema, value, place):
        bad = self.wrong(schema, value, place)
        assert bad is None, bad

    def call(self, operation_id, body=None, media_type="application/json", **arguments):
        """The status, header fields and body (JSON as data) of an operation's answer."""
        method, path, operation, parameters = self.operations[operation_id]
        query, fields = [], {}
        for parameter in parameters:
            name = parameter["name"]
            value = arguments.pop(name, None)
            if value is None:
                assert not parameter.get("required"), f"{operation_id} needs {name}"
                continue
            self.check(parameter["schema"], value, f"{operation_id} {name}")
            text = json.dumps(value) if isinstance(value, (bool, int, float)) else value
            if isinstance(value, list):
                assert parameter.get("explode") is False, f"{operation_id} {name}: lists are written with commas"
                text = ",".join(str(item) for item in value)
            if parameter["in"] == "path":
                path = path.replace("{" + name + "}", urllib.parse.quote(str(text), safe=""))
            elif parameter["in"] == "query":
                query.append((name, text))
            else:
                fields[name] = text
        assert not arguments, f"{operation_id} knows no {list(arguments)}"
        assert "{" not in path, path
        data = None
        if body is not None:
            content = operation["requestBody"]["content"]
            form = content.get(media_type) or content["*/*"]
            if not isinstance(body, bytes):
                self.check(form["schema"], body, operation_id)
            data = body if isinstance(body, bytes) else json.dumps(body).encode()
            fields["Content-Type"] = media_type
        url = self.base + path + ("?" + urllib.parse.urlencode(query) if query else "")
        request = urllib.request.Request(url, data=data, method=method.upper(), headers=fields)
        try:
            with urllib.request.urlopen(request) as answer:
                return self.received(operation_id, operation, answer)
        except urllib.error.HTTPError as refused:
            return self.received(operation_id, operation, refused)

    def received(self, operation_id, operation, answer):
        content = answer.read()
        responses = operation["responses"]
        form = self.at(responses.get(str(answer.status)) or responses["default"]).get("content", {})
        media_type = answer.headers.get("Content-Type", "")
        if not content:
            return answer.status, answer.headers, None
        listed = form.get(media_type) or form.get(media_type.split(";")[0].strip())
        assert listed, f"{operation_id} {answer.status}: {media_type} is none of {list(form)}"
        if "json" not in media_type:
            return answer.status, answer.headers, content
        data = json.loads(content)
        self.check(listed["schema"], data, f"{operation_id} {answer.status}")
        return answer.status, answer.headers, data

    def fine(self, operation_id, *arguments, expected=(200, 201, 204), **named):
        got, fields, data = self.call(operation_id, *arguments, **named)
        assert got in expected, f"{operation_id}: {got} {data}"
        return fields, data

    def values_of(self, operation_id, name):
        """What an enumerated parameter may be."""
        for parameter in self.operations[operation_id][3]:
            if parameter["name"] == name:
                return parameter["schema"]["enum"]
        raise KeyError(name)


def main(base, file):
    contract = Contract(base)
    contract.fine("getHealth")
    # Import.
    with open(file, "rb") as data:
        fields, tin = contract.fine("createTin", data.read(), media_type="text/plain", id="drive", crs="EPSG:32617")
    assert fields["Location"].endswith("/tins/drive"), fields["Location"]
    _, listed = contract.fine("listTins")
    assert any(one["id"] == "drive" for one in listed["tins"])
    count = tin["vertexCount"]
    west, south, east, north = tin["bbox"]
    x, y = (west + east) / 2, (south + north) / 2
    # Edit, and see it.
    ops = [{"op": "insert", "x": x + 1, "y": y + 2, "z": 500.5}]
    fields, edited = contract.fine("editTin", {"ops": ops, "author": "client", "note": "a peak"}, tin="drive")
    peak = edited["results"][0]["id"]
    _, seen = contract.fine("getElevation", tin="drive", x=x + 1, y=y + 2)
    assert seen["z"] == 500.5 and seen["revision"] == edited["revision"]
    status, _, problem = contract.call("editTin", {"ops": [{"op": "remove", "id": 10**9}]}, tin="drive")
    assert status == 422 and problem["status"] == 422
    fields, _ = contract.fine("getTin", tin="drive")
    contract.fine("editTin", {"ops": [{"op": "set-z", "id": peak, "z": 400}]}, tin="drive", **{"If-Match": fields["ETag"]})
    status, _, _ = contract.call("editTin", {"ops": [{"op": "set-z", "id": peak, "z": 1}]}, tin="drive",
                                 **{"If-Match": fields["ETag"]})
    assert status == 412
    _, item = contract.fine("getItem", tin="drive", collection="vertices", feature=str(peak))
    assert item["properties"]["z"] == 400
    _, history = contract.fine("listRevisions", tin="drive")
    contract.fine("revertRevision", {}, tin="drive", revision=history["revisions"][0]["revision"])
    # Every feature, page by page.
    for collection in contract.values_of("getItems", "collection"):
        features, token, matched = 0, None, None
        while True:
            named = {"next": token} if token else {}
            _, page = contract.fine("getItems", tin="drive", collection=collection, limit=500, **named)
            features += page["numberReturned"]
            matched = page["numberMatched"]
            following = [link["href"] for link in page["links"] if link["rel"] == "next"]
            if not following:
                break
            token = urllib.parse.parse_qs(urllib.parse.urlparse(following[0]).query)["next"][0]
        assert features == matched, (collection, features, matched)
    # Simplify as a job; every process is described.
    for process in contract.values_of("getProcess", "process"):
        _, description = contract.fine("getProcess", process=process)
        assert description["id"] == process
    _, processes = contract.fine("listProcesses")
    assert sorted(p["id"] for p in processes["processes"]) == sorted(contract.values_of("getProcess", "process"))
    inputs = {"tin": "drive", "tolerance": 3, "as": "drive-3"}
    fields, job = contract.fine("execute", {"inputs": inputs}, process="simplify", Prefer="respond-async")
    assert fields["Preference-Applied"] == "respond-async"
    for _ in range(600):
        _, job = contract.fine("getJob", job=job["jobID"])
        if job["status"] not in ("accepted", "running"):
            break
        time.sleep(0.1)
    assert job["status"] == "successful", job
    _, result = contract.fine("getResults", job=job["jobID"])
    _, simple = contract.fine("getTin", tin="drive-3")
    assert simple["vertexCount"] < count, simple
    _, jobs = contract.fine("listJobs", status=["successful"], processID=["simplify"])
    assert [one["jobID"] for one in jobs["jobs"]] == [job["jobID"]]
    _, volume = contract.fine("execute", {"inputs": {"tin": "drive-3", "level": 0}}, process="volume")
    assert volume["volumeAbove"] > 0
    # The surface, in several ways.
    _, line = contract.fine("getProfile", tin="drive-3", coords=[west, south, east, north])
    assert abs(line["length"] - ((east - west) ** 2 + (north - south) ** 2) ** 0.5) < 1
    _, coverage = contract.fine("queryPosition", tin="drive-3", coords=f"POINT({x} {y})", crs="EPSG:32617", f="CoverageJSON")
    _, one = contract.fine("getElevation", tin="drive-3", x=x, y=y)
    assert coverage["ranges"]["elevation"]["values"] == [one["z"]]
    contract.fine("getTerrainLayer", tin="drive-3")
    # Export in every format.
    for name in contract.values_of("exportTin", "f"):
        _, exported = contract.fine("exportTin", tin="drive-3", f=name)
        assert exported, name
    contract.fine("deleteTin", tin="drive", expected=(204,))
    status, _, _ = contract.call("getTin", tin="drive")
    assert status == 404
    print("the contract alone was enough:", count, "vertices in,", simple["vertexCount"], "out")


main(sys.argv[1], sys.argv[2])
