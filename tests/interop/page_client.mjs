// Runs the script of the page at / in a document that has no more than the page asks for, against a server with tokens.
//
//   node page_client.mjs BASE GOOD_TOKEN WRITE_ONLY_TOKEN
import assert from 'node:assert/strict';

const [base, good, writeOnly] = process.argv.slice(2);
const page = await (await fetch(base, {headers: {Accept: 'text/html'}})).text();
const script = page.slice(page.indexOf('<script>') + 8, page.lastIndexOf('</script>'));

class Node {
  constructor(tag = '') { this.tag = tag; this.children = []; this.attributes = {}; this.style = {}; this.listeners = {}; this.textContent = ''; this.value = ''; this.hidden = true; this.classList = {toggle() {}}; }
  set href(value) { this.attributes.href = value; }
  get href() { return this.attributes.href; }
  getAttribute(name) { return this.attributes[name] ?? null; }
  append(...items) { this.children.push(...items); }
  replaceChildren(...items) { this.children = items; }
  insertRow() { const row = new Node('tr'); this.children.push(row); return row; }
  insertCell() { const cell = new Node('td'); this.children.push(cell); return cell; }
  get rows() { return this.children; }
  get cells() { return this.children; }
  get firstChild() { return this.children[0]; }
  closest(selector) { return this.tag === 'a' && selector.startsWith('a') && this.href?.startsWith('/') ? this : null; }
  click() { this.onclick ? this.onclick() : clicked.push(this); }
  getContext() { return {clearRect() {}, createImageData: (w, h) => ({data: new Uint8ClampedArray(4 * w * h)}), putImageData: () => { painted += 1; }}; }
}
const elements = {}, clicked = [], blobs = [], handlers = {};
let painted = 0;
const document = {
  getElementById: id => id.startsWith('row-') ? elements[id] ?? null : elements[id] ??= new Node(id),
  createElement: tag => new Node(tag),
  addEventListener: (kind, handler) => { handlers[kind] = handler; },
};
// A row that the page names is found by its name.
document.getElementById('tins').insertRow = function () { const row = new Node('tr'); this.children.push(row); Object.defineProperty(row, 'id', {set: id => { elements[id] = row; }}); return row; };
const stored = new Map();
const sessionStorage = {getItem: k => stored.get(k) ?? null, setItem: (k, v) => stored.set(k, v), removeItem: k => stored.delete(k)};
const location = {hash: ''};
const URLs = {createObjectURL: blob => { blobs.push(blob); return 'blob:' + blobs.length; }, revokeObjectURL() {}};
const asked = [];
const fetchHere = (path, options) => { asked.push([path, options?.headers?.Authorization]); return fetch(base + path, options); };

new Function('document', 'sessionStorage', 'location', 'fetch', 'URL', 'setTimeout', script)(
  document, sessionStorage, location, fetchHere, URLs, () => {});

async function until(what, condition) {
  for (let i = 0; i < 500; ++i) {
    if (condition()) return;
    await new Promise(done => setTimeout(done, 20));
  }
  assert.fail('it never came to this: ' + what);
}
const submit = value => { document.getElementById('token').value = value; elements.access.onsubmit({preventDefault() {}}); };
const texts = node => typeof node === 'string' ? node : node.textContent + node.children.map(texts).join('');

await until('the page asks for a token', () => !elements.access.hidden);
assert.equal(document.getElementById('refused').textContent, '', 'nothing was refused yet');
submit('tinsmith_wrong');
await until('it says that the token is not known', () => /not known/.test(document.getElementById('refused').textContent));
submit(writeOnly);
await until('it says that a scope is missing', () => /scope/.test(document.getElementById('refused').textContent));
submit(good);
await until('it lists the terrain', () => /rough/.test(texts(elements.tins)));
await until('it paints the terrain', () => painted > 0);
assert.equal(document.getElementById('token').value, '', 'the token is not shown');
assert.ok(asked.slice(-2).every(([, sent]) => sent === 'Bearer ' + good));

const links = [];
const collect = node => { if (node instanceof Node) { if (node.tag === 'a') links.push(node); node.children.forEach(collect); } };
collect(elements.tins);
const geotiff = links.find(link => /geotiff/.test(link.href));
let prevented = false;
await handlers.click({target: geotiff, preventDefault() { prevented = true; }});
assert.ok(prevented && blobs.length === 1, 'a download is fetched with the token');
assert.equal(new DataView(await blobs[0].arrayBuffer()).getUint16(0), 0x4949, 'a TIFF');
assert.match(clicked.at(-1).download, /rough.*\.tif/);

elements.forget.onclick();
await until('the terrain is gone with the token', () => !/rough/.test(texts(elements.tins)));
assert.equal(stored.size, 0);
prevented = false;
await handlers.click({target: geotiff, preventDefault() { prevented = true; }});
assert.ok(!prevented, 'without a token a link is a link');
console.log('the page works with tokens');
