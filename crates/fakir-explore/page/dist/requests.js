// The one place that asks the server: it follows the store, and puts the answers into it.
import { Refused } from "./engine.js";
import { isBusy, isWithoutFloor, knownCritical, sticks } from "./store.js";
/** A computation that takes longer than this, ms, is given up for a newer one; shorter ones are
 * shown, so that the picture moves while a slider does. */
const GRACE = [120, 700];
/** Questions of the background are asked when nothing has changed for this long, ms. */
const CALM = 200;
/** If nothing of the new case or load is shown this long, ms, after a change, all that is older turns grey. With the first
 * new part it turns grey at once, so that parts of two cases never look alike. */
const OVERDUE = 200;
/** The time that a cycle takes is shown anew after this long, ms. */
const TICK = 200;
/** The pillar tops alone are shown if the floor is not solved for this long, ms, after them. */
const WITHOUT_FLOOR = 60;
const BACKGROUND = ["phase", "curves"];
/** Sends what the state asks for, from now on. */
export function answerQuestions(store, server) {
    let newest = 0;
    let calm;
    function follow() {
        const { question } = store.state;
        if (question.number > newest) {
            newest = question.number;
            begin(question);
        }
        callOffSketched();
        const { asking, calledOff, sent } = store.state;
        if (calledOff !== null && asking.contact?.question.number === calledOff.number)
            server.cancel("contact");
        if (asking.contact === null && sent < question.number)
            void contact(question);
    }
    /** There is a new question. */
    function begin(question) {
        window.clearTimeout(calm);
        window.setTimeout(() => store.overdue(question), OVERDUE);
        const { asking, lastTime } = store.state;
        for (const kind of BACKGROUND) {
            if (asking[kind] !== null && asking[kind].question.name !== question.name)
                server.cancel(kind);
        }
        if (asking.contact === null)
            return;
        const { question: before, since } = asking.contact;
        const grace = Math.min(GRACE[1], Math.max(GRACE[0], 2 * lastTime));
        window.setTimeout(() => callOffLate(before), Math.max(0, grace - (performance.now() - since)));
    }
    /** Calls off a question that has an estimated picture, or the first state of a cycle, if there is a newer question. */
    function callOffSketched() {
        const { asking, picture, question } = store.state;
        const under = asking.contact?.question;
        if (under === undefined || under.number >= question.number)
            return;
        const goesOn = picture?.is.stage !== "exact" || sticks(under.case);
        if (picture?.of.number === under.number && goesOn) {
            server.cancel("contact");
        }
    }
    /** Calls off a question of which there is no picture yet. */
    function callOffLate(question) {
        const { asking, picture } = store.state;
        if (asking.contact?.question.number !== question.number)
            return;
        if (picture?.of.number === question.number && picture.is.stage === "exact")
            return;
        server.cancel("contact");
    }
    async function contact(question) {
        const known = knownCritical(store.state, question);
        // A cycle can take minutes: its time goes on where nothing else comes.
        const clock = sticks(question.case) ? window.setInterval(() => store.tick(performance.now()), TICK) : undefined;
        await ask("contact", sticks(question.case) ? "cycle" : "contact", question, {
            case: question.case,
            load: {
                fraction: question.load,
                ...(known && { critical_indentation_m: known.critical_indentation_m }),
            },
        });
        window.clearInterval(clock);
        if (!isBusy(store.state))
            calm = window.setTimeout(background, CALM);
    }
    /** Curves and phase diagram, once nothing else is asked. */
    function background() {
        const { question, asking, answered } = store.state;
        const critical = knownCritical(store.state, question);
        if (critical === null)
            return;
        const { critical_indentation_m } = critical;
        const questions = {
            phase: { case: question.case, load: { fraction: 1, critical_indentation_m } },
            curves: { case: question.case },
        };
        // With adhesion the phase diagram shows the loading of the cycle.
        for (const kind of BACKGROUND.filter((kind) => kind === "curves" || !sticks(question.case))) {
            const names = [asking[kind]?.question.name, answered[kind]?.of.name];
            if (!names.includes(question.name))
                void ask(kind, kind, question, questions[kind]);
        }
    }
    async function ask(kind, path, question, body) {
        store.send(kind, question, performance.now());
        let whole = false;
        let refusal = null;
        try {
            whole = await server.ask(kind, path, body, (line) => {
                const take = () => store.receive(kind, question.number, line, performance.now());
                if (line.state && isWithoutFloor(line.state))
                    window.setTimeout(take, WITHOUT_FLOOR);
                else
                    take();
            });
        }
        catch (error) {
            refusal =
                error instanceof Refused
                    ? error.refusal
                    : { key: null, message: String(error), accepted: null };
        }
        store.end(kind, question.number, whole, refusal);
    }
    store.listen(follow);
    follow();
}
