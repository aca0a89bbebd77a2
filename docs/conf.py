"""Settings of the manual: `make docs` writes docs/_build/html."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parent), str(HERE / "make")]

from fem_seal.version import __version__  # noqa: E402

project = "fem-seal"
author = copyright = "the fem-seal authors"
version = release = __version__

extensions = [
    "markdown_pages",
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.mathjax",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = [
    "_build",
    "research",
    "validation",
    "verification/made",
    "**/.ipynb_checkpoints",
    "cases/scripts/*.ipynb",
    "cases/scripts/sg_*",
]
nitpicky = True
# Types in docstrings are words for people ("ndarray, shape (m,)"), which link to nothing.
nitpick_ignore_regex = [("py:.*", ".*")]

# Pages are Markdown; headings can be linked to like on the pages of a repository.
myst_enable_extensions = ["attrs_inline", "colon_fence", "deflist", "dollarmath", "fieldlist"]
myst_heading_anchors = 3
myst_dmath_double_inline = True

# Formulas are set in the browser by a MathJax that comes with the manual, so that it can be read without a network.
_mathjax = find_spec("sphinx-mathjax-offline")
assert _mathjax is not None and _mathjax.submodule_search_locations is not None
mathjax_path = "tex-svg.js"
mathjax3_config = {"svg": {"fontCache": "local"}}

# A name of Python has a page of its own, made of its docstring.
autosummary_generate = [f"reference/api/{package}.rst" for package in ("fem_seal", "leak", "meshes")]
autodoc_typehints = "none"
autodoc_class_signature = "mixed"
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True
default_role = "code"

# A cell that fails fails the manual.
nb_execution_mode = "cache"
nb_execution_cache_path = str(HERE / "_build" / "notebooks")
nb_execution_raise_on_error = True
nb_execution_timeout = 120

sphinx_gallery_conf = {
    "examples_dirs": "_build/scripts",
    "gallery_dirs": "cases/scripts",
    "filename_pattern": r"\.py$",
    "abort_on_example_error": True,
    "download_all_examples": False,
    "remove_config_comments": True,
    "show_signature": False,
    "min_reported_time": 60,
}

templates_path = ["_templates"]

html_theme = "pydata_sphinx_theme"
html_title = "fem-seal"
html_static_path = ["_static", f"{next(iter(_mathjax.submodule_search_locations))}/static/mathjax/tex-svg.js"]
# The reports of the examples, as a run writes them.
html_extra_path = ["_build/with_pages"]
html_css_files = ["manual.css"]
html_show_sourcelink = False
html_copy_source = False
html_theme_options = {
    "show_prev_next": True,
    "navigation_with_keys": False,
    "navbar_align": "left",
    "header_links_before_dropdown": 7,
    "show_toc_level": 2,
    "footer_start": ["copyright"],
    "footer_end": [],
    "pygments_light_style": "tango",
}
html_sidebars = {"changelog": [], "glossary": []}
copybutton_prompt_text = r">>> |\.\.\. |\$ "
copybutton_prompt_is_regexp = True
