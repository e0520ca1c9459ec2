// The sketch of the quantities: it highlights the one whose control has the focus, and explains it.

import { byId } from "./screen.js";

/** @import { Key } from "./engine.js" */

/**
 * Explains the quantity whose control gets the focus or is under the pointer.
 * @param {readonly Key[]} keys
 */
export function explainFocus(keys) {
  const meanings = new Map(keys.map(({ key, label, meaning }) => [idOf(key), `${label}: ${meaning}`]));
  meanings.set("load", "load: indentation ζ of the lens as a fraction of the way from first contact to the critical state");
  const help = byId("help");
  const parts = [...byId("sketch", SVGSVGElement).querySelectorAll("[data-keys]")];
  /** @param {Event} event */
  const explain = ({ target }) => {
    if (!(target instanceof HTMLElement)) return;
    const field = target.closest(".field")?.querySelector("input, select") ?? target;
    const meaning = meanings.get(field.id);
    if (meaning === undefined) return;
    help.textContent = meaning;
    for (const part of parts) {
      const ids = part.getAttribute("data-keys")?.split(" ") ?? [];
      part.classList.toggle("lit", ids.includes(field.id));
    }
  };
  for (const element of [byId("fields"), byId("load")]) element.addEventListener("focusin", explain);
  byId("fields").addEventListener("pointerover", (event) => {
    if (!byId("fields").contains(document.activeElement)) explain(event);
  });
}

/**
 * The ID of the control of a key.
 * @param {string} key
 * @returns {string}
 */
function idOf(key) {
  return key.replaceAll(".", "-");
}
