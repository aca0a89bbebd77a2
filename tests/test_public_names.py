"""Public names of the packages: typed, loaded on first use, and no others."""

import ast
import subprocess
import sys
from pathlib import Path

import fem_seal
import fem_seal.contact

ROOT = Path(__file__).parent.parent


def test_every_public_name_is_there():
    for name in fem_seal.__all__:
        assert getattr(fem_seal, name) is not None
    for name in fem_seal.contact.__all__:
        assert getattr(fem_seal.contact, name) is not None


def test_completion_offers_what_is_meant_and_nothing_else():
    # submodules and helpers are attributes of the package as soon as something loads them
    assert dir(fem_seal) == sorted(fem_seal.__all__)


def test_the_type_checker_knows_every_name():
    tree = ast.parse((ROOT / "fem_seal" / "__init__.py").read_text(encoding="utf-8"))
    block = next(node for node in tree.body if isinstance(node, ast.If))
    typed = {alias.name for node in block.body for alias in node.names}
    assert typed == set(fem_seal.__all__) - {"__version__"}


def test_a_name_comes_from_where_the_type_checker_looks_for_it():
    tree = ast.parse((ROOT / "fem_seal" / "__init__.py").read_text(encoding="utf-8"))
    block = next(node for node in tree.body if isinstance(node, ast.If))
    typed = {
        alias.name: node.module for node in block.body for alias in node.names if node.module != "fem_seal"
    }
    assert typed == fem_seal._HOME


def test_importing_the_package_loads_nothing_heavy():
    code = "import sys, fem_seal; print(sorted({'numpy', 'scipy', 'pydantic'} & set(sys.modules)))"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stdout.strip() == "[]"
