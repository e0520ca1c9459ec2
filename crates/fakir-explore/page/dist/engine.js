// Questions to the server: of each kind the newest counts, and answers come line by line.
const TOKEN = location.pathname.split("/")[1] ?? "";
/** The name of this page among others of the same server. */
const SESSION = Array.from(crypto.getRandomValues(new Uint8Array(8)), (byte) => byte.toString(16).padStart(2, "0")).join("");
/** What goes with the refusal of a request, or the reason why none came. */
export class Refused extends Error {
    refusal;
    constructor(refusal) {
        super(refusal.message);
        this.refusal = refusal;
    }
}
const running = new Map();
let sequence = 0;
/** Calls off a question, on the server too. */
export function cancel(kind) {
    running.get(kind)?.abort();
    running.delete(kind);
}
/** Asks; `listen` is told every line as it comes. False if a newer question took its place. */
export async function ask(kind, question, listen) {
    const controller = begin(kind);
    try {
        const response = await post(kind, question, controller.signal);
        if (response === null || response.body === null)
            return false;
        const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
        let rest = "";
        for (;;) {
            const { value, done } = await reader.read();
            if (done)
                break;
            const lines = (rest + value).split("\n");
            rest = lines.pop() ?? "";
            for (const text of lines) {
                const line = JSON.parse(text);
                if (line.refused)
                    throw new Refused(line.refused);
                listen(line);
            }
        }
        return true;
    }
    catch (error) {
        if (controller.signal.aborted)
            return false;
        throw error;
    }
    finally {
        if (running.get(kind) === controller)
            running.delete(kind);
    }
}
/** Asks for a file. */
export async function fetchFile(question) {
    const controller = begin("export");
    const response = await post("export", question, controller.signal);
    return response === null ? null : response.blob();
}
function begin(kind) {
    cancel(kind);
    const controller = new AbortController();
    running.set(kind, controller);
    return controller;
}
/** The answer; null if a newer question took its place. */
async function post(kind, question, signal) {
    sequence += 1;
    const body = JSON.stringify({ ticket: { session: SESSION, sequence }, ...question });
    let response;
    try {
        response = await fetch(`/api/${kind}`, {
            method: "POST",
            headers: { "content-type": "application/json", "x-fakir-token": TOKEN },
            body,
            signal,
        });
    }
    catch (error) {
        if (signal.aborted)
            throw error;
        throw new Refused({
            key: null,
            message: "fakir does not answer",
            accepted: "start `fakir explore` again; it prints a new address",
        });
    }
    if (response.ok)
        return response;
    if (response.status === 409)
        return null;
    throw new Refused((await response.json()));
}
/** What the page begins with. */
export async function start() {
    return (await (await fetch("start.json")).json());
}
