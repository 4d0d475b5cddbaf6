// node peers.mjs HEIGHTS.f32 WIDTH HEIGHT PREFIX TOLERANCE...: simplifies by delatin, martini and meshoptimizer, those that
// `npm install delatin @mapbox/martini meshoptimizer` put beside the working directory, and leaves their TINs for
// `tinsmith-bench simplify --peers PREFIX` to judge.
import fs from 'node:fs';
import {createRequire} from 'node:module';
import path from 'node:path';
import {pathToFileURL} from 'node:url';

const [file, widthText, heightText, prefix, ...tolerances] = process.argv.slice(2);
const width = Number(widthText), height = Number(heightText);
const bytes = fs.readFileSync(file);
const z = new Float32Array(bytes.buffer, bytes.byteOffset, width * height);
const require = createRequire(path.join(process.cwd(), 'x.js'));

async function load(name) {
  try {
    const loaded = await import(pathToFileURL(require.resolve(name)).href);
    return loaded.default ?? loaded;
  } catch {
    console.error(`${name} is not installed: left out`);
    return null;
  }
}

/// coordinates: columns and rows, in turns; triangles: indices, three each.
function write(who, tolerance, spent, coordinates, triangles) {
  const name = `${prefix}-${who}-${tolerance}.tin`, out = [`${coordinates.length / 2} ${triangles.length / 3}`];
  for (let i = 0; i < coordinates.length; i += 2) {
    out.push(`${coordinates[i]} ${coordinates[i + 1]} ${z[coordinates[i + 1] * width + coordinates[i]]}`);
  }
  for (let i = 0; i < triangles.length; i += 3) out.push(`${triangles[i]} ${triangles[i + 1]} ${triangles[i + 2]}`);
  fs.writeFileSync(name, out.join('\n') + '\n');
  fs.appendFileSync(`${prefix}.list`, `${who} ${tolerance} ${spent.cpu} ${spent.wall} ${name}\n`);
}

function timed(work) {
  const cpu = process.cpuUsage(), start = performance.now();
  const result = work();
  const {user, system} = process.cpuUsage(cpu);
  return [{cpu: (user + system) / 1e6, wall: (performance.now() - start) / 1e3}, result];
}

fs.writeFileSync(`${prefix}.list`, '');
const Delatin = await load('delatin'), Martini = await load('@mapbox/martini'), meshoptimizer = await load('meshoptimizer');

for (const tolerance of tolerances.map(Number)) {
  if (Delatin) {
    const [spent, tin] = timed(() => {
      const tin = new Delatin(z, width, height);
      tin.run(tolerance);
      return tin;
    });
    write('delatin', tolerance, spent, tin.coords, tin.triangles);
  }
  if (Martini) {
    // A power of two and one more; the last rows and columns are repeated, and cut off again.
    const side = 2 ** Math.ceil(Math.log2(Math.max(width, height) - 1)) + 1;
    const square = new Float32Array(side * side);
    for (let row = 0; row < side; ++row) {
      for (let column = 0; column < side; ++column) {
        square[row * side + column] = z[Math.min(row, height - 1) * width + Math.min(column, width - 1)];
      }
    }
    const [spent, mesh] = timed(() => new Martini(side).createTile(square).getMesh(tolerance));
    const inside = [], index = new Map(), triangles = [];
    const within = (i) => mesh.vertices[2 * i] < width && mesh.vertices[2 * i + 1] < height;
    for (let i = 0; i < mesh.triangles.length; i += 3) {
      const corners = [...mesh.triangles.slice(i, i + 3)];
      if (!corners.every(within)) continue;
      for (const corner of corners) {
        if (!index.has(corner)) {
          index.set(corner, index.size);
          inside.push(mesh.vertices[2 * corner], mesh.vertices[2 * corner + 1]);
        }
        triangles.push(index.get(corner));
      }
    }
    write('martini', tolerance, spent, inside, triangles);
  }
  if (meshoptimizer?.MeshoptSimplifier ?? meshoptimizer) {
    const simplifier = meshoptimizer.MeshoptSimplifier ?? meshoptimizer;
    await simplifier.ready;
    const positions = new Float32Array(3 * width * height), indices = new Uint32Array(6 * (width - 1) * (height - 1));
    for (let i = 0; i < width * height; ++i) positions.set([i % width, Math.floor(i / width), z[i]], 3 * i);
    for (let row = 0, k = 0; row + 1 < height; ++row) {
      for (let column = 0; column + 1 < width; ++column, k += 6) {
        const a = row * width + column;
        indices.set([a, a + width, a + 1, a + 1, a + width, a + width + 1], k);
      }
    }
    const [spent, [kept]] = timed(() => simplifier.simplify(indices, positions, 3, 3, tolerance, ['ErrorAbsolute', 'LockBorder']));
    const index = new Map(), coordinates = [], triangles = [];
    for (const vertex of kept) {
      if (!index.has(vertex)) {
        index.set(vertex, index.size);
        coordinates.push(vertex % width, Math.floor(vertex / width));
      }
      triangles.push(index.get(vertex));
    }
    write('meshoptimizer', tolerance, spent, coordinates, triangles);
  }
}
