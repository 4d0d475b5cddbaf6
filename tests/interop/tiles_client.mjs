// Reads a TIN's terrain tiles as others do: tiles_client.mjs http://host/tins/rough
import assert from 'node:assert';
import decodeModule from '@here/quantized-mesh-decoder';
import { parse } from '@loaders.gl/core';
import { QuantizedMeshLoader } from '@loaders.gl/terrain';
import { Cartographic, CesiumTerrainProvider, sampleTerrainMostDetailed } from 'cesium';

const decode = decodeModule.default ?? decodeModule;
const tin = process.argv[2];
const layer = await (await fetch(`${tin}/terrain/layer.json`)).json();
const lowest = layer.available.length - 1;

async function fetchTile(z, x, y) {
  const answer = await fetch(`${tin}/terrain/${z}/${x}/${y}.terrain?v=${layer.version}`, {
    headers: { Accept: 'application/vnd.quantized-mesh;extensions=octvertexnormals-metadata' },
  });
  assert.equal(answer.status, 200, `${z}/${x}/${y}`);
  return answer.arrayBuffer();
}

// Every tile of the three lowest levels, by two decoders; shared sides decode alike.
let tiles = 0;
let worst = 0;
for (let z = Math.max(0, lowest - 2); z <= lowest; z++) {
  for (const range of layer.available[z]) {
    const sides = new Map();
    for (let y = range.startY; y <= range.endY; y++) {
      for (let x = range.startX; x <= range.endX; x++) {
        const buffer = await fetchTile(z, x, y);
        const tile = decode(buffer);
        const count = tile.vertexData.length / 3;
        const [u, v, h] = [0, 1, 2].map((k) => tile.vertexData.subarray(k * count, (k + 1) * count));
        const { minHeight, maxHeight } = tile.header;
        const side = (indices, along) =>
          [...indices].map((i) => `${along[i]}:${minHeight + ((maxHeight - minHeight) * h[i]) / 32767}`).sort().join(' ');
        const west = side(tile.westIndices, v), south = side(tile.southIndices, u);
        if (sides.has(`e${x - 1},${y}`)) assert.equal(west, sides.get(`e${x - 1},${y}`), `west of ${z}/${x}/${y}`);
        if (sides.has(`n${x},${y - 1}`)) assert.equal(south, sides.get(`n${x},${y - 1}`), `south of ${z}/${x}/${y}`);
        sides.set(`e${x},${y}`, side(tile.eastIndices, v));
        sides.set(`n${x},${y}`, side(tile.northIndices, u));
        const error = tile.extensions?.metadata?.geometricerror;
        if (z === lowest) worst = Math.max(worst, error);
        const mesh = await parse(buffer, QuantizedMeshLoader, { 'quantized-mesh': { bounds: [0, 0, 1, 1] }, worker: false });
        assert.equal(mesh.attributes.POSITION.value.length / 3, count);
        assert.equal(mesh.indices.value.length, tile.triangleIndices.length);
        tiles++;
      }
    }
  }
}
assert.ok(Number.isFinite(worst) && worst > 0, 'the lowest level states its error');

// CesiumJS against the server's own elevations.
const provider = await CesiumTerrainProvider.fromUrl(`${tin}/terrain`, { requestVertexNormals: true });
const [west, south, east, north] = layer.bounds;
let seed = 20021128;
const random = () => ((seed = (seed * 1103515245 + 12345) % 2147483648) / 2147483648);
const places = [];
for (let i = 0; i < 1000; i++) {
  places.push([west + (east - west) * (0.02 + 0.96 * random()), south + (north - south) * (0.02 + 0.96 * random())]);
}
const sampled = await sampleTerrainMostDetailed(provider, places.map(([lon, lat]) => Cartographic.fromDegrees(lon, lat)));
const answer = await fetch(`${tin}/elevation`, {
  method: 'POST',
  headers: { 'Content-Type': 'application/json' },
  body: JSON.stringify({ crs: 'EPSG:4326', positions: places }),
});
const { z } = await answer.json();
let compared = 0;
let largest = 0;
for (let i = 0; i < places.length; i++) {
  if (z[i] === null) continue;
  const difference = Math.abs(sampled[i].height - z[i]);
  assert.ok(difference <= worst, `${places[i]}: Cesium ${sampled[i].height}, server ${z[i]}, stated ${worst}`);
  largest = Math.max(largest, difference);
  compared++;
}
assert.ok(compared > 900, `${compared} places compared`);
console.log(`${tiles} tiles decoded twice; ${compared} places: largest difference ${largest.toFixed(4)} m, stated ${worst.toFixed(4)} m`);
