"""The script that knows what the operating system has to have: what it finds missing, installs and says."""

import subprocess
import sys

import pytest
from places import ROOT

SCRIPT = ROOT / ".ci" / "system"
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the script does nothing but on Linux")

LIBRARIES = tuple(
    [
        "libGL.so.1",
        "libGLU.so.1",
        "libXcursor.so.1",
        "libXfixes.so.3",
        "libXft.so.2",
        "libXinerama.so.1",
        "libXrender.so.1",
        "libXext.so.6",
        "libX11.so.6",
        "libfontconfig.so.1",
        "libgomp.so.1",
    ]
)


@pytest.fixture
def machine(tmp_path):
    """A machine whose commands are stand-ins: `call(*arguments, user, libraries, python)`."""
    log = tmp_path / "log"

    def stand_in(name, body):
        path = tmp_path / name
        path.write_text(f"#!/bin/sh\n{body}\n", encoding="utf-8")
        path.chmod(0o755)

    def call(*arguments, user=1000, libraries=LIBRARIES, python="python3 3 11 venv", apt=True):
        listed = "\n".join(f"\t{name} (libc6,x86-64) => /usr/lib/{name}" for name in libraries)
        stand_in("ldconfig", f"cat << 'END'\n{listed}\nEND")
        stand_in("id", f"echo {user}")
        stand_in("uname", "echo Linux")
        for tool in ("tr", "basename", "cat"):
            stand_in(tool, f'exec /usr/bin/{tool} "$@"')
        if apt:
            stand_in("apt-get", f'echo "$@" >> {log}')
            stand_in("apt-cache", '[ "$2" = python3.12-venv ]')
        if python:
            # answers the two questions that the script asks: is it new enough, has it a venv, which version
            name, major, minor, *venv = python.split()
            new, has = (major, int(minor)) >= ("3", 11), bool(venv)
            stand_in(
                name,
                f'case "$2" in *version_info\\ \\<*) exit {0 if new else 1} ;; *ensurepip*) exit {0 if has else 1} ;; '
                f"*) echo python{major}.{minor}-venv ;; esac",
            )
        done = subprocess.run(
            ["/bin/sh", str(SCRIPT), *arguments],
            env={"PATH": str(tmp_path)},
            capture_output=True,
            text=True,
            encoding="utf-8",
            timeout=30,
            check=False,
        )
        return (
            done.returncode,
            done.stdout,
            done.stderr,
            log.read_text(encoding="utf-8") if log.exists() else "",
        )

    return call


def test_where_nothing_is_missing_nothing_is_done(machine):
    assert machine("program") == (0, "", "", "")


def test_root_installs_what_is_missing_and_nothing_else(machine):
    libraries = [name for name in LIBRARIES if name not in ("libGLU.so.1", "libXft.so.2")]
    code, _, said, calls = machine("program", user=0, libraries=libraries)
    assert code == 0
    assert "installing libglu1-mesa libxft2\n" in said
    assert calls.splitlines()[0].startswith("update")
    assert calls.splitlines()[1].endswith("--no-install-recommends libglu1-mesa libxft2")


def test_anybody_else_gets_the_one_command(machine):
    code, _, said, calls = machine("program", libraries=[], python="python3 3 11")
    assert (code, calls) == (1, "")
    (command,) = [line.strip() for line in said.splitlines() if "apt-get" in line]
    assert command.startswith("sudo apt-get install python3.11-venv libgl1 libglu1-mesa ")
    assert len(command.split()) == 3 + 1 + len(LIBRARIES)


def test_a_machine_without_python_or_with_an_old_one(machine, tmp_path):
    assert "install python3 python3-venv\n" in machine("program", python=None)[2]
    assert "install python3.12 python3.12-venv\n" in machine("program", python="python3 3 9 venv")[2]
    assert machine("python", python="python3.13 3 13 venv")[1] == "python3.13\n"


def test_elsewhere_than_on_debian_the_names_of_its_packages_say_what_is_missing(machine):
    code, _, said, _ = machine("program", libraries=[], apt=False)
    assert code == 1
    assert "by the names of Debian's packages: libgl1 " in said


@pytest.mark.parametrize(
    ("group", "packages"), [("browser", "chromium"), ("pictures", "libegl1 libgl1-mesa-dri")]
)
def test_what_only_some_tests_need_is_no_error(machine, group, packages):
    code, _, said, _ = machine(group)
    assert code == 0
    assert f"sudo apt-get install {packages}" in said and "left out" in said
    assert packages in machine(group, user=0)[3]


def test_a_group_that_is_none_is_an_error(machine):
    code, _, said, _ = machine("programme")
    assert code != 0 and "unknown group programme" in said
