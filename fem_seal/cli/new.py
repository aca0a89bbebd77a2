"""The command `fem-seal new`: a commented case from a template, with answers to questions or from options."""

from __future__ import annotations

import sys
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from typer.core import TyperCommand

from fem_seal.cli.terminal import Debug, complain, option, output_option, prompt, say
from fem_seal.errors import InputError, NoLoadLeftError
from fem_seal.files import problem

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fem_seal.case.new_case import Question

NAMES = "ball-valve, check-valve, relief-valve, needle, flat-seat, knife-edge, flange or gasket"
CLASSES = (
    "ISO 5208 A, AA, B, C, CC, D, E, EE, F, G; EN 12266-1 A, B, C, D, E, F, G; FCI 70-2 II, III, IV, V, VI; "
    "API 598; MSS SP-61; API 527 of relief valves; EN 13555 L0.01, L0.1, L1.0; VDI 2440; ISO 15848-1 AH, BH, CH"
)

# What decides a leak rate and is easily left to the template.
_SIZES = {"diameter", "bore", "included-angle", "applied-force", "torque"}


def new(
    name: Annotated[str | None, option("new", "template", names=NAMES)] = None,
    output: Annotated[Path | None, output_option("NAME.toml", "Case file to write.", "FILE")] = None,
    title: Annotated[str | None, option("new", "title")] = None,
    diameter: Annotated[str | None, option("new", "diameter")] = None,
    bore: Annotated[str | None, option("new", "bore")] = None,
    included_angle: Annotated[str | None, option("new", "included_angle")] = None,
    closure_material: Annotated[str | None, option("new", "closure_material")] = None,
    seat_material: Annotated[str | None, option("new", "seat_material")] = None,
    ra: Annotated[str | None, option("new", "ra")] = None,
    process: Annotated[str | None, option("new", "process")] = None,
    fluid: Annotated[str | None, option("new", "fluid")] = None,
    pressure: Annotated[str | None, option("new", "pressure")] = None,
    applied_force: Annotated[str | None, option("new", "applied_force")] = None,
    set_pressure: Annotated[str | None, option("new", "set_pressure")] = None,
    torque: Annotated[str | None, option("new", "torque")] = None,
    leak_rate: Annotated[str | None, option("new", "leak_rate")] = None,
    leakage_class: Annotated[str | None, option("new", "class", classes=CLASSES)] = None,
    entries: Annotated[list[str] | None, option("new", "set")] = None,
    force: Annotated[bool, option("new", "force")] = False,
    debug: Debug = False,
) -> None:
    """Write a commented case that runs; it asks a few questions, or none with --template."""
    from fem_seal.case import new_case

    asks = name is None
    if asks and not _can_ask():
        raise InputError(problem("new_template_missing", names=NAMES))
    name = _chosen_template() if name is None else name
    text = new_case.template(name)
    path = output or Path(f"{name}.toml")
    _check_place(path, force)
    answers = {
        "title": title,
        "diameter": diameter,
        "bore": bore,
        "included-angle": included_angle,
        "closure-material": closure_material,
        "seat-material": seat_material,
        "ra": ra,
        "process": process,
        "fluid": fluid,
        "pressure": pressure,
        "applied-force": applied_force,
        "set-pressure": set_pressure,
        "torque": torque,
        "leak-rate": leak_rate,
        "class": leakage_class,
    }
    options = {key: value for key, value in answers.items() if value is not None}
    text, told = new_case.with_options(text, name, options, entries or [])
    if told:
        say(told)
    if asks:
        text = _with_answers(text, options)
    else:
        case = new_case.read_text_case(text)
        if bore and case.leak.nominal_size:
            circle = 2.0 * case.contact.initial_contact_radius
            if case.leak.nominal_size > circle:
                complain(str(problem("new_bore_wide", bore=bore, circle=circle)), "warning: ")
    _write(text, path)
    questions, open_sizes = new_case.find_questions(text), _SIZES - options.keys()
    sizes = [f"{question.words} {value}" for question, _, value in questions if question.name in open_sizes]
    if sizes and options and not asks:
        scale = ", to the scale of what you gave" if {"bore", "diameter"} & options.keys() else ""
        say(f"From the template{scale}: {', '.join(sizes)}")
    say(f"{path} is written; next:")
    say(f"  fem-seal check {_quote_text(path)} --picture   (draws its section)")
    say(f"  fem-seal run {_quote_text(path)}   (leak rate and report)")


class ForceTakesNoValue(TyperCommand):
    """Says that `--force` replaces a file where a closing force stands behind it."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """The arguments as they are.

        Raises
        ------
        InputError
        """
        for word, value in pairwise(args):
            if word == "--force" and not value.startswith("-"):
                raise InputError(problem("new_force", value=value))
        return super().parse_args(ctx, args)


def _can_ask() -> bool:
    return sys.stdin.isatty()


def _chosen_template() -> str:
    from fem_seal.case import new_case

    say("Which kind of seal?")
    for number, name in enumerate(new_case.TEMPLATES, start=1):
        say(f"  {number}  {name:14}{new_case.about(name)}")
    while True:
        answer = prompt("number or name", "1")
        if answer.isdecimal() and 1 <= int(answer) <= len(new_case.TEMPLATES):
            return new_case.TEMPLATES[int(answer) - 1]
        if answer in new_case.TEMPLATES:
            return answer
        say(f"1 to {len(new_case.TEMPLATES)}, or one of the names")


def _check_place(path: Path, force: bool) -> None:
    if path.exists() and not force:
        raise InputError(problem("new_file_there", path=path))
    if path.suffix.lower() != ".toml":
        raise InputError(problem("new_file_ending", path=path))


def _with_answers(text: str, options: Mapping[str, str]) -> str:
    """Ask for every entry that no option has given; answers that contradict each other are asked again."""
    from fem_seal.case import new_case

    say("Enter keeps the value in brackets.")
    while True:
        paths: list[str] = []
        for question in new_case.QUESTIONS:
            place = next((item for item in new_case.find_questions(text) if item[0] is question), None)
            if place is not None and question.name not in options:
                text = _answer_question(text, *place, fixed=paths)
            paths += [] if place is None else [place[1]]
        try:
            new_case.read_text_case(text)
        except InputError as error:
            options = {}
            for fault in error.problems:
                complain(str(fault), "")
            say("Once more:")
        else:
            return text


def _answer_question(text: str, question: Question, path: str, value: str, fixed: list[str]) -> str:
    """The text with a valid answer to a question; entries not answered yet are scaled with the size of the valve."""
    from fem_seal.case import new_case

    while True:
        answer = prompt(question.words, value)
        new_text = text
        if answer != value:
            scaled_text = (
                new_case.scale_case(text, path, answer, fixed)
                if question.name in ("bore", "diameter")
                else text
            )
            new_text = new_case.with_entries(scaled_text, {path: answer})
            if question.name == "fluid":
                new_text, told = new_case.with_fluid_entries(new_text, set(fixed))
                if told:
                    say(told)
        try:
            new_case.read_text_case(new_text)
        except NoLoadLeftError:
            # the force is asked last and may correct this
            return new_text
        except InputError as error:
            faults = [p for p in error.problems if p.key == path or p.key.startswith(f"{path}.")]
            if not faults:
                return new_text
            complain(str(faults[0]), "")
        else:
            return new_text


def _write(text: str, path: Path) -> None:
    """Write the case, and the schema for editors next to it."""
    from fem_seal.case import new_case
    from fem_seal.case.schema import case_schema
    from fem_seal.files import as_json, write_text

    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_text(path.with_name(new_case.SCHEMA_FILE), as_json(case_schema()) + "\n")
        write_text(
            path, new_case.with_schema(text.replace(" FILE", f" {path.name}"), f"./{new_case.SCHEMA_FILE}")
        )
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError.at("--output", f"cannot be written ({reason})", str(path)) from None


def _quote_text(path: Path) -> str:
    return f'"{path}"' if " " in str(path) else str(path)
