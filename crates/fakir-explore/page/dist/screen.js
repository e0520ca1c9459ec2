// Draws the state: every view of which something has changed, all together.
import { isOlder } from "./store.js";
export class Screen {
    store;
    framed;
    #views = [];
    #frameAwaited = false;
    /** Functions to be called once the screen shows what was drawn. */
    #afterwards = [];
    constructor(store, 
    /** Called in every frame in which something is drawn. */
    framed) {
        this.store = store;
        this.framed = framed;
        store.listen(() => this.#changed());
    }
    /** Calls `draw` whenever one of `parts` has changed, or one of the elements has another size. */
    add(parts, draw, elements = []) {
        const view = { parts, draw, drawn: null };
        this.#views.push(view);
        const sizes = new ResizeObserver(() => {
            if (view.drawn !== null)
                draw(this.store.state);
        });
        for (const element of elements)
            sizes.observe(element);
        this.#changed();
    }
    /** Makes elements grey while what they show is of an older case, or of an older load. */
    age(shown, dependsOn, elements) {
        const older = (state) => isOlder(state, shown(state), dependsOn);
        this.add((state) => [older(state)], (state) => {
            for (const element of elements) {
                element.classList.toggle("older", older(state));
                element.setAttribute("aria-busy", String(older(state)));
            }
        });
    }
    /** Draws everything anew, for example in other colours. */
    redraw() {
        for (const view of this.#views)
            view.drawn = null;
        this.#changed();
    }
    /** Calls `act` after the next frame, when the screen shows what was drawn. */
    whenShown(act) {
        this.#afterwards.push(act);
    }
    /** Draws a change at once. Further changes before the next frame are drawn in that frame. */
    #changed() {
        if (this.#frameAwaited)
            return;
        this.#frameAwaited = true;
        queueMicrotask(() => this.#draw());
        requestAnimationFrame(() => this.#frame());
    }
    #frame() {
        this.#frameAwaited = false;
        this.#draw();
        this.framed(this.store.state);
        const afterwards = this.#afterwards;
        if (afterwards.length === 0)
            return;
        this.#afterwards = [];
        const channel = new MessageChannel();
        channel.port1.onmessage = () => afterwards.forEach((act) => act());
        channel.port2.postMessage(null);
    }
    #draw() {
        const state = this.store.state;
        for (const view of this.#views) {
            const parts = view.parts(state);
            if (view.drawn?.every((part, k) => part === parts[k]))
                continue;
            view.drawn = parts;
            view.draw(state);
        }
    }
}
export function byId(id) {
    const found = document.getElementById(id);
    if (found === null)
        throw new Error(`no element ${id}`);
    return found;
}
