function gather(places, typed, _, meta, before) {
    // Texts of all values from the places of the sliders. A typed text stays until its slider is moved, and so does an
    // invalid one: it stays in its field while the calculation uses the last valid value. While an answer is pending no
    // other is requested; the next request takes the latest sliders, so that the page moves on. What else is done with the
    // design, such as another material or its case file, takes the sliders as they are.
    const none = window.dash_clientside.no_update;
    const design = {}, wrong = {};
    meta.keys.forEach((key, n) => {
        const own = (typed || {})[key], stands = own && own.at === places[n];
        design[key] = stands ? own.text : meta.stops[key][places[n]];
        if (stands && own.wrong !== undefined) { wrong[key] = own.wrong; }
    });
    if (meta.case) { design.case = meta.case; }
    // a field that is being typed in is not changed
    meta.keys.forEach(key => {
        const text = key in wrong ? wrong[key] : design[key];
        const field = document.getElementById(JSON.stringify({key: key, kind: "text"}));
        if (field && field !== document.activeElement && field.value !== text) {
            window.dash_clientside.set_props({kind: "text", key: key}, {value: text});
        }
    });
    const same = (one, other) => JSON.stringify(one) === JSON.stringify(other);
    // a design of the history is asked for when the sliders have arrived at it
    const step = window.step;
    if (step && !same(step.design, design) && Date.now() - step.since < 5000) { return [none, none]; }
    window.step = undefined;
    window.present = design;
    const page = (before && before.page) || String(Math.random());
    const number = ((before && before.number) || 0) + 1;
    const present = {page: page, number: number, design: design, wrong: wrong};
    if (before && same([before.design, before.wrong], [design, wrong])) { return [none, present]; }
    const way = window.onItsWay;
    if (way && way.answered < way.number && Date.now() - way.since < 5000) { return [none, present]; }
    window.onItsWay = {number: number, since: Date.now(), answered: (way && way.answered) || 0};
    return [present, present];
}

function enter(_a, _b, entered, typed, places, meta) {
    // Typed texts whose sliders have not moved since. Each request contains all of them and only the newest answer is
    // used, since answers may overtake each other; the text comes from the field itself, since dash knows it later.
    const kept = {}, stands = {};
    let changed = false;
    meta.keys.forEach((key, n) => {
        const own = (typed || {})[key], one = ((entered || {}).fields || {})[key];
        stands[key] = own && own.at === places[n] ? own : {at: places[n], text: meta.stops[key][places[n]]};
        if (one && (one.at === places[n] || (own && own.at === places[n]))) { kept[key] = one; }
    });
    window.dash_clientside.callback_context.triggered.forEach(one => {
        const id = one.prop_id.slice(0, one.prop_id.lastIndexOf(".")), field = document.getElementById(id);
        if (!field || !one.value) { return; }
        const key = JSON.parse(id).key, text = field.value.trim(), now = stands[key];
        if (text === (kept[key] || {text: now.wrong === undefined ? now.text : now.wrong}).text) { return; }
        kept[key] = {at: now.at, text: text, before: now.text};
        changed = true;
    });
    return changed ? {number: Date.now(), fields: kept} : window.dash_clientside.no_update;
}

function judged(judged, entered, places, meta) {
    const none = window.dash_clientside.no_update;
    if (!judged || !entered || judged.number !== entered.number) { return [none, places.map(() => none)]; }
    return [judged.typed, meta.keys.map((key, n) => judged.typed[key] ? judged.typed[key].at : places[n])];
}

function remember(asked, history) {
    // Designs in their order, for undo and redo; moves of one slider in quick succession are one step.
    const none = window.dash_clientside.no_update;
    if (!asked) { return none; }
    const design = asked.design, kept = history.designs.slice(0, history.at + 1), last = kept[kept.length - 1];
    if (last && JSON.stringify(last) === JSON.stringify(design)) { return none; }
    const moved = last ? Object.keys(design).filter(key => last[key] !== design[key]).join() : "first";
    const same = moved === history.moved && Date.now() - history.since < 1500;
    const designs = [...(same ? kept.slice(0, -1) : kept), design].slice(-200);
    return {designs: designs, at: designs.length - 1, moved: moved, since: Date.now()};
}

function steps(history, _) {
    // a design that waits to be asked for can be undone, too
    const now = window.step ? undefined : window.present, last = history.designs[history.at];
    const waits = now && last && JSON.stringify(now) !== JSON.stringify(last);
    const off = [history.at < 1 && !waits, history.at >= history.designs.length - 1];
    // a button that is switched off under the focus hands it on
    ["undo", "redo"].forEach((name, n) => {
        const button = document.getElementById(name);
        if (!off[n] || button !== document.activeElement) { return; }
        const next = document.getElementById(off[1 - n] ? "take-away" : ["redo", "undo"][n]);
        // it may be switched on with this very step
        next.disabled = false;
        next.focus();
    });
    return off;
}

function step(undo, redo, history) {
    // Each click counts at once, the next one before its controls are there; so does a design that waits to be asked for.
    // Dash makes one question of two clicks in quick succession.
    const none = window.dash_clientside.no_update, seen = window.clicks || [0, 0];
    window.clicks = [undo || 0, redo || 0];
    const way = window.clicks[1] - seen[1] - (window.clicks[0] - seen[0]);
    const known = history.designs.slice(0, history.at + 1), now = window.step ? undefined : window.present;
    const waits = now && JSON.stringify(now) !== JSON.stringify(known[known.length - 1]);
    const designs = waits ? [...known, now] : history.designs;
    const at = Math.max(0, Math.min(history.at + (waits ? 1 : 0) + way, designs.length - 1)), design = designs[at];
    if (!way || !design) { return [none, none]; }
    window.step = {design: design, since: Date.now()};
    return [{...history, designs: designs, at: at, moved: ""}, design];
}

function pinned(_take, _remove, pins) {
    // Controls of a pinned design, or the pinned designs without one; buttons that are made anew have no clicks.
    const none = window.dash_clientside.no_update;
    const pressed = window.dash_clientside.callback_context.triggered.find(one => one.value);
    if (!pressed) { return [none, none]; }
    const id = JSON.parse(pressed.prop_id.slice(0, pressed.prop_id.lastIndexOf(".")));
    return id.kind === "take" ? [pins[id.number], none] : [none, pins.filter((_, number) => number !== id.number)];
}

function answered(shown) {
    if (shown && window.onItsWay) {
        window.onItsWay.answered = Math.max(window.onItsWay.answered, shown.number);
        window.dash_clientside.set_props("poke", {data: Date.now()});
    }
}

function named(_) {
    // What screen readers call the handles of sliders, which dash leaves without a name; its hidden fields take no focus.
    // Controls that are made anew have the focus of those whose place they take.
    let last;
    const name = () => {
        if (last && !last.element.isConnected && document.activeElement === document.body) {
            const home = document.getElementById(last.home);
            const again = home && (last.place < 0 ? home : home.querySelectorAll("*")[last.place]);
            if (again) { again.focus(); }
        }
        document.querySelectorAll("[role=slider]:not([aria-label])").forEach(handle => {
            const row = handle.closest(".row");
            if (row) { handle.setAttribute("aria-label", row.querySelector("label").innerText); }
        });
        document.querySelectorAll("input[aria-hidden=true][tabindex='0']").forEach(one => { one.disabled = true; });
        // the tabulator goes to the lists themselves instead
        document.querySelectorAll("button.dash-dropdown[tabindex='-1']").forEach(one => { one.tabIndex = 0; });
    };
    if (!window.naming) {
        window.naming = new MutationObserver(name);
        window.naming.observe(document.body, {childList: true, subtree: true});
        document.addEventListener("focusin", event => {
            const home = event.target.closest("[id]");
            last = home && {element: event.target, home: home.id, place: [...home.querySelectorAll("*")].indexOf(event.target)};
        });
    }
    name();
}

function dark(_) {
    const query = window.matchMedia("(prefers-color-scheme: dark)");
    query.onchange = () => window.dash_clientside.set_props("dark", {data: query.matches});
    return query.matches;
}
