"""Access to the page: token, origin and questions are checked, refusals are one line.

Every process of this machine can reach 127.0.0.1, and so can every site that is open in a browser. The page answers
who has its token: it stands in the address that the command prints, and the browser keeps a cookie for it.
"""

from __future__ import annotations

import hmac
import os
import secrets
import sys
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

from dash.exceptions import DependencyException, InvalidResourceError, PreventUpdate
from flask import Response, abort, request
from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError
from werkzeug.exceptions import BadRequest, HTTPException

from fem_seal.errors import defect_text, printable
from fem_seal.files import own_tables

if TYPE_CHECKING:
    from dash import Dash

HOST = "127.0.0.1"
# Largest question [bytes]: those of the page take a few thousand.
_LARGEST = 1_000_000
_NAMELESS = "open the address that fem-seal explore printed: it carries the token of the page"
_OTHER_USER = "another user of this machine opened this address"
_SOCKETS = Path("/proc/net/tcp")


class DefectError(Exception):
    """Something went wrong in the page itself, not in what was asked of it."""


def new_token() -> str:
    """A secret that nobody guesses."""
    return secrets.token_urlsafe(24)


def guard(page: Dash, port: int, token: str, report: Callable[[BaseException], None]) -> None:
    """Answer nobody but the page in the browser of this user, with headers that keep it to itself.

    Parameters
    ----------
    page : Dash
        With all its callbacks: scripts that stand in it later do not run.
    port : int
    token : str
        Of the address.
    report : callable
        Gets what went wrong in the page itself.
    """
    _answer_those_who_know(page, port, token)
    _send_headers(page)
    _refuse_in_one_line(page, report)


def _answer_those_who_know(page: Dash, port: int, token: str) -> None:
    page.server.config["MAX_CONTENT_LENGTH"] = _LARGEST
    names = {f"{host}:{port}" for host in (HOST, "localhost")}
    # another secret than the token: that can be seen among the arguments of a browser that is being opened
    cookie, secret = f"fem-seal-{port}", new_token()

    @page.server.before_request
    def check() -> None:
        origin = request.headers.get("Origin", "")
        if request.host not in names or (origin and origin.removeprefix("http://") not in names):
            abort(403, "this page answers only itself")
        if _same(request.cookies.get(cookie, ""), secret):
            return
        if request.path != "/" or not _same(request.args.get("token", ""), token):
            abort(403, _NAMELESS)
        if not own_connection(request.environ.get("REMOTE_PORT"), port):
            abort(403, _OTHER_USER)
        request.environ["fem-seal.opened"] = True

    @page.server.after_request
    def remember(response: Response) -> Response:
        if request.environ.get("fem-seal.opened"):
            response.set_cookie(cookie, secret, httponly=True, samesite="Strict")
            response.headers["Cache-Control"] = "no-store"
        return response


def _same(token: str, expected: str) -> bool:
    return hmac.compare_digest(token.encode(), expected.encode())


def own_connection(theirs: object, ours: int) -> bool:
    """Whether a connection within this machine is this user's, as far as the system tells (Linux).

    There any user sees the arguments of a browser that is opened with an address, the token in it.

    Parameters
    ----------
    theirs : object
        Port of who asks.
    ours : int
        Port of the page.
    """
    if sys.platform == "win32":
        return True
    try:
        rows = [line.split() for line in _SOCKETS.read_text(encoding="ascii").splitlines()[1:]]
        ends = [f":{int(str(port)):04X}" for port in (theirs, ours)]
    except (OSError, ValueError):
        return True
    owners = {
        int(row[7]) for row in rows if len(row) > 7 and row[1].endswith(ends[0]) and row[2].endswith(ends[1])
    }
    return not owners or bool(owners & {os.getuid(), 0})


def _send_headers(page: Dash) -> None:
    hashes = " ".join(page.csp_hashes())
    headers = {
        name: text.format(hashes=hashes) for name, text in own_tables("explore/looks.toml")["headers"].items()
    }

    @page.server.after_request
    def add(response: Response) -> Response:
        response.headers.update(headers)
        return response


def register_callback(page: Dash, *wiring: Any, **options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Have a function called by dash, its own failures told from questions that are none.

    Parameters
    ----------
    page : Dash
    *wiring, **options
        As of `Dash.callback`.
    """

    def register(callback: Callable[..., Any]) -> Any:
        @page.callback(*wiring, **options)
        @wraps(callback)
        def answer(*values: Any) -> Any:
            try:
                return callback(*values)
            except (PreventUpdate, HTTPException):
                raise
            except Exception as error:
                raise DefectError from error

        return answer

    return register


def _refuse_in_one_line(page: Dash, report: Callable[[BaseException], None]) -> None:
    def line(code: int, text: str) -> Response:
        return Response(f"{printable(text)}\n", code, mimetype="text/plain")

    def answer_http_error(error: Exception) -> Response:
        if isinstance(error, HTTPException):
            return line(error.code or 500, error.description or error.name)
        if isinstance(error, (DependencyException, InvalidResourceError)):
            return line(404, "the page has no such file")
        if request.path == "/_dash-update-component" and not isinstance(error, DefectError):
            # what dash makes of a question that it did not write
            return line(400, "this is no question of the page")
        cause = error.__cause__ or error if isinstance(error, DefectError) else error
        report(cause)
        return line(500, defect_text(cause))

    # dash has an answer of its own to some of them
    for kind in (Exception, InvalidResourceError):
        page.server.register_error_handler(kind, answer_http_error)


T = TypeVar("T")
# From keys of factors to texts.
Design = dict[str, str]


class PageRequest(BaseModel):
    """A design that a page wants to see.

    Parameters
    ----------
    design : dict
        From keys of factors to texts.
    page : str
        Name of the page.
    number : int
        Of its question, counted up.
    wrong : dict
        From keys of factors to texts that stand in their fields and could not be taken.
    """

    model_config = ConfigDict(strict=True, frozen=True)

    design: Design
    page: str
    number: int
    wrong: Design = {}


class FieldText(BaseModel):
    """A text that has been typed in.

    Parameters
    ----------
    text : str
    before : str
        What was calculated with until then.
    at : int
        Place of its slider.
    """

    model_config = ConfigDict(strict=True, frozen=True)

    text: str
    before: str
    at: int


def validate(kind: type[T], value: Any, what: str) -> T:
    """A part of a question.

    Parameters
    ----------
    kind : type
        That it must be of.
    value : object
    what : str
        Its name.

    Raises
    ------
    BadRequest
        If it is something else.
    """
    try:
        return TypeAdapter(kind).validate_python(value, strict=True)
    except ValidationError as error:
        refuse(
            next((str(part) for part in error.errors()[0]["loc"] if part in PageRequest.model_fields), what)
        )


def refuse(what: str) -> NoReturn:
    """Say that a part of a question is wrong.

    Raises
    ------
    BadRequest
        Always.
    """
    raise BadRequest(f"{what}: not what the page sends")
