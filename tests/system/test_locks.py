"""The lists of tested versions hold what the program asks for, and the light one all that a run loads."""

import subprocess
import sys
import tomllib

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from places import EXAMPLES, ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
NEEDED = [Requirement(text) for text in PROJECT["dependencies"]]
EXTRAS = [Requirement(text) for texts in PROJECT["optional-dependencies"].values() for text in texts]
LEFT_OUT = set((ROOT / "locks" / "left_out.txt").read_text(encoding="utf-8").split())


def locked(name):
    """Requirement of each line of a list; there may be several of a package, for different versions of Python."""
    return [Requirement(line) for line in (ROOT / "locks" / name).read_text(encoding="utf-8").splitlines()]


def names(requirements):
    return {canonicalize_name(requirement.name) for requirement in requirements}


def test_every_package_has_a_version_that_the_program_allows():
    versions = locked("all.txt")
    asked = [one for one in (*NEEDED, *EXTRAS) if one.name != "fem-seal"]
    assert names(asked) <= names(versions)
    for requirement in asked:
        for one in versions:
            if canonicalize_name(one.name) == canonicalize_name(requirement.name):
                (version,) = one.specifier
                assert requirement.specifier.contains(version.version), (requirement, one)


def test_the_light_list_is_the_same_without_what_is_left_out():
    assert {str(one) for one in locked("light.txt")} <= {str(one) for one in locked("all.txt")}
    assert names(NEEDED) - names(locked("light.txt")) == LEFT_OUT
    # what they alone would bring is not there either
    assert "vtk" in names(locked("all.txt")) - names(locked("light.txt"))


@pytest.mark.slow
def test_a_run_needs_nothing_that_is_left_out(tmp_path):
    code = (
        f"import sys; sys.modules.update(dict.fromkeys({sorted(LEFT_OUT | {'vtk', 'vtkmodules'})}));"
        "from fem_seal.__main__ import main; sys.exit(main())"
    )
    for name in ("ball_cone", "oval_seat"):
        done = subprocess.run(
            [sys.executable, "-c", code, "run", EXAMPLES / f"{name}.toml", "-o", tmp_path / name],
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )
        assert done.returncode == 0 and "report.html: could not" not in done.stderr
        assert (tmp_path / name / "report.html").stat().st_size > 10_000
