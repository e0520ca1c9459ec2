// Actions of buttons that do not change the case: saving files and copying texts.

import { byId } from "./screen.js";
import { fileShown } from "./shown.js";
import { isRelaxing, knownCritical, tableOf } from "./store.js";

/**
 * @import { Engine, Texts } from "./engine.js"
 * @import { Notice, State, Store } from "./store.js"
 */

/** Time for which the message "copied" is shown, ms. */
const NOTICE = 1200;

/**
 * Saves a file of the chosen case, or shows why there is none.
 * @param {Store} store
 * @param {Engine} engine
 * @param {string} name
 */
export async function save(store, engine, name) {
  store.notify("export", `${name} …`);
  const { question } = store.state;
  const known = knownCritical(store.state, question);
  const load = {
    fraction: store.state.chosen.load,
    ...(known && { critical_indentation_m: known.critical_indentation_m }),
  };
  try {
    const { hold } = store.state.chosen;
    const held = hold !== null && isRelaxing(question.case) ? { hold } : {};
    const file = await engine.file({ case: question.case, load, ...held, file: name, ...tableOf(store.state, question.case) });
    if (file !== null) download(store, file, name);
  } catch (error) {
    store.notify("export", error instanceof Error ? error.message : String(error));
  }
}

/**
 * Saves a picture or the values of a chart as they are shown.
 * @param {Store} store
 * @param {string} name
 */
export async function saveShown(store, name) {
  try {
    const file = await fileShown(name);
    if (file === null) store.notify("export", "nothing is shown there yet");
    else download(store, file, name);
  } catch (error) {
    store.notify("export", error instanceof Error ? error.message : String(error));
  }
}

/**
 * @param {Store} store
 * @param {Blob} file
 * @param {string} name
 */
function download(store, file, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(file);
  link.download = `fakir-${name}`;
  link.click();
  window.setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  store.notify("export", `${name} saved`);
}

/**
 * Copies a text, and shows a message for a moment.
 * @param {Store} store
 * @param {Notice} about
 * @param {string} text
 */
export async function copy(store, about, text) {
  let words = "copied";
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    words = "not allowed";
  }
  store.notify(about, words);
  store.announce(words);
  window.setTimeout(() => store.notify(about, null), NOTICE);
}

/**
 * Shows the messages beside buttons, or on them.
 * @param {State} state
 */
export function drawNotices({ notices }) {
  byId("export-note").textContent = notices.export ?? "";
  byId("copy-link").textContent = notices.link ?? "copy link";
  for (const button of /** @type {NodeListOf<HTMLButtonElement>} */ (document.querySelectorAll("[data-copy]"))) {
    button.textContent = notices[/** @type {keyof Texts} */ (button.dataset["copy"])] ?? "copy";
  }
}
