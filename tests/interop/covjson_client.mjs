// Reads EDR answers with covjson-reader: covjson_client.mjs http://host/tins/rough
import assert from 'node:assert';
import { createRequire } from 'node:module';

const { read } = createRequire(import.meta.url)('covjson-reader');
const tin = process.argv[2];
const surface = `${tin}/collections/surface`;

async function coverage(query) {
  const answer = await fetch(`${surface}/${query}`);
  assert.equal(answer.status, 200, query);
  assert.equal(answer.headers.get('content-type'), 'application/vnd.cov+json');
  return read(await answer.json());
}

async function elevation(lon, lat) {
  return (await (await fetch(`${tin}/elevation?x=${lon}&y=${lat}&crs=EPSG:4326`)).json()).z;
}

const [lon, lat] = [-80.993, 40.655];
const point = await coverage(`position?coords=POINT(${lon} ${lat})`);
assert.equal(point.parameters.get('elevation').observedProperty.label.en, 'Elevation');
assert.equal((await point.loadRange('elevation')).get({}), await elevation(lon, lat));

const line = await coverage(`trajectory?coords=LINESTRING(-80.998 40.652,-80.988 40.658)`);
const domain = await line.loadDomain();
const heights = await line.loadRange('elevation');
const distances = await line.loadRange('distance');
const places = domain.axes.get('composite').values;
assert.ok(places.length > 10);
for (let i = 0; i < places.length; i++) {
  if (i > 0) assert.ok(distances.get({ composite: i }) >= distances.get({ composite: i - 1 }));
  const z = await elevation(...places[i]);
  assert.ok(Math.abs(heights.get({ composite: i }) - z) < 0.02, `${places[i]}: ${heights.get({ composite: i })}, ${z}`);
}

const grid = await coverage('cube?bbox=-80.998,40.652,-80.988,40.658&resolution-x=5&resolution-y=4');
const { axes } = await grid.loadDomain();
const values = await grid.loadRange('elevation');
assert.deepEqual([axes.get('x').values.length, axes.get('y').values.length], [5, 4]);
for (let y = 0; y < 4; y++) {
  for (let x = 0; x < 5; x++) {
    assert.equal(values.get({ x, y }), await elevation(axes.get('x').values[x], axes.get('y').values[y]));
  }
}
console.log(`covjson-reader read a point, a line of ${places.length} places and a grid`);
