"""The page: its layout, its elements of dash, and what follows when something is moved."""

from __future__ import annotations

import json
import math
import re
import threading
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import partial
from html import escape
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree.ElementTree import Element, fromstring

from dash import ALL, Dash, Input, Output, State, ctx, dcc, html, no_update
from dash.exceptions import PreventUpdate
from flask import Response, abort, request, send_file

from fem_seal.case.case import case_text, free_name, write_case
from fem_seal.errors import SealError
from fem_seal.explore.choices import ROWS, apply_choice, choices_of, pictures_of
from fem_seal.explore.figures import PIN_NAMES, PINS, designs_shown, figures
from fem_seal.explore.gate import Design, FieldText, PageRequest, refuse, register_callback, validate
from fem_seal.explore.screen import not_taken_words, page_words, refused_words, slow_words, still_words
from fem_seal.files import own_tables
from fem_seal.units import Display
from fem_seal.wording import environment

if TYPE_CHECKING:
    from fem_seal.case.case import Case
    from fem_seal.explore.screen import Screen
    from fem_seal.explore.session import Session
    from fem_seal.explore.worker import Answers

# Signs without a place in XML, which no browser shows either.
_NO_XML = re.compile("[^\t\n\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def elements(macro: str, **values: Any) -> list[Any]:
    """What a macro of the template makes of some values: elements and texts.

    Parameters
    ----------
    macro : str
    values
        Its parameters.
    """
    text: str = getattr(
        environment(Display(), escaped=True).get_template("explore/page.html.j2").module, macro
    )(**values)
    return _children(fromstring(f"<page>{_NO_XML.sub('', text)}</page>"))


def _children(parent: Element) -> list[Any]:
    parts: list[Any] = [parent.text]
    for element in parent:
        parts += [_element(element), element.tail]
    return [part for part in parts if not (part is None or (isinstance(part, str) and not part.strip()))]


def _element(element: Element) -> Any:
    properties = {name: _property(text) for name, text in element.attrib.items()}
    if children := _children(element):
        properties["children"] = children
    return getattr(html if hasattr(html, element.tag) else dcc, element.tag)(**properties)


def _property(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text


# Rest of the sliders after which the complete run begins [s].
_REST = 0.4
_PICTURES = {
    "section": "Section",
    "leak": "Leak rate",
    "profile": "Contact pressure across the seat; dashed: fluid pressure",
    "gap": "Gap across the seat",
}
# For so long the page waits to begin with the first numbers [s].
_FIRST_WITHIN = 1.0
# Elements whose contents follow the sliders.
_FOLLOWS = ("verdict", "numbers", "sensitivities", "warnings", "compare", "problem", "lost", "state")


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
        # dash puts it into the head as it is, and fills in what stands between braces
        title=escape(f"{title} - fem-seal").replace("{", "&#123;"),
        update_title="",
        serve_locally=True,
        suppress_callback_exceptions=True,
        assets_folder=str(folder / "no-assets-of-a-case"),
    )
    app.index_string = _template("explore.html").replace("STYLE", _template("explore.css"))
    stem = answers.session.base_design.file.stem if answers.session.base_design.file else "case"
    app.layout = lambda: _layout(answers, title, f"{stem}-explored")
    # callbacks that run in the browser, by their names
    scripts = dict(re.findall(r"(?ms)^(?=function (\w+))(.+?^})", _template("explore.js")))
    _follow(app, answers, scripts)
    _type(app, answers, scripts)
    _choose(app, answers)
    _pin(app, answers, scripts)
    _files(app, answers, folder)
    return app


def _template(name: str) -> str:
    return resources.files("fem_seal").joinpath("templates", name).read_text(encoding="utf-8")


def _layout(answers: Answers, title: str, name: str) -> Any:
    look = own_tables("explore/looks.toml")
    session = answers.newest
    # the first numbers are read before plotly.js is loaded; dash makes a layout of its own before, to check it
    first = answers.first_screen(_FIRST_WITHIN if request.path == "/_dash-layout" else 0.0)
    begins: dict[str, Any] = {}
    if first is not None and first.load:
        state = _state(first, answers)
        begins = {
            "now": (now := designs_shown(first, [])[0]),
            "figures": {key: figure.plain() for key, figure in figures([now], dark=False).items()},
            "state": state,
            "shown": {
                "signature": _signature(first, state, {}, "", [], False, []),
                "number": 0,
                "design": first.design,
            },
        }
    (layout,) = elements(
        "page",
        title=title,
        name=name,
        meta=_meta(session),
        pictures=_PICTURES,
        empty={"data": [], "layout": look["empty"]},
        height=look["layout"]["height"],
        begins=begins,
        most=len(PINS),
        **_controls(session, session.base_design),
    )
    return layout


def _signature(
    screen: Screen, state: str, wrong: Design, loss: str, pins: object, dark: object, others: Sequence[Screen]
) -> str:
    """What changes where the page is drawn anew."""
    looks = [pins or [], bool(dark), [design.complete for design in others]]
    return json.dumps([screen.design, state, wrong, loss, screen.sensitivities, *looks])


def _meta(session: Session) -> dict[str, Any]:
    """What the scripts of the page know of a case."""
    sliders = session.factors.sliders
    return {
        "case": session.name,
        "keys": [factor.key for factor in sliders],
        "stops": {factor.key: factor.stops for factor in sliders},
    }


def _controls(session: Session, case: Case) -> dict[str, Any]:
    """What the controls of a case are made of."""
    factors, slow = session.factors, session.slow(session.base)
    return {
        "factors": factors,
        "remarks": [*factors.notes, *([slow_words(slow)] if slow else [])],
        # sliders of Dash 4 come with a field for their number, which here would be that of a stop
        "own_input": "allow_direct_input" in dcc.Slider().available_properties,
        "choices": choices_of(case),
        "shapes": {ROWS[row]: several for row, several in pictures_of(case).items()},
    }


def _follow(app: Dash, answers: Answers, scripts: dict[str, str]) -> None:
    app.clientside_callback(
        scripts["gather"],
        Output("asked", "data"),
        Output("present", "data"),
        Input({"kind": "slider", "key": ALL}, "value"),
        Input("typed", "data"),
        Input("poke", "data"),
        State("meta", "data"),
        State("asked", "data"),
    )
    app.clientside_callback(
        scripts["remember"],
        Output("history", "data"),
        Input("asked", "data"),
        State("history", "data"),
        prevent_initial_call=True,
    )
    off = [Output(name, "disabled") for name in ("undo", "redo")]
    app.clientside_callback(scripts["steps"], off, [Input("history", "data"), Input("present", "data")])
    app.clientside_callback(
        scripts["step"],
        Output("history", "data", allow_duplicate=True),
        Output("back", "data"),
        Input("undo", "n_clicks"),
        Input("redo", "n_clicks"),
        State("history", "data"),
        prevent_initial_call=True,
    )
    app.clientside_callback(scripts["answered"], Input("shown", "data"))
    app.clientside_callback(scripts["named"], Input("meta", "data"))
    app.clientside_callback(scripts["dark"], Output("dark", "data"), Input("meta", "data"))

    @register_callback(app, Output("news", "data"), Input("again", "n_intervals"), State("news", "data"))
    def ask_for_news(_: Any, last_news: Any) -> int:
        # a question of its own, which takes no time: the answer of the other one is never overtaken by it
        if answers.news == last_news:
            raise PreventUpdate
        return answers.news

    outputs = {
        "figures": [Output(f"graph-{key}", "figure") for key in _PICTURES],
        **{name: Output(name, "children") for name in _FOLLOWS},
        "wrong": Output({"kind": "wrong", "key": ALL}, "children"),
        "rows": Output({"kind": "row", "key": ALL}, "className"),
        "results": Output("results", "className"),
        "shown": Output("shown", "data"),
    }

    @register_callback(
        app,
        outputs,
        Input("asked", "data"),
        Input("news", "data"),
        Input("pins", "data"),
        Input("dark", "data"),
        State("shown", "data"),
    )
    def follow(request_data: Any, _: Any, pins: Any, dark: Any, state_data: Any) -> Any:
        if not request_data or dark is None:
            raise PreventUpdate
        question = validate(PageRequest, request_data, "asked")
        session = _session(answers, question.design)
        factors = session.factors
        state_data = validate(dict[str, Any], state_data or {}, "shown")
        old_design = validate(Design, state_data.get("design") or {}, "shown")
        screen = answers.answer(question.design, question.page, question.number)
        if screen is None:
            raise PreventUpdate
        if not screen.complete and not screen.problem:
            _settle_later(answers, question)
        pin_screens = [answers.screen(design) for design in _place_pins(answers, pins).values()]
        state, loss = _state(screen, answers), answers.loss_message
        signature = _signature(screen, state, question.wrong, loss, pins, dark, pin_screens)
        mark = {"signature": signature, "number": question.number, "design": old_design}
        # those of the page, which may have other sliders by now
        keys = [row["id"]["key"] for row in ctx.outputs_grouping["rows"]]
        several = {"figures": len(_PICTURES), "wrong": len(keys), "rows": len(keys)}
        unchanged_outputs = {n: [no_update] * several[n] if n in several else no_update for n in outputs}
        if signature == state_data.get("signature"):
            return {**unchanged_outputs, "shown": mark}
        wrong = {**refused_words(screen, old_design), **factors.find_errors(question.wrong)}
        values = {
            **unchanged_outputs,
            "wrong": [wrong.get(key, "") for key in keys],
            "rows": ["row not-taken" if key in wrong else "row" for key in keys],
            "lost": loss,
            "state": state,
        }
        if screen.problem:
            # what was there before stays, faded
            note = still_words(factors, screen.design, old_design)
            sentences = [f"{screen.problem}.", note, not_taken_words(factors, old_design, question.wrong)]
            problem = " ".join(filter(None, sentences))
            return {**values, "problem": problem, "results": "results stale", "warnings": [], "shown": mark}
        designs = designs_shown(screen, pin_screens)
        pictures = figures(designs, bool(dark))
        return {
            **values,
            "figures": [pictures[key].plain() for key in _PICTURES],
            **{
                name: elements(name, now=designs[0])
                for name in ("verdict", "numbers", "sensitivities", "warnings")
            },
            "compare": elements(
                "compare",
                now=designs[0],
                pinned=designs[1:],
                rows=_input_rows(answers, [design.screen for design in designs]),
                most=len(PINS),
            ),
            "problem": not_taken_words(factors, screen.design, question.wrong),
            "results": "results",
            "shown": {**mark, "design": screen.design},
        }


def _input_rows(answers: Answers, screens: Sequence[Screen]) -> dict[str, list[str]]:
    """What is chosen and moved in several designs, by the labels for people."""
    inputs = [answers.of(screen.design).inputs(screen.design) for screen in screens]
    return {label: [labels.get(label, "") for labels in inputs] for each in inputs for label in each}


def _settle_later(answers: Answers, question: PageRequest) -> None:
    """Begin with the complete run when nothing newer was asked for a while."""
    timer = threading.Timer(_REST, answers.work_ahead, (question.design, question.page, question.number))
    timer.daemon = True
    timer.start()


def _state(screen: Screen, answers: Answers) -> str:
    if screen.problem:
        return ""
    if screen.complete:
        return str(page_words().complete())
    if reason := answers.failure_reason(screen.design):
        return str(page_words().live_alone(reason))
    if screen.delay:
        return str(page_words().calculating(screen.delay))
    leaks = screen.load is not None and math.isfinite(screen.load.values["leak_rate_m3_per_s"])
    return str(page_words().live(screen, leaks)).strip()


def _type(app: Dash, answers: Answers, scripts: dict[str, str]) -> None:
    app.clientside_callback(
        scripts["enter"],
        Output("entered", "data"),
        Input({"kind": "text", "key": ALL}, "n_submit"),
        Input({"kind": "text", "key": ALL}, "n_blur"),
        State("entered", "data"),
        State("typed", "data"),
        State({"kind": "slider", "key": ALL}, "value"),
        State("meta", "data"),
        prevent_initial_call=True,
    )

    @register_callback(
        app,
        Output("judged", "data"),
        Input("entered", "data"),
        State("meta", "data"),
        prevent_initial_call=True,
    )
    def judge(entry_data: Any, meta: Any) -> Any:
        if not entry_data:
            raise PreventUpdate
        entry_data = validate(dict[str, Any], entry_data, "entered")
        fields = validate(dict[str, FieldText], entry_data.get("fields"), "entered")
        texts: dict[str, Any] = {}
        factors = _session(answers, validate(dict[str, Any], meta, "meta")).factors
        for factor in factors.sliders:
            if (field := fields.get(factor.key)) is None:
                continue
            if factor.find_error(field.text):
                # it stays in its field, beside what is calculated with
                if not 0 <= field.at < len(factor.stops):
                    refuse("entered")
                texts[factor.key] = {"at": field.at, "text": field.before, "wrong": field.text}
            else:
                texts[factor.key] = {"at": factor.nearest(field.text), "text": field.text}
        return {"number": entry_data.get("number"), "typed": texts}

    app.clientside_callback(
        scripts["judged"],
        Output("typed", "data"),
        Output({"kind": "slider", "key": ALL}, "value"),
        Input("judged", "data"),
        State("entered", "data"),
        State({"kind": "slider", "key": ALL}, "value"),
        State("meta", "data"),
        prevent_initial_call=True,
    )


def _choose(app: Dash, answers: Answers) -> None:
    """Everything that makes the controls anew: another case, or another design than that of the sliders."""

    @register_callback(
        app,
        Output("controls", "children"),
        Output("meta", "data"),
        Output("typed", "data", allow_duplicate=True),
        Output("entered", "data", allow_duplicate=True),
        Input({"kind": "choice", "key": ALL}, "value"),
        Input({"kind": "shape", "key": ALL}, "n_clicks"),
        Input("reset", "n_clicks"),
        Input("back", "data"),
        State("present", "data"),
        prevent_initial_call=True,
    )
    def choose(*states: Any) -> Any:
        back, present = states[-2:]
        acts, message = _read_actions(), ""
        design = validate(PageRequest, present, "present").design
        session = _session(answers, design)
        who = next((element for element, _ in acts), None)
        if isinstance(who, dict) and who.get("kind") in ("choice", "shape"):
            try:
                case = session.case(design)
                asks = _list_choices(case, acts)
                if not asks:
                    raise PreventUpdate
                for key, value in asks:
                    case = apply_choice(case, key, value)
                session = answers.open_case(case)
                design = session.design({})
            except SealError as error:
                message = str(error)
        elif who is None:
            raise PreventUpdate
        elif who == "reset":
            session = answers.session
            design = session.design({})
        else:
            design = validate(Design, back, "back")
            session = _session(answers, design)
        answers.newest = session
        return *_shown_controls(session, design, message), {}


def _list_choices(case: Case, acts: Sequence[tuple[Any, Any]]) -> list[tuple[str, str]]:
    """Keys and values of all that is chosen otherwise than in a case; what was done last comes last.

    A browser that asks again before it has an answer takes no notice of that, and tells only what was done since.
    """
    old_values = {choice.key: choice.value for several in choices_of(case).values() for choice in several}
    try:
        values = [
            (control["id"], control.get("value")) for several in ctx.inputs_list[:2] for control in several
        ]
        asks = [
            (str(control["key"]), str(value or ""))
            for control, value in [*values, *reversed(acts)]
            if _is_choice(control) or value
        ]
    except (AttributeError, KeyError, TypeError):
        refuse("inputs")
    # a later one of the same key takes the place of the first
    changes = {key: value for key, value in asks if old_values.get(key) != value}
    newest = [str(control["key"]) for control, _ in reversed(acts) if isinstance(control, dict)]
    return sorted(changes.items(), key=lambda ask: newest.index(ask[0]) if ask[0] in newest else -1)


def _shown_controls(
    session: Session, design: Design, message: str
) -> tuple[Any, dict[str, Any], dict[str, Any]]:
    """Controls of a design, what scripts know of its case, and its texts."""
    factors = session.factors
    design = session.design(design)
    if factors.find_errors(design):
        refuse("design")
    at = {factor.key: factor.nearest(design[factor.key]) for factor in factors.sliders}
    fields = {key: {"at": place, "text": design[key]} for key, place in at.items()}
    page = elements("controls", **_controls(session, session.case(design)), said=message, at=at, texts=design)
    return page, _meta(session), fields


def _session(answers: Answers, design: Mapping[str, Any]) -> Session:
    """The session of the case that a design belongs to."""
    if not answers.knows_case(design):
        refuse("case")
    return answers.of(design)


def _read_pins(pin_data: Any) -> list[Design]:
    """Designs that a page has pinned, no more than it can show."""
    pins = validate(list[Design], pin_data or [], "pins")
    if len(pins) > len(PINS):
        refuse("pins")
    return pins


def _place_pins(answers: Answers, places: Any) -> dict[int, Design]:
    """Pinned designs by their places; a tab may have pinned some of a page that was here before."""
    return {number: design for number, design in enumerate(_read_pins(places)) if answers.knows_case(design)}


def _read_actions() -> list[tuple[Any, Any]]:
    """Elements with which something was done, ids with their values: those that were clicked before choices.

    Controls that were made anew are told with them, buttons without a value and choices as they are.
    """
    try:
        names = ctx.triggered_prop_ids
        acts = [
            (names[trigger["prop_id"]], trigger.get("value"))
            for trigger in ctx.triggered
            if trigger["prop_id"] in names
        ]
    except (AttributeError, LookupError, TypeError, ValueError):
        # dash reads what the browser says of it only now
        refuse("changedPropIds")
    return sorted((act for act in acts if act[1] or _is_choice(act[0])), key=lambda act: _is_choice(act[0]))


def _is_choice(who: Any) -> bool:
    return isinstance(who, dict) and who.get("kind") == "choice"


def _pin(app: Dash, answers: Answers, scripts: dict[str, str]) -> None:
    @register_callback(
        app,
        Output("pins", "data"),
        Input("pin", "n_clicks"),
        State("pins", "data"),
        State("present", "data"),
        prevent_initial_call=True,
    )
    def pin(_: Any, pins: Any, present: Any) -> Any:
        if not _read_actions():
            raise PreventUpdate
        old_design, pins = validate(PageRequest, present, "present").design, _read_pins(pins)
        design = _session(answers, old_design).design(old_design)
        # the fifth takes the place of the first
        return pins if design in pins else [*pins, design][-len(PINS) :]

    @register_callback(app, Output("pinned", "children"), Input("pins", "data"))
    def show_buttons(pins: Any) -> Any:
        return elements("pinned", names=list(zip(_place_pins(answers, pins), PIN_NAMES, PINS, strict=False)))

    app.clientside_callback(
        scripts["pinned"],
        Output("back", "data", allow_duplicate=True),
        Output("pins", "data", allow_duplicate=True),
        Input({"kind": "take", "number": ALL}, "n_clicks"),
        Input({"kind": "remove", "number": ALL}, "n_clicks"),
        State("pins", "data"),
        prevent_initial_call=True,
    )


def _files(app: Dash, answers: Answers, folder: Path) -> None:
    reports: list[Path] = []
    on_change = partial(register_callback, app, prevent_initial_call=True)
    states = State("name", "value"), State("present", "data")

    @on_change(Output("said", "children"), Input("write", "n_clicks"), *states)
    def write(_: Any, name: Any, request_data: Any) -> str:
        present = validate(PageRequest, request_data, "present")
        session = _session(answers, present.design)
        try:
            source = session.base_design.file
            remark = f"Written by fem-seal explore from {source.name if source else 'a case'}."
            path = write_case(session.case(present.design).written, folder, str(name or ""), remark)
        except (SealError, OSError) as error:
            return f"Not written: {error}"
        note = not_taken_words(session.factors, session.design(present.design), present.wrong)
        return f"Written: {path}. It runs with: fem-seal run {path.name}. {note}".strip()

    @on_change(Output("download", "data"), Input("take-away", "n_clicks"), *states)
    def take_away(_: Any, name: Any, request_data: Any) -> Any:
        present = validate(PageRequest, request_data, "present")
        text = case_text(_session(answers, present.design).case(present.design).written, folder)
        return {"content": text, "filename": f"{str(name or 'case').removesuffix('.toml')}.toml"}

    said = Output("report-said", "children", allow_duplicate=True)

    @on_change(Output("report-folder", "data"), said, Input("report", "n_clicks"), *states)
    def report(_: Any, name: Any, request_data: Any) -> Any:
        present = validate(PageRequest, request_data, "present")
        session = _session(answers, present.design)
        try:
            target = free_name(folder, str(name or ""), ".out")
            session.case(present.design)
            target.mkdir(parents=True)
        except (SealError, OSError) as error:
            return None, f"No report: {error}"
        answers.report(present.design, target)
        note = not_taken_words(session.factors, session.design(present.design), present.wrong)
        return str(target), f"The report is being made in {target} ... {note}".strip()

    @on_change(Output("report-said", "children"), Input("news", "data"), State("report-folder", "data"))
    def show_report_state(_: Any, target: Any) -> Any:
        problem = answers.report_problem(Path(validate(str, target, "report"))) if target else None
        if problem is None:
            raise PreventUpdate
        path = Path(target)
        if problem:
            with suppress(OSError):
                # nothing has been written into it
                path.rmdir()
            return f"No report: {problem}"
        if path not in reports:
            reports.append(path)
        link = html.A("open the report", href=f"/report/{reports.index(path)}", target="_blank")
        return [f"Report in {target}: ", link]

    @app.server.route("/report/<int:number>")
    def show_report(number: int) -> Response:
        if number >= len(reports):
            abort(404, "the page has no such report")
        path = reports[number].absolute() / "report.html"
        if not path.exists():
            abort(404, f"{path} is not there any more")
        return send_file(path)
