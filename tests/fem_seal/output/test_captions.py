"""Captions of the pictures."""

from __future__ import annotations

import re

from fem_seal.units import Display
from fem_seal.wording import template


def test_no_sentence_of_a_caption_has_more_than_25_words():
    source = template(Display(), "answers/captions.j2").filename
    assert source
    with open(source, encoding="utf-8") as file:
        macros = re.findall(r"{% macro (\w+)\(.*?%}(.*?){% endmacro %}", file.read(), re.DOTALL)
    for name, text in macros:
        words = re.sub(r"{{.*?}}", "number", text).split()
        assert "alt" in name or len(words) <= 25, name
