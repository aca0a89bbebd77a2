"""Elements of dash, as they stand in `templates/explore.html.j2`."""

from __future__ import annotations

import json
import re
from typing import Any
from xml.etree.ElementTree import Element, fromstring

from dash import dcc, html

from fem_seal.output.prose import template

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
    text: str = getattr(template("explore.html.j2").module, macro)(**values)
    return _children(fromstring(f"<page>{_NO_XML.sub('', text)}</page>"))


def _children(parent: Element) -> list[Any]:
    found: list[Any] = [parent.text]
    for one in parent:
        found += [_element(one), one.tail]
    return [one for one in found if not (one is None or (isinstance(one, str) and not one.strip()))]


def _element(one: Element) -> Any:
    properties = {name: _property(text) for name, text in one.attrib.items()}
    if children := _children(one):
        properties["children"] = children
    return getattr(html if hasattr(html, one.tag) else dcc, one.tag)(**properties)


def _property(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text
