"""How long tiles take over HTTP: tile_latency.py [--tiles N] [--pid SERVER] http://HOST/tins/TIN

Asks for N different tiles of the three lowest levels, at random, one after another on one connection: first tiles that were never
asked for (cold), then the same again (warm). Prints a JSON line for each kind and state: median, 99th percentile and slowest in
milliseconds, and with --pid the server's processor time for a tile, in the mean and at the 99th percentile. That is what to look
at on a busy machine.
"""
import argparse
import http.client
import json
import os
import random
import time
import urllib.parse


def cpu_ms(pid):
    """Processor time of all threads so far."""
    total = 0
    for task in os.listdir(f"/proc/{pid}/task"):
        with open(f"/proc/{pid}/task/{task}/schedstat") as stat:
            total += int(stat.read().split()[0])
    return total / 1e6


def p99(values):
    return round(sorted(values)[min(len(values) - 1, len(values) * 99 // 100)], 3)


def measure(connection, targets, accept, pid):
    times, worked = [], []
    for target in targets:
        before = cpu_ms(pid) if pid else 0
        begun = time.perf_counter()
        connection.request("GET", target, headers={"Accept": accept, "Accept-Encoding": "gzip"})
        answer = connection.getresponse()
        answer.read()
        times.append((time.perf_counter() - begun) * 1000)
        worked.append(cpu_ms(pid) - before if pid else 0)
        if answer.status != 200:
            raise SystemExit(f"{target}: {answer.status}")
    times.sort()
    result = {
        "tiles": len(times),
        "median_ms": round(times[len(times) // 2], 3),
        "p99_ms": p99(times),
        "slowest_ms": round(times[-1], 3),
    }
    if pid:
        result["cpu_ms"] = round(sum(worked) / len(worked), 3)
        result["p99_cpu_ms"] = p99(worked)
    return result


def pick(ranges, count, rng):
    """Different tiles, most of them of the lowest level."""
    found = set()
    room = sum((x1 - x0 + 1) * (y1 - y0 + 1) for _, x0, y0, x1, y1 in ranges)
    while len(found) < min(count, room):
        z, x0, y0, x1, y1 = rng.choices(ranges, weights=[(r[3] - r[1] + 1) * (r[4] - r[2] + 1) for r in ranges])[0]
        found.add((z, rng.randint(x0, x1), rng.randint(y0, y1)))
    tiles = sorted(found)
    rng.shuffle(tiles)
    return tiles


def mercator_ranges(document):
    import math

    west, south, east, north = document["bounds"]
    ranges = []
    for z in range(max(0, document["maxzoom"] - 2), document["maxzoom"] + 1):
        def row(latitude):
            return (1 - math.asinh(math.tan(math.radians(latitude))) / math.pi) / 2 * 2**z
        ranges.append((z, int((west + 180) / 360 * 2**z), int(row(north)), int((east + 180) / 360 * 2**z), int(row(south))))
    return ranges


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("tin")
    arguments.add_argument("--tiles", type=int, default=1000)
    arguments.add_argument("--pid", type=int)
    arguments.add_argument("--seed", type=int, default=1)
    wanted = arguments.parse_args()
    url = urllib.parse.urlparse(wanted.tin)
    connection = http.client.HTTPConnection(url.netloc)
    rng = random.Random(wanted.seed)

    def document(path):
        connection.request("GET", url.path + path)
        return json.load(connection.getresponse())

    layer = document("/terrain/layer.json")
    lowest = len(layer["available"]) - 1
    terrain = [(z, r["startX"], r["startY"], r["endX"], r["endY"])
               for z in range(max(0, lowest - 2), lowest + 1) for r in layer["available"][z]]
    kinds = {
        "quantized-mesh": (terrain, "/terrain/{}/{}/{}.terrain",
                           "application/vnd.quantized-mesh;extensions=octvertexnormals-metadata"),
        "terrarium": (mercator_ranges(document("/dem/terrarium/tilejson.json")), "/dem/terrarium/{}/{}/{}.png", "image/png"),
        "hillshade": (mercator_ranges(document("/hillshade/tilejson.json")), "/hillshade/{}/{}/{}.png", "image/png"),
    }
    for kind, (ranges, path, accept) in kinds.items():
        targets = [url.path + path.format(*tile) for tile in pick(ranges, wanted.tiles, rng)]
        for state in ("cold", "warm"):
            print(json.dumps({"kind": kind, "state": state, **measure(connection, targets, accept, wanted.pid),
                              "load": round(os.getloadavg()[0], 1)}), flush=True)


main()
