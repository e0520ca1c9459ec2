// The server of this page, `fakir explore`.

import { Refused } from "./engine.js";

/** @import { ApiPath, Asked, Engine, Line, Refusal, Start } from "./engine.js" */

/**
 * The server of this page.
 * @implements {Engine}
 */
export class Server {
  #token = location.pathname.split("/")[1] ?? "";
  /** Identifies this page among other pages of the same server. */
  #session = Array.from(crypto.getRandomValues(new Uint8Array(8)), (byte) =>
    byte.toString(16).padStart(2, "0"),
  ).join("");
  /** @type {Map<Asked, AbortController>} */
  #running = new Map();
  #sequence = 0;

  /**
   * Fetches the initial data of the page.
   * @returns {Promise<Start>}
   */
  async start() {
    return /** @type {Start} */ (await (await fetch("start.json")).json());
  }

  /**
   * Cancels a question, also on the server.
   * @param {Asked} kind
   */
  cancel(kind) {
    this.#running.get(kind)?.abort();
    this.#running.delete(kind);
  }

  /**
   * Sends a question, and calls `listen` with each line of the answer. Returns false if a newer question replaced it.
   * @param {Asked} kind
   * @param {ApiPath} path
   * @param {object} question
   * @param {(line: Line) => void} listen
   * @returns {Promise<boolean>}
   */
  async ask(kind, path, question, listen) {
    const controller = this.#begin(kind);
    try {
      const response = await this.#post(path, question, controller.signal);
      if (response === null || response.body === null) return false;
      const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
      let rest = "";
      for (;;) {
        const { value, done } = await reader.read();
        if (done) break;
        const lines = (rest + value).split("\n");
        rest = lines.pop() ?? "";
        for (const text of lines) {
          const line = /** @type {Line} */ (JSON.parse(text));
          if (line.refused) throw new Refused(line.refused);
          listen(line);
        }
      }
      return true;
    } catch (error) {
      if (controller.signal.aborted) return false;
      throw error;
    } finally {
      if (this.#running.get(kind) === controller) this.#running.delete(kind);
    }
  }

  /**
   * Requests a file; null if another was requested in the meantime.
   * @param {object} question
   * @returns {Promise<Blob | null>}
   */
  async file(question) {
    const controller = this.#begin("export");
    try {
      const response = await this.#post("export", question, controller.signal);
      return response === null ? null : await response.blob();
    } catch (error) {
      if (controller.signal.aborted) return null;
      throw error;
    }
  }

  /**
   * @param {Asked} kind
   * @returns {AbortController}
   */
  #begin(kind) {
    this.cancel(kind);
    const controller = new AbortController();
    this.#running.set(kind, controller);
    return controller;
  }

  /**
   * Sends a request; null if a newer question replaced it.
   * @param {ApiPath} path
   * @param {object} question
   * @param {AbortSignal} signal
   * @returns {Promise<Response | null>}
   */
  async #post(path, question, signal) {
    this.#sequence += 1;
    const ticket = { session: this.#session, sequence: this.#sequence };
    /** @type {Response} */
    let response;
    try {
      response = await fetch(`/api/${path}`, {
        method: "POST",
        headers: { "content-type": "application/json", "x-fakir-token": this.#token },
        body: JSON.stringify({ ticket, ...question }),
        signal,
      });
    } catch (error) {
      if (signal.aborted) throw error;
      throw new Refused({
        key: null,
        message: "no answer from fakir",
        accepted: "start `fakir explore` again; it prints a new address",
      });
    }
    if (response.ok) return response;
    if (response.status === 409) return null;
    throw new Refused(/** @type {Refusal} */ (await response.json()));
  }
}
