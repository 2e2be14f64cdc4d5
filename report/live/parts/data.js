// Data of a page: numbers that Python packed (`report/live/embed.py`), as typed arrays.

const KINDS = {
  f8: Float64Array, f4: Float32Array, i4: Int32Array, u4: Uint32Array,
  i2: Int16Array, u2: Uint16Array, i1: Int8Array, u1: Uint8Array,
};

function bytes(text) {
  const plain = atob(text), out = new Uint8Array(plain.length);
  for (let i = 0; i < plain.length; i++) out[i] = plain.charCodeAt(i);
  return out;
}

/** Doubles of which only the upper bytes were kept. */
function lengthened(kept, each) {
  const out = new Uint8Array(8 * kept.length / each);
  for (let i = 0; i < kept.length; i++) out[8 * Math.floor(i / each) + 8 - each + i % each] = kept[i];
  return new Float64Array(out.buffer);
}

/** One packed array: { values, shape, unit, name }; whole numbers with a grain become Float32. */
export function unpacked(packed) {
  const own = bytes(packed.base64), Kind = KINDS[packed.kind];
  let values = Kind ? new Kind(own.buffer) : lengthened(own, Number(packed.kind[1]));
  if (packed.grain !== 1) values = Float32Array.from(values, v => v * packed.grain);
  return { values, shape: packed.shape, unit: packed.unit, name: packed.name };
}

/** A tree of JSON in which every packed array has become a typed one. */
export function decoded(tree) {
  if (Array.isArray(tree)) return tree.map(decoded);
  if (tree === null || typeof tree !== "object") return tree;
  if (typeof tree.base64 === "string") return unpacked(tree);
  return Object.fromEntries(Object.entries(tree).map(([key, value]) => [key, decoded(value)]));
}

/** The data of this page, from its element of type application/json. */
export function pageData(id = "live-data") {
  return decoded(JSON.parse(document.getElementById(id).textContent));
}
