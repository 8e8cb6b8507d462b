// SPDX-License-Identifier: Apache-2.0
// Arrays out of the page's blocks of text; presswork/report/pack.py writes them.

export const MISSING = Math.fround(1e30); // stands for a value that is not finite
const LEVELS = 65534;

async function readBlock(block) {
  const text = typeof block === "number" ? document.getElementById(`block-${block}`).textContent : block;
  const bytes = Uint8Array.fromBase64 ? Uint8Array.fromBase64(text) : Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

function joinBytes(bytes, size) {
  const n = bytes.length / size;
  const found = size === 2 ? new Uint16Array(n) : new Uint32Array(n);
  for (let rank = 0; rank < size; rank++) {
    const shift = 8 * rank, start = rank * n;
    for (let i = 0; i < n; i++) found[i] |= bytes[start + i] << shift;
  }
  return found;
}

function sumDifferences(values) {
  let last = 0;
  for (let i = 0; i < values.length; i++) {
    const step = (values[i] >>> 1) ^ -(values[i] & 1);
    values[i] = last + step;
    last = values[i];
  }
  return values;
}

/** Return numbers as written by add_values: (n, k) row after row, k columns. */
function scaleToRange(coded, { n, lo, hi, whole }) {
  const k = lo.length, found = new Float32Array(n * k);
  for (let column = 0; column < k; column++) {
    const scale = (hi[column] - lo[column]) / LEVELS;
    for (let i = 0; i < n; i++) {
      const level = coded[column * n + i];
      const value = lo[column] + level * scale;
      found[i * k + column] = level > LEVELS ? MISSING : whole[column] ? Math.round(value) : value;
    }
  }
  return found;
}

/** Return what the server of a served page answers. */
export async function ask(address, options) {
  const response = await fetch(address, options), answer = await response.json();
  if (!response.ok) throw new Error(answer.error ?? response.statusText);
  return answer;
}

/** Return the array that a header's entry stands for: Float32Array, or Uint32Array of indices. */
export async function unpack(packed) {
  if (packed.address) return unpack(await ask(packed.address));
  const bytes = await readBlock(packed.block);
  if (packed.as === "range") return scaleToRange(sumDifferences(joinBytes(bytes, 2)), packed);
  const whole = joinBytes(bytes, 4);
  return packed.as === "index" ? sumDifferences(whole) : new Float32Array(whole.buffer);
}
