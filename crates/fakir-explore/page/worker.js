// Runs in a Web Worker: the first message is the compiled module, every other one a request. The interface of the module is described in
// the crate `fakir-page`.

/**
 * What the module exports.
 * @typedef {object} Exports
 * @property {WebAssembly.Memory} memory
 * @property {(length: number) => number} request
 * @property {() => void} answer
 */

/** Kinds of the parts of an answer. */
const [LINE, TYPE, FILE] = [0, 1, 2];

/** @type {Exports | null} */
let instance = null;
let type = "";

/**
 * A copy of bytes in the memory of the module.
 * @param {number} start
 * @param {number} length
 * @returns {Uint8Array<ArrayBuffer>}
 */
function bytesAt(start, length) {
  return new Uint8Array(/** @type {Exports} */ (instance).memory.buffer).slice(start, start + length);
}

/**
 * Takes a part of an answer.
 * @param {number} start
 * @param {number} length
 * @param {number} kind
 */
function receive(start, length, kind) {
  const bytes = bytesAt(start >>> 0, length >>> 0);
  if (kind === FILE) postMessage({ file: bytes, type });
  else if (kind === TYPE) type = new TextDecoder().decode(bytes);
  else if (kind === LINE) postMessage({ line: new TextDecoder().decode(bytes) });
}

onmessage = ({ data }) => {
  if (instance === null) {
    const page = { receive, now: () => performance.now() / 1e3 };
    instance = /** @type {Exports} */ (/** @type {unknown} */ (new WebAssembly.Instance(data, { page }).exports));
    postMessage({});
    return;
  }
  try {
    const request = new TextEncoder().encode(data);
    const start = instance.request(request.length) >>> 0;
    new Uint8Array(instance.memory.buffer).set(request, start);
    instance.answer();
    postMessage({ end: true });
  } catch (error) {
    postMessage({ failed: String(error) });
  }
};
