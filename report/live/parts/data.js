// Data of a page: numbers that Python packed (`report/live/embed.py`), as typed arrays.

const KINDS = {
  f8: Float64Array, f4: Float32Array, i4: Int32Array, u4: Uint32Array,
  i2: Int16Array, u2: Uint16Array, i1: Int8Array, u1: Uint8Array,
};

/** Bytes of an element with base64, inflated. */
async function inflated(id) {
  const plain = atob(document.getElementById(id).textContent), own = new Uint8Array(plain.length);
  for (let i = 0; i < plain.length; i++) own[i] = plain.charCodeAt(i);
  const stream = new Blob([own]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

/** Doubles of which only the upper bytes were kept. */
function lengthened(kept, each) {
  const out = new Uint8Array(8 * kept.length / each);
  for (let i = 0, to = 8 - each; i < kept.length; to += 8) {
    for (let k = 0; k < each; k++) out[to + k] = kept[i++];
  }
  return new Float64Array(out.buffer);
}

/** One packed array: { values, shape, unit, name }; whole numbers with a grain become Float32. */
function unpacked(packed, all) {
  const own = all.slice(packed.from, packed.from + packed.bytes), Kind = KINDS[packed.kind];
  let values = Kind ? new Kind(own) : lengthened(new Uint8Array(own), Number(packed.kind[1]));
  if (packed.grain !== 1) values = Float32Array.from(values, v => v * packed.grain);
  return { values, shape: packed.shape, unit: packed.unit, name: packed.name };
}

/** A tree of JSON in which every packed array has become a typed one. */
function decoded(tree, all) {
  if (Array.isArray(tree)) return tree.map(one => decoded(one, all));
  if (tree === null || typeof tree !== "object") return tree;
  if (typeof tree.bytes === "number") return unpacked(tree, all);
  return Object.fromEntries(Object.entries(tree).map(([key, one]) => [key, decoded(one, all)]));
}

/** The data of this page. */
export async function pageData() {
  const all = await inflated("live-arrays");
  return decoded(JSON.parse(document.getElementById("live-data").textContent), all);
}
