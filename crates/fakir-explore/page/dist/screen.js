// Draws the state: every view once a frame, if what it shows has changed.
export class Screen {
    store;
    shown;
    #views = [];
    #waiting = false;
    constructor(store, 
    /** Called after everything has been drawn. */
    shown) {
        this.store = store;
        this.shown = shown;
        store.listen(() => this.#wait());
    }
    /** Draws whenever one of `parts` is another one, or one of the elements has another size. */
    add(parts, draw, elements = []) {
        const view = { parts, draw, drawn: null };
        this.#views.push(view);
        const sizes = new ResizeObserver(() => {
            if (view.drawn !== null)
                draw(this.store.state);
        });
        for (const element of elements)
            sizes.observe(element);
        this.#wait();
    }
    /** Draws everything anew, as in other colours. */
    redraw() {
        for (const view of this.#views)
            view.drawn = null;
        this.#wait();
    }
    #wait() {
        if (this.#waiting)
            return;
        this.#waiting = true;
        requestAnimationFrame(() => this.#draw());
    }
    #draw() {
        this.#waiting = false;
        const state = this.store.state;
        for (const view of this.#views) {
            const parts = view.parts(state);
            if (view.drawn?.every((part, k) => part === parts[k]))
                continue;
            view.drawn = parts;
            view.draw(state);
        }
        this.shown(state);
    }
}
export function byId(id) {
    const found = document.getElementById(id);
    if (found === null)
        throw new Error(`no element ${id}`);
    return found;
}
/** Makes something grey that is of an older case or load, or not any more. */
export function age(element, older) {
    element.classList.toggle("older", older);
    element.setAttribute("aria-busy", String(older));
}
