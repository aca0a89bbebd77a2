"""Pieces of the page: what is said of a screen, as elements of dash."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dash import html

from fem_seal.explore.figures import LIVE, PINS
from fem_seal.explore.words import Number, changed, numbers_of, validity_words

if TYPE_CHECKING:
    from fem_seal.explore.factors import Factors
    from fem_seal.explore.screen import Screen

_COLOURS = {"pass": "good", "fail": "bad", "inconclusive": "warn"}


def verdict(screen: Screen) -> list[Any]:
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
        found.append(html.Div("The verdict follows with the range of the leak rate.", className="verdict"))
    colour, level = validity_words(screen)
    why = "; ".join(load.reasons)
    told = "" if screen.verdict else " ".join(screen.told)
    below = [html.Div(text, className="why") for text in (why, told) if text]
    found.append(html.Div([level, *below], className=f"verdict {colour}", id="validity"))
    facts = [
        html.Div([html.Span(name, className="what"), html.B(value), html.Span(remark, className="more")])
        for name, value, remark in screen.facts
    ]
    return [*found, *([html.Div(facts, className="facts")] if facts else [])]


def numbers(screen: Screen) -> list[Any]:
    """The numbers of the load that is shown."""
    return [_number(one) for one in numbers_of(screen)]


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


def warnings(screen: Screen) -> list[Any]:
    """What to know before believing it."""
    if not screen.warnings:
        return []
    return [
        html.Div(
            [html.H2("To know before believing it"), html.Ul([html.Li(one) for one in screen.warnings])],
            className="card",
        )
    ]


def compared(screen: Screen, pinned: list[Screen], factors: Factors) -> list[Any]:
    """Pinned designs beside the one on the screen."""
    if not pinned:
        return [
            html.Div(
                f"Pin up to {len(PINS)} designs to see them beside what the sliders show.", className="note"
            )
        ]
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
    validity = [validity_words(one)[1] if one.load else "–" for one, _, _ in shown]
    rows.append(html.Tr([html.Td("validity"), *(html.Td(one) for one in validity)]))
    return [html.Table([html.Thead(html.Tr(heads)), html.Tbody(rows)])]
