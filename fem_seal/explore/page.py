"""The page: its layout, and what follows when something is moved."""

from __future__ import annotations

import json
import threading
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dash import ALL, Dash, Input, Output, State, ctx, dcc, html, no_update
from dash.exceptions import PreventUpdate

from fem_seal.errors import InputError, SealError
from fem_seal.explore.case_file import free_name, write_case
from fem_seal.explore.figures import HEIGHT, LIVE, PINS, figures
from fem_seal.explore.words import Number, changed, numbers_of, validity_words

if TYPE_CHECKING:
    from flask import Response

    from fem_seal.explore.factors import Factor
    from fem_seal.explore.screen import Screen
    from fem_seal.explore.worker import Answers

_MOST_PINS = len(PINS)
# Rest of the sliders after which the complete run begins [s], and how often the page asks for what is missing [ms].
_REST, _ASK_AGAIN = 0.4, 300
_GROUPS = {"load": "Load", "surface": "Surfaces and fluid", "dimension": "Geometry"}
_PICTURES = {
    "section": "Section",
    "leak": "Leak rate",
    "profile": "Contact pressure across the seat",
    "gap": "Gap across the seat",
}
_GRAPH = {"displaylogo": False, "responsive": True, "displayModeBar": False}
_TALL = {"height": f"{HEIGHT}px"}

# The texts of the moment from the places of the sliders; a typed text stands until its slider is moved.
# While an answer is on its way nothing else is asked; then for what the sliders say by then, so that the page moves on.
_GATHER = """
function(places, fluid, typed, _, meta, before) {
    const none = window.dash_clientside.no_update;
    const design = {};
    meta.keys.forEach((key, n) => {
        const own = (typed || {})[key];
        design[key] = own && own.at === places[n] ? own.text : meta.stops[key][places[n]];
    });
    if (fluid) { design.fluid = fluid; }
    const texts = meta.keys.map(key => design[key]);
    if (before && JSON.stringify(before.design) === JSON.stringify(design)) { return [none, texts]; }
    const way = window.onItsWay;
    if (way && way.answered < way.number && Date.now() - way.since < 5000) { return [none, texts]; }
    const page = (before && before.page) || String(Math.random());
    const number = ((before && before.number) || 0) + 1;
    window.onItsWay = {number: number, since: Date.now(), answered: (way && way.answered) || 0};
    return [{page: page, number: number, design: design}, texts];
}
"""
_ANSWERED = """
function(shown) {
    if (shown && window.onItsWay) {
        window.onItsWay.answered = Math.max(window.onItsWay.answered, shown.number);
        window.dash_clientside.set_props("poke", {data: Date.now()});
    }
}
"""
_DARK = """
function(_) {
    const query = window.matchMedia("(prefers-color-scheme: dark)");
    query.onchange = () => window.dash_clientside.set_props("dark", {data: query.matches});
    return query.matches;
}
"""
_INDEX = """<!DOCTYPE html>
<html lang="en"><head>{%metas%}<title>{%title%}</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">{%css%}<style>STYLE</style></head>
<body>{%app_entry%}<footer>{%config%}{%scripts%}{%renderer%}</footer></body></html>"""


def page_of(answers: Answers, folder: Path, title: str) -> Dash:
    """The page of a case.

    Parameters
    ----------
    answers : Answers
    folder : Path
        Where case files and reports are written.
    title : str
    """
    app = Dash(
        "fem_seal.explore",
        title=f"{title} - fem-seal",
        update_title="",
        serve_locally=True,
        suppress_callback_exceptions=True,
        assets_folder=str(folder / "no-assets-of-a-case"),
    )
    style = resources.files("fem_seal").joinpath("templates", "explore.css").read_text(encoding="utf-8")
    app.index_string = _INDEX.replace("STYLE", style)
    stem = answers.session.given.file.stem if answers.session.given.file else "case"
    app.layout = _layout(answers, title, f"{stem}-explored")
    _follow(app, answers)
    _type(app, answers)
    _pin(app, answers)
    _files(app, answers, folder)
    return app


def _layout(answers: Answers, title: str, name: str) -> html.Div:
    factors = answers.session.factors
    meta = {
        "keys": [one.key for one in factors.sliders],
        "stops": {one.key: one.stops for one in factors.sliders},
    }
    return html.Div(
        className="page",
        children=[
            dcc.Store(id="meta", data=meta),
            dcc.Store(id="typed", data={}),
            dcc.Store(id="asked"),
            dcc.Store(id="shown"),
            dcc.Store(id="poke"),
            dcc.Store(id="news"),
            dcc.Store(id="pins", data=[], storage_type="session"),
            dcc.Store(id="dark"),
            dcc.Interval(id="again", interval=_ASK_AGAIN, disabled=True),
            dcc.Interval(id="report-again", interval=500, disabled=True),
            dcc.Store(id="report-folder"),
            html.Header([html.H1(title), html.Span("", id="state", className="state", role="status")]),
            html.Div(
                className="columns",
                children=[
                    html.Div(_controls(answers), className="card controls"),
                    html.Div(_results(name), className="results"),
                ],
            ),
        ],
    )


def _controls(answers: Answers) -> list[Any]:
    factors, found = answers.session.factors, []
    for group, heading in _GROUPS.items():
        rows = [_row(one) for one in factors.sliders if one.group == group]
        if group == "surface":
            rows.append(_fluid(factors.fluids))
        if rows:
            found.append(html.Div([html.H2(heading), *rows], className="group"))
    remarks = [*factors.left_out, *([answers.session.not_live] if answers.session.not_live else [])]
    if remarks:
        found.append(html.Div([html.Div(one, className="note") for one in remarks], className="group"))
    return found


def _row(factor: Factor) -> html.Div:
    typed = dcc.Input(
        id={"kind": "text", "key": factor.key},
        type="text",
        value=factor.given,
        debounce=True,
        size="12",
        spellCheck="false",
        autoComplete="off",
    )
    slider = dcc.Slider(
        id={"kind": "slider", "key": factor.key},
        min=0,
        max=len(factor.stops) - 1,
        step=1,
        value=factor.place,
        marks=None,
        included=False,
        updatemode="drag",
        **_without_its_own_input(),
    )
    return html.Div(
        [
            html.Div([html.Label(factor.label, title=factor.note), typed], className="name"),
            html.Div(slider, id=f"slider-{factor.key}"),
        ],
        className="row",
    )


def _without_its_own_input() -> dict[str, Any]:
    """Sliders of Dash 4 come with a field for their number, which here would be that of a stop."""
    return {"allow_direct_input": False} if "allow_direct_input" in dcc.Slider().available_properties else {}


def _fluid(fluids: tuple[str, ...]) -> html.Div:
    choice = dcc.Dropdown(
        id="fluid",
        options=list(fluids),
        value=fluids[0] if fluids else None,
        clearable=False,
        searchable=False,
    )
    return html.Div([html.Label("fluid"), choice], className="row", hidden=not fluids)


def _results(name: str) -> list[Any]:
    headline = html.Div(
        [
            html.Div(id="problem", className="problem", role="alert"),
            html.Div(id="verdict"),
            html.Div(id="numbers", className="numbers"),
        ],
        className="card headline",
    )
    plots = [
        html.Div(
            [html.H2(heading), dcc.Graph(id=f"graph-{key}", config=_GRAPH, style=_TALL)],
            className="card",
        )
        for key, heading in _PICTURES.items()
    ]
    compare = html.Div(
        [
            html.H2("Compare"),
            html.Div(
                [
                    html.Button("Pin this design", id="pin", className="main"),
                    html.Button("Back to the case", id="reset"),
                ],
                className="buttons",
            ),
            html.Div(id="compare", className="compare"),
        ],
        className="card",
    )
    files = html.Div(
        [
            html.H2("What is on the screen, as a file"),
            html.Div(
                [
                    dcc.Input(id="name", type="text", value=name, debounce=True, spellCheck="false"),
                    html.Button("Write case file", id="write"),
                    html.Button("Write report", id="report"),
                ],
                className="buttons",
            ),
            html.Div(id="said", className="said", role="status"),
            html.Div(id="report-said", className="said", role="status"),
        ],
        className="card files",
    )
    warnings = html.Div(id="warnings", className="warnings")
    return [headline, html.Div(plots, className="plots"), warnings, compare, files]


def _follow(app: Dash, answers: Answers) -> None:
    app.clientside_callback(
        _GATHER,
        Output("asked", "data"),
        Output({"kind": "text", "key": ALL}, "value"),
        Input({"kind": "slider", "key": ALL}, "value"),
        Input("fluid", "value"),
        Input("typed", "data"),
        Input("poke", "data"),
        State("meta", "data"),
        State("asked", "data"),
    )
    app.clientside_callback(_ANSWERED, Input("shown", "data"))
    app.clientside_callback(_DARK, Output("dark", "data"), Input("meta", "data"))

    @app.callback(Output("news", "data"), Input("again", "n_intervals"), State("news", "data"))
    def ask_for_news(_: Any, before: Any) -> int:
        # a question of its own, which takes no time: the answer of the other one is never overtaken by it
        if answers.news == before:
            raise PreventUpdate
        return answers.news

    @app.callback(
        *(Output(f"graph-{key}", "figure") for key in _PICTURES),
        Output("problem", "children"),
        Output("verdict", "children"),
        Output("numbers", "children"),
        Output("numbers", "className"),
        Output("warnings", "children"),
        Output("compare", "children"),
        Output("state", "children"),
        Output("again", "disabled"),
        Output("shown", "data"),
        Input("asked", "data"),
        Input("news", "data"),
        Input("pins", "data"),
        Input("dark", "data"),
        State("shown", "data"),
    )
    def follow(asked: Any, _: Any, pins: Any, dark: Any, shown: Any) -> Any:
        if not asked or dark is None:
            raise PreventUpdate
        screen = answers.answer(asked["design"], asked["page"], asked["number"])
        if screen is None:
            raise PreventUpdate
        pinned = [answers.screen(design) for design in pins or []]
        state = _state(screen, answers)
        signature = json.dumps(
            [screen.design, state, bool(screen.waiting), pins, dark, [p.complete for p in pinned]]
        )
        now = {"signature": signature, "number": asked["number"]}
        if shown and signature == shown["signature"]:
            return (*[no_update] * (len(_PICTURES) + 8), now)
        if not screen.complete and not screen.problem:
            _settle_later(answers, asked)
        if screen.problem:
            # what was there before stays, faded
            kept = [no_update] * len(_PICTURES)
            return (
                *kept,
                screen.problem,
                no_update,
                no_update,
                "numbers stale",
                [],
                no_update,
                "",
                True,
                signature,
            )
        drawn = figures(screen, pinned, bool(dark))
        return (
            *(drawn[key].plain() for key in _PICTURES),
            "",
            _verdict(screen),
            [_number(one) for one in numbers_of(screen)],
            "numbers",
            _warnings(screen),
            _compared(screen, pinned, answers),
            state,
            screen.complete or not answers.works,
            now,
        )


def _settle_later(answers: Answers, asked: dict[str, Any]) -> None:
    """Begin with the complete run when nothing newer was asked for a while."""

    def begin() -> None:
        if answers.is_newest(asked["page"], asked["number"]):
            answers.settle(asked["design"])

    timer = threading.Timer(_REST, begin)
    timer.daemon = True
    timer.start()


def _state(screen: Screen, answers: Answers) -> str:
    if screen.complete:
        return "the numbers of fem-seal run"
    if screen.waiting:
        return f"calculating: {screen.waiting}"
    return "live; fem-seal run follows ..." if answers.works else "live"


_COLOURS = {"pass": "good", "fail": "bad", "inconclusive": "warn"}


def _verdict(screen: Screen) -> list[Any]:
    """What is said of the requirement, and how far the numbers can be trusted."""
    load = screen.load
    if load is None:
        return []
    found = []
    if screen.verdict:
        first, *others = screen.told
        words = [
            html.Span(screen.verdict, id="verdict-word"),
            html.Div(" ".join([first, *others]), className="why"),
        ]
        found.append(html.Div(words, className=f"verdict {_COLOURS.get(screen.verdict, 'warn')}"))
    elif screen.limits and not screen.complete:
        found.append(html.Div("The verdict follows when the sliders rest.", className="verdict"))
    colour, level = validity_words(load, screen.round)
    why = "; ".join(load.reasons)
    told = "" if screen.verdict else " ".join(screen.told)
    below = [html.Div(text, className="why") for text in (why, told) if text]
    found.append(html.Div([level, *below], className=f"verdict {colour}", id="validity"))
    facts = [
        html.Div([html.Span(name, className="what"), html.B(value), html.Span(remark, className="more")])
        for name, value, remark in screen.facts
    ]
    return [*found, *([html.Div(facts, className="facts")] if facts else [])]


def _number(number: Number) -> html.Div:
    return html.Div(
        [
            html.Div(number.what, className="what"),
            html.Div(
                number.value, className="value", id=f"value-{number.name}", **{"data-si": repr(number.si)}
            ),
            *([html.Div(number.more, className="more")] if number.more else []),
        ],
        className="number",
    )


def _warnings(screen: Screen) -> list[Any]:
    if not screen.warnings:
        return []
    return [
        html.Div(
            [html.H2("To know before believing it"), html.Ul([html.Li(one) for one in screen.warnings])],
            className="card",
        )
    ]


def _compared(screen: Screen, pinned: list[Screen], answers: Answers) -> list[Any]:
    if not pinned:
        return [
            html.Div(
                f"Pin up to {_MOST_PINS} designs to see them beside what the sliders show.", className="note"
            )
        ]
    factors = answers.session.factors
    shown = [(screen, LIVE, "now"), *((pin, PINS[n], chr(ord("A") + n)) for n, pin in enumerate(pinned))]
    heads = [html.Th("")]
    for number, (_, colour, name) in enumerate(shown):
        buttons = (
            []
            if name == "now"
            else [
                html.Button("take", id={"kind": "take", "number": number - 1}),
                html.Button("remove", id={"kind": "remove", "number": number - 1}),
            ]
        )
        heads.append(html.Th([html.Span(className="dot", style={"background": colour}), name, " ", *buttons]))
    labels = {one.key: one.label for one in factors.sliders} | {"fluid": "fluid"}
    rows = [
        html.Tr([html.Td(labels[key]), *(html.Td(one.design.get(key, "")) for one, _, _ in shown)])
        for key in changed(factors, screen.design, [pin.design for pin in pinned])
    ]
    numbers = [{one.name: one for one in numbers_of(each)} for each, _, _ in shown]
    for name, first in numbers[0].items():
        rows.append(
            html.Tr(
                [
                    html.Td(first.what),
                    *(html.Td(each[name].value if name in each else "–") for each in numbers),
                ]
            )
        )
    validity = [validity_words(one.load)[1] if one.load else "–" for one, _, _ in shown]
    rows.append(html.Tr([html.Td("validity"), *(html.Td(one) for one in validity)]))
    return [html.Table([html.Thead(html.Tr(heads)), html.Tbody(rows)])]


def _type(app: Dash, answers: Answers) -> None:
    factors = answers.session.factors

    @app.callback(
        Output("typed", "data"),
        Output({"kind": "slider", "key": ALL}, "value"),
        Output("fluid", "value"),
        Output("problem", "children", allow_duplicate=True),
        Input({"kind": "text", "key": ALL}, "n_submit"),
        Input({"kind": "text", "key": ALL}, "n_blur"),
        Input({"kind": "take", "number": ALL}, "n_clicks"),
        Input("reset", "n_clicks"),
        State({"kind": "text", "key": ALL}, "value"),
        State("typed", "data"),
        State("asked", "data"),
        State("pins", "data"),
        prevent_initial_call=True,
    )
    def type_or_take(
        _a: Any, _b: Any, takes: Any, _c: Any, texts: Any, typed: Any, asked: Any, pins: Any
    ) -> Any:
        who = ctx.triggered_id
        keep = [no_update] * len(factors.sliders)
        if who is None or not any(one.get("value") for one in ctx.triggered):
            raise PreventUpdate
        if who == "reset" or who.get("kind") == "take":
            design = factors.given if who == "reset" else pins[who["number"]]
            at = [one.nearest(design[one.key]) for one in factors.sliders]
            own = {
                one.key: {"at": place, "text": design[one.key]}
                for one, place in zip(factors.sliders, at, strict=True)
            }
            return own, at, design.get("fluid", no_update), ""
        number = [one.key for one in factors.sliders].index(who["key"])
        factor, text = factors.sliders[number], str(texts[number] or "").strip()
        if asked and text == asked["design"].get(factor.key):
            raise PreventUpdate
        try:
            factor.check(text)
        except InputError as error:
            return no_update, keep, no_update, "; ".join(str(one) for one in error.problems)
        place = factor.nearest(text)
        keep[number] = place
        return {**(typed or {}), factor.key: {"at": place, "text": text}}, keep, no_update, no_update


def _pin(app: Dash, answers: Answers) -> None:
    @app.callback(
        Output("pins", "data"),
        Input("pin", "n_clicks"),
        Input({"kind": "remove", "number": ALL}, "n_clicks"),
        State("pins", "data"),
        State("asked", "data"),
        prevent_initial_call=True,
    )
    def pin(_: Any, removes: Any, pins: Any, asked: Any) -> Any:
        who, pins = ctx.triggered_id, list(pins or [])
        if who is None or not any(one.get("value") for one in ctx.triggered):
            raise PreventUpdate
        if who == "pin":
            design = answers.session.design(asked["design"])
            # the fifth takes the place of the first
            return pins if design in pins else [*pins, design][-_MOST_PINS:]
        return [one for number, one in enumerate(pins) if number != who["number"]]


def _files(app: Dash, answers: Answers, folder: Path) -> None:
    reports: list[Path] = []

    @app.callback(
        Output("said", "children"),
        Input("write", "n_clicks"),
        State("name", "value"),
        State("asked", "data"),
        prevent_initial_call=True,
    )
    def write(_: Any, name: Any, asked: Any) -> str:
        session = answers.session
        try:
            source = session.given.file
            remark = f"Written by fem-seal explore from {source.name if source else 'a case'}."
            path = write_case(session.case(asked["design"]), folder, str(name or ""), remark)
        except (SealError, OSError) as error:
            return f"Not written: {error}"
        return f"Written: {path}. It runs with: fem-seal run {path.name}"

    @app.callback(
        Output("report-folder", "data"),
        Output("report-again", "disabled", allow_duplicate=True),
        Output("report-said", "children", allow_duplicate=True),
        Input("report", "n_clicks"),
        State("name", "value"),
        State("asked", "data"),
        prevent_initial_call=True,
    )
    def report(_: Any, name: Any, asked: Any) -> Any:
        try:
            target = free_name(folder, str(name or ""), ".out")
            answers.session.case(asked["design"])
            target.mkdir(parents=True)
        except (SealError, OSError) as error:
            return no_update, True, f"No report: {error}"
        answers.report(asked["design"], target)
        return str(target), False, f"The report is being made in {target} ..."

    @app.callback(
        Output("report-said", "children"),
        Output("report-again", "disabled"),
        Input("report-again", "n_intervals"),
        State("report-folder", "data"),
        prevent_initial_call=True,
    )
    def made(_: Any, target: Any) -> Any:
        done = answers.written(Path(target)) if target else None
        if done is None:
            raise PreventUpdate
        if done.problem:
            return f"No report: {done.problem}", True
        path = Path(target)
        if path not in reports:
            reports.append(path)
        link = html.A("open the report", href=f"/report/{reports.index(path)}", target="_blank")
        return [f"Report in {target}: ", link], True

    @app.server.route("/report/<int:number>")
    def show_report(number: int) -> Response:
        from flask import abort, send_file

        if number >= len(reports):
            abort(404)
        return send_file(reports[number].absolute() / "report.html")
