// Questions to the server: of each kind the newest counts, and answers come line by line.
/** A request was refused, or the server did not answer. */
export class Refused extends Error {
    refusal;
    constructor(refusal) {
        super(refusal.message);
        this.refusal = refusal;
    }
}
/** The server that the page is from. */
export class Server {
    token = location.pathname.split("/")[1] ?? "";
    /** The name of this page among others of the same server. */
    session = Array.from(crypto.getRandomValues(new Uint8Array(8)), (byte) => byte.toString(16).padStart(2, "0")).join("");
    running = new Map();
    sequence = 0;
    /** Fetches what the page begins with. */
    async start() {
        return (await (await fetch("start.json")).json());
    }
    /** Calls off a question, on the server too. */
    cancel(kind) {
        this.running.get(kind)?.abort();
        this.running.delete(kind);
    }
    /** Asks a question. `listen` is called with every line as it comes. False if a newer question took its place. */
    async ask(kind, path, question, listen) {
        const controller = this.begin(kind);
        try {
            const response = await this.post(path, question, controller.signal);
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
            if (this.running.get(kind) === controller)
                this.running.delete(kind);
        }
    }
    /** Asks for a file; null if another was asked for meanwhile. */
    async file(question) {
        const controller = this.begin("export");
        try {
            const response = await this.post("export", question, controller.signal);
            return response === null ? null : await response.blob();
        }
        catch (error) {
            if (controller.signal.aborted)
                return null;
            throw error;
        }
    }
    begin(kind) {
        this.cancel(kind);
        const controller = new AbortController();
        this.running.set(kind, controller);
        return controller;
    }
    /** The answer; null if a newer question took its place. */
    async post(path, question, signal) {
        this.sequence += 1;
        const ticket = { session: this.session, sequence: this.sequence };
        let response;
        try {
            response = await fetch(`/api/${path}`, {
                method: "POST",
                headers: { "content-type": "application/json", "x-fakir-token": this.token },
                body: JSON.stringify({ ticket, ...question }),
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
}
