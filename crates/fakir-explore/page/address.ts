// The part of the address after the #, which holds what the user has chosen.

import type { Values } from "./engine.js";
import type { Chosen } from "./store.js";

export function fragment(chosen: Chosen): string {
  const parameters = new URLSearchParams();
  for (const [key, value] of Object.entries(chosen.case)) parameters.set(key, String(value));
  parameters.set("load", String(chosen.load));
  if (chosen.exaggeration !== null) parameters.set("exaggeration", String(chosen.exaggeration));
  return `#${parameters.toString()}`;
}

/** What an address says; null if there is no case in it. */
export function chosenIn(hash: string): Chosen | null {
  const parameters = new URLSearchParams(hash.slice(1));
  const values: Values = {};
  for (const [key, text] of parameters) {
    if (!key.includes(".")) continue;
    const number = Number(text);
    values[key] = text === "" || !Number.isFinite(number) ? text : number;
  }
  if (Object.keys(values).length === 0) return null;
  const factor = Number(parameters.get("exaggeration"));
  return {
    case: values,
    load: Number(parameters.get("load") ?? 1),
    exaggeration: factor > 0 ? factor : null,
  };
}
