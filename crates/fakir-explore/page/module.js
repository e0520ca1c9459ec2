// The answering code as a module of WebAssembly, in Web Workers: the page needs no server.
//
// A module computes on one thread and cannot be interrupted. To cancel a computation its worker is ended; a spare one, with the
// module already started, takes its place.

import { Refused } from "./engine.js";

/** @import { ApiPath, Asked, Engine, Line, Start } from "./engine.js" */

/**
 * A question that waits or is being answered.
 * @typedef {object} Job
 * @property {Asked} kind
 * @property {string} request Name of the request, a line feed, and its JSON.
 * @property {(line: Line) => void} listen
 * @property {(answer: Blob | boolean | null) => void} resolve
 * @property {(error: unknown) => void} reject
 * @property {Blob | null} file
 */

/**
 * One worker and the questions for it.
 * @typedef {object} Place
 * @property {Worker | null} worker
 * @property {Job | null} running
 * @property {Job[]} waiting
 */

/**
 * A message of the worker.
 * @typedef {object} Message
 * @property {string} [line]
 * @property {Uint8Array<ArrayBuffer>} [file]
 * @property {string} [type] Media type of the file.
 * @property {true} [end]
 * @property {string} [failed]
 */

/**
 * An answer that the document contains.
 * @typedef {object} Known
 * @property {string} path
 * @property {object} question
 * @property {readonly Line[]} lines
 */

/** A module with one vector instruction. */
const VECTORS = new Uint8Array([
  0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11,
]);

const WITHOUT = "a browser of 2023 or later, or `fakir explore`, which computes outside of the browser";

/**
 * The module, in workers of its own.
 * @implements {Engine}
 */
export class Module {
  /** @type {Promise<WebAssembly.Module> | null} */
  #compiled = null;
  /** @type {Promise<Worker> | null} */
  #spare = null;
  #source = URL.createObjectURL(new Blob([contents("worker-source")], { type: "text/javascript" }));
  /** @type {Record<"contact" | "background" | "export" | "fit" | "hold" | "surface", Place>} */
  #places = { contact: place(), background: place(), export: place(), fit: place(), hold: place(), surface: place() };
  /** @type {Map<string, readonly Line[]>} */
  #known = new Map();
  #sequence = 0;

  constructor() {
    // The module is loaded after the first picture, unless it is needed for it.
    document.addEventListener("picture", () => void this.#warmUp(), { once: true });
  }

  /**
   * Reads the initial data from the document.
   * @returns {Promise<Start>}
   */
  start() {
    const { start, first } = /** @type {{ start: Start, first: readonly Known[] }} */ (JSON.parse(contents("first")));
    for (const { path, question, lines } of first) this.#known.set(nameOf(path, question), lines);
    return Promise.resolve(start);
  }

  /**
   * Cancels a question.
   * @param {Asked} kind
   */
  cancel(kind) {
    const place = this.#placeOf(kind);
    const waiting = place.waiting.filter((job) => job.kind === kind);
    place.waiting = place.waiting.filter((job) => job.kind !== kind);
    for (const job of waiting) job.resolve(null);
    if (place.running?.kind !== kind) return;
    const { running } = place;
    this.#end(place);
    running.resolve(null);
    this.#next(place);
  }

  /**
   * Answers a question, and calls `listen` with each line of the answer. Returns false if a newer question replaced it.
   * @param {Asked} kind
   * @param {ApiPath} path
   * @param {object} question
   * @param {(line: Line) => void} listen
   * @returns {Promise<boolean>}
   */
  async ask(kind, path, question, listen) {
    this.cancel(kind);
    const known = this.#known.get(nameOf(path, question));
    if (known !== undefined) {
      await Promise.resolve();
      for (const line of known) listen(line);
      return true;
    }
    return (await this.#answer(kind, path, question, listen)) === true;
  }

  /**
   * Computes a file; null if another was requested in the meantime.
   * @param {object} question
   * @returns {Promise<Blob | null>}
   */
  async file(question) {
    this.cancel("export");
    const file = await this.#answer("export", "export", question, () => {});
    return file instanceof Blob ? file : null;
  }

  /**
   * @param {Asked} kind
   * @returns {Place}
   */
  #placeOf(kind) {
    if (kind === "curves" || kind === "phase") return this.#places.background;
    return this.#places[kind === "read" ? "fit" : kind];
  }

  /**
   * @param {Asked} kind
   * @param {ApiPath} path
   * @param {object} question
   * @param {(line: Line) => void} listen
   * @returns {Promise<Blob | boolean | null>}
   */
  #answer(kind, path, question, listen) {
    this.#sequence += 1;
    const ticket = { session: "page", sequence: this.#sequence };
    const request = `${path}\n${JSON.stringify({ ticket, ...question })}`;
    const place = this.#placeOf(kind);
    return new Promise((resolve, reject) => {
      place.waiting.push({ kind, request, listen, resolve, reject, file: null });
      this.#next(place);
    });
  }

  /**
   * Starts the next question of a place, unless one is being answered.
   * @param {Place} place
   */
  #next(place) {
    const job = place.running === null ? place.waiting.shift() : undefined;
    if (job === undefined) return;
    place.running = job;
    if (place.worker !== null) {
      place.worker.postMessage(job.request);
      return;
    }
    this.#take().then(
      (worker) => {
        // The question was cancelled while the module was loaded.
        if (place.running !== job) {
          worker.terminate();
          return;
        }
        place.worker = worker;
        worker.onmessage = ({ data }) => this.#receive(place, /** @type {Message} */ (data));
        worker.onerror = (event) => this.#receive(place, { failed: event.message });
        worker.postMessage(job.request);
      },
      (error) => {
        if (place.running !== job) return;
        place.running = null;
        job.reject(error);
        this.#next(place);
      },
    );
  }

  /**
   * @param {Place} place
   * @param {Message} message
   */
  #receive(place, { line, file, type, end, failed }) {
    const job = place.running;
    if (job === null) return;
    if (line !== undefined) {
      const parsed = /** @type {Line} */ (JSON.parse(line));
      if (parsed.refused) job.reject(new Refused(parsed.refused));
      else job.listen(parsed);
    }
    if (file !== undefined) job.file = new Blob([file], { type: type ?? "" });
    if (end) {
      place.running = null;
      job.resolve(job.kind === "export" ? job.file : true);
      this.#next(place);
    }
    if (failed !== undefined) {
      this.#end(place);
      job.reject(
        new Refused({
          key: null,
          message: `the computation broke off (${failed}): the memory of the browser was not sufficient, or this is a mistake in fakir; it was started again`,
          accepted: "fewer pillars, or `fakir explore`, which computes outside of the browser",
        }),
      );
      this.#next(place);
    }
  }

  /**
   * Ends the worker of a place.
   * @param {Place} place
   */
  #end(place) {
    place.worker?.terminate();
    place.worker = null;
    place.running = null;
  }

  /** Loads the module and starts the spare worker. Problems are reported with the first question. */
  async #warmUp() {
    try {
      await (this.#spare ??= this.#started());
    } catch {
      this.#spare = null;
    }
  }

  /**
   * The spare worker; another one is started.
   * @returns {Promise<Worker>}
   */
  async #take() {
    const spare = this.#spare ?? this.#started();
    this.#spare = null;
    const worker = await spare;
    window.setTimeout(() => void this.#warmUp());
    return worker;
  }

  /**
   * Starts a worker with the module.
   * @returns {Promise<Worker>}
   */
  async #started() {
    if (typeof WebAssembly !== "object") throw refused("this browser has no WebAssembly", WITHOUT);
    if (!WebAssembly.validate(VECTORS)) throw refused("WebAssembly of this browser has no vector instructions", WITHOUT);
    this.#compiled ??= compiled();
    const module = await this.#compiled.catch((error) => {
      this.#compiled = null;
      throw refused(`the module could not be loaded (${String(error)})`, "load the page again");
    });
    const worker = new Worker(this.#source);
    await new Promise((resolve, reject) => {
      worker.onmessage = resolve;
      worker.onerror = (event) => reject(refused(`the module could not be started (${event.message})`, WITHOUT));
      worker.postMessage(module);
    });
    return worker;
  }
}

/** @returns {Place} */
function place() {
  return { worker: null, running: null, waiting: [] };
}

/**
 * @param {string} message
 * @param {string} accepted
 * @returns {Refused}
 */
function refused(message, accepted) {
  return new Refused({ key: null, message, accepted });
}

/**
 * Two questions are equal if their names are.
 * @param {string} path
 * @param {object} question
 * @returns {string}
 */
function nameOf(path, question) {
  return `${path} ${JSON.stringify(question, (_, value) => (isPlain(value) ? sorted(value) : value))}`;
}

/**
 * @param {unknown} value
 * @returns {value is Record<string, unknown>}
 */
function isPlain(value) {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

/**
 * @param {Record<string, unknown>} value
 * @returns {Record<string, unknown>}
 */
function sorted(value) {
  return Object.fromEntries(Object.entries(value).sort(([a], [b]) => (a < b ? -1 : 1)));
}

/**
 * Text of a part of the document.
 * @param {string} id
 * @returns {string}
 */
function contents(id) {
  return document.getElementById(id)?.textContent ?? "";
}

/**
 * Compiles the module: the file beside the document, or the part of the document that contains it.
 * @returns {Promise<WebAssembly.Module>}
 */
async function compiled() {
  // The part with the module follows the scripts.
  if (document.readyState === "loading") {
    await new Promise((resolve) => document.addEventListener("DOMContentLoaded", resolve, { once: true }));
  }
  const inside = contents("module");
  if (inside === "") return WebAssembly.compile(await (await fetch("fakir.wasm")).arrayBuffer());
  const packed = Uint8Array.from(atob(inside), (letter) => letter.charCodeAt(0));
  const bytes = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compile(await new Response(bytes).arrayBuffer());
}
