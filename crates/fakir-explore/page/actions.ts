// What buttons do besides asking for another picture: saving files and copying texts.

import type { Server, Texts } from "./engine.js";
import { byId } from "./screen.js";
import { knownCritical, type Notice, type Store } from "./store.js";

/** How long the message stays that something was copied, ms. */
const NOTICE = 1200;

/** Saves a file of what is chosen, or says why there is none. */
export async function save(store: Store, server: Server, name: string): Promise<void> {
  store.tell("export", `${name} …`);
  const { question } = store.state;
  const known = knownCritical(store.state, question);
  const load = {
    fraction: store.state.chosen.load,
    ...(known && { critical_indentation_m: known.critical_indentation_m }),
  };
  try {
    const file = await server.file({ case: question.case, load, file: name });
    if (file === null) return;
    const link = document.createElement("a");
    link.href = URL.createObjectURL(file);
    link.download = `fakir-${name}`;
    link.click();
    window.setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
    store.tell("export", `${name} saved`);
  } catch (error) {
    store.tell("export", error instanceof Error ? error.message : String(error));
  }
}

/** Copies a text, and says so for a moment. */
export async function copy(store: Store, about: Notice, text: string): Promise<void> {
  let words = "copied";
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    words = "not allowed";
  }
  store.tell(about, words);
  store.announce(words);
  window.setTimeout(() => store.tell(about, null), NOTICE);
}

/** Writes the messages beside the buttons, or on them. */
export function drawNotices({ notices }: Store["state"]): void {
  byId("export-note").textContent = notices.export ?? "";
  byId("copy-link").textContent = notices.link ?? "copy link";
  for (const button of document.querySelectorAll<HTMLButtonElement>("[data-copy]")) {
    button.textContent = notices[button.dataset["copy"] as keyof Texts] ?? "copy";
  }
}
