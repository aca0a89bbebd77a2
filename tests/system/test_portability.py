"""What only one system knows stands behind a guard, and text files are UTF-8 everywhere."""

import ast
import io
import os
import re
import subprocess
import sys
from functools import cache
from itertools import chain

import pytest
from places import ROOT

PRODUCT = sorted(
    path for package in ("fem_seal", "leak", "meshes") for path in (ROOT / package).rglob("*.py")
)
OTHERS = sorted(path for folder in ("docs", "examples") for path in (ROOT / folder).rglob("*.py"))

# Modules and names that Python has on Unix only, from "Availability" in its library reference.
UNIX_MODULES = {"fcntl", "grp", "posix", "pty", "pwd", "resource", "syslog", "termios", "tty"}
_OF_OS = """chown chroot ctermid fchdir fchmod fchown fork forkpty getegid geteuid getgid getgroups getloadavg
getpgid getpgrp getpriority getsid getuid initgroups kill killpg lchown link lockf major makedev minor
mkfifo mknod nice openpty posix_fadvise posix_fallocate posix_spawn pread preadv pwrite readlink
sched_getaffinity sched_setaffinity sched_yield sendfile setegid seteuid setgid setgroups setpgid
setpriority setsid setuid statvfs symlink sync sysconf tcgetpgrp ttyname uname wait wait3 wait4 waitid
waitpid WEXITSTATUS WIFEXITED WIFSIGNALED WTERMSIG O_CLOEXEC O_DIRECTORY O_NOFOLLOW O_NONBLOCK O_SYNC"""
_OF_SIGNAL = """SIGALRM SIGBUS SIGCHLD SIGCONT SIGHUP SIGKILL SIGPIPE SIGQUIT SIGSTOP SIGTSTP SIGUSR1 SIGUSR2 SIGWINCH
alarm getitimer pause pthread_kill pthread_sigmask setitimer siginterrupt sigpending sigwait sigwaitinfo
sigtimedwait ITIMER_REAL SIG_BLOCK SIG_SETMASK SIG_UNBLOCK"""
UNIX_NAMES = {
    "os": _OF_OS.split(),
    "signal": _OF_SIGNAL.split(),
    "errno": ["EDQUOT"],
    "socket": ["AF_UNIX", "socketpair"],
    "time": ["tzset", "clock_gettime", "CLOCK_MONOTONIC"],
    "asyncio": ["open_unix_connection", "start_unix_server"],
}


@cache
def tree_of(path):
    return ast.parse(text_of(path))


@cache
def text_of(path):
    return path.read_text(encoding="utf-8")


# Where a text has none of these words, its tree need not be searched.
MODULES_WITH_UNIX_NAMES = "|".join(UNIX_NAMES)
OF_UNIX = re.compile(
    rf"\b(?:{'|'.join(UNIX_MODULES)})\b"
    rf"|\bfrom\s+(?:{MODULES_WITH_UNIX_NAMES})\s+import\b"
    rf"|\b(?:{MODULES_WITH_UNIX_NAMES})\s*\.\s*(?:{'|'.join(chain.from_iterable(UNIX_NAMES.values()))})\b"
)


def nodes_with_parents(tree):
    """Every node with the one that it stands in, that with the one that it stands in, and so on."""
    waiting = [(tree, None)]
    while waiting:
        node, above = waiting.pop()
        yield node, above
        waiting += [(child, (node, above)) for child in ast.iter_child_nodes(node)]


def asks_for_the_system(node):
    """Whether an expression asks which system this is, or whether a module has a name."""
    return any(
        (isinstance(part, ast.Attribute) and ast.unparse(part) in ("sys.platform", "os.name"))
        or (isinstance(part, ast.Call) and ast.unparse(part.func) == "hasattr")
        for part in ast.walk(node)
    )


def is_guarded(above):
    """Whether code stands in a branch of such a question, or in a function that leaves on one before."""
    while above:
        node, above = above
        if isinstance(node, (ast.If, ast.IfExp)) and asks_for_the_system(node.test):
            return True
        if isinstance(node, ast.FunctionDef):
            for statement in node.body:
                leaves = isinstance(statement, ast.If) and isinstance(
                    statement.body[-1], (ast.Return, ast.Raise)
                )
                if leaves and asks_for_the_system(statement.test):
                    return True
    return False


def calls_of_unix(tree):
    """What only Unix has, each with whether it is guarded."""
    for node, above in nodes_with_parents(tree):
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            module = getattr(node, "module", None)
            names = [module] if module else [alias.name for alias in node.names]
            found = [name for name in names if name in UNIX_MODULES]
            if module in UNIX_NAMES:
                found += [alias.name for alias in node.names if alias.name in UNIX_NAMES[module]]
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            found = [ast.unparse(node)] if node.attr in UNIX_NAMES.get(node.value.id, ()) else []
        else:
            continue
        for name in found:
            yield name, node.lineno, is_guarded(above)


def test_what_only_unix_has_is_guarded():
    found = [
        (f"{path.relative_to(ROOT)}:{line}: {name}", guarded)
        for path in PRODUCT
        if OF_UNIX.search(text_of(path))
        for name, line, guarded in calls_of_unix(tree_of(path))
    ]
    assert [place for place, guarded in found if not guarded] == []
    # the lock of a results folder, what a process may use of the machine, and what ends one that hangs
    assert {place.rpartition(" ")[2] for place, _ in found} >= {
        "fcntl",
        "os.sched_getaffinity",
        "signal.setitimer",
    }


@pytest.mark.parametrize(
    ("code", "guarded"),
    [
        ("import fcntl", False),
        ("from os import fork", False),
        ("import os\nos.kill(1, 9)", False),
        ("import sys\nif sys.platform != 'win32':\n    import fcntl", True),
        ("import os\nn = len(os.sched_getaffinity(0)) if hasattr(os, 'sched_getaffinity') else 1", True),
        ("def f():\n    if sys.platform == 'win32':\n        return 1\n    return os.getuid()", True),
        ("def f():\n    if tired:\n        return 1\n    return os.getuid()", False),
    ],
)
def test_the_search_tells_guarded_from_unguarded(code, guarded):
    assert OF_UNIX.search(code)
    ((_, _, found),) = calls_of_unix(ast.parse(code))
    assert found == guarded


# --- text -------------------------------------------------------------------------------------------------


OF_PATHS, WRAPPING = ("read_text", "write_text"), ("TextIOWrapper", "NamedTemporaryFile", "fdopen")
OPENING = ("open", *OF_PATHS, *WRAPPING)
# Where a text has none of these words, its tree need not be searched.
OF_TEXT = re.compile(rf"\b(?:{'|'.join(OPENING)}|(?:text|universal_newlines)\s*=)")


def text_files_without_encoding(tree):
    """Calls that read or write text in whatever encoding the system prefers."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        given = {keyword.arg for keyword in node.keywords}
        as_text = bool({"text", "universal_newlines"} & given)
        if "encoding" in given or not (name in OPENING or as_text):
            continue
        owner = ast.unparse(node.func.value) if isinstance(node.func, ast.Attribute) else ""
        words = [
            one.value for one in [*node.args, *(keyword.value for keyword in node.keywords)] if is_text(one)
        ]
        binary = any(re.fullmatch(r"[rwxab+]*b[rwxab+]*", word) for word in words)
        # what a distribution says of itself is UTF-8 everywhere
        if owner.startswith("metadata.distribution"):
            continue
        if owner and name in OF_PATHS:
            yield node.lineno, ast.unparse(node)
            continue
        # what is opened is a file if it is a built-in or a method of a path, not of a module or class
        modules = ("os", "gmsh", "webbrowser", "zipfile", "tarfile")
        is_file = owner.split(".")[-1][:1].islower() and owner.split(".")[0] not in modules if owner else True
        opens = name == "open" and is_file
        wraps = name in WRAPPING
        reads_process = owner == "subprocess" and as_text
        if ((opens or wraps) and not binary) or reads_process:
            yield node.lineno, ast.unparse(node)


def is_text(node):
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def test_text_files_are_utf_8_whatever_the_system_prefers():
    found = [
        f"{path.relative_to(ROOT)}:{line}: {call}"
        for path in (*PRODUCT, *OTHERS)
        if OF_TEXT.search(text_of(path))
        for line, call in text_files_without_encoding(tree_of(path))
    ]
    assert found == []


@pytest.mark.parametrize(
    ("code", "wrong"),
    [
        ("open('a')", True),
        ("open('a', 'rb')", False),
        ("path.open()", True),
        ("path.open('w', encoding='utf-8')", False),
        ("Path('a').read_text()", True),
        ("read_text(path)", False),
        ("Store.open(path)", False),
        ("subprocess.run(a, text=True)", True),
    ],
)
def test_the_search_knows_text_from_bytes(code, wrong):
    assert OF_TEXT.search(code)
    assert bool(list(text_files_without_encoding(ast.parse(code)))) == wrong


def test_output_into_a_pipe_of_another_encoding_ends_in_no_error():
    # what Windows gives a pipe
    environment = {**os.environ, "PYTHONIOENCODING": "cp1252"}
    code = "from fem_seal.__main__ import _write_every_sign; _write_every_sign(); print('1·10⁻⁶')"
    for arguments, said in ((["-c", code], b"1\xb710??"), (["-m", "fem_seal", "materials"], b"stellite 6")):
        done = subprocess.run(
            [sys.executable, *arguments], capture_output=True, env=environment, timeout=60, check=False
        )
        assert (done.returncode, done.stderr) == (0, b"")
        assert said in done.stdout


def test_output_that_lacks_signs_becomes_utf_8(monkeypatch):
    from fem_seal.__main__ import _write_every_sign

    monkeypatch.delenv("PYTHONIOENCODING", raising=False)
    raw = io.BytesIO()
    for name in ("stdout", "stderr"):
        monkeypatch.setattr(sys, name, io.TextIOWrapper(raw, encoding="cp1252"))
    _write_every_sign()
    print("10⁻⁶", flush=True)
    assert raw.getvalue().decode("utf-8") == "10⁻⁶" + os.linesep


# --- citation ---------------------------------------------------------------------------------------------


def test_the_citation_says_the_same_everywhere(capsys):
    import fem_seal
    from fem_seal.cli import app as cli

    yaml = pytest.importorskip("yaml")
    cff = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert cff["cff-version"] == "1.2.0" and cff["message"]
    assert str(cff["version"]) == fem_seal.__version__
    assert cli.main(["--cite"]) == 0
    said = capsys.readouterr().out
    assert cff["title"] in said and f"fem-seal {fem_seal.__version__}" in said
    (paper,) = cff["references"]
    for text in (paper["title"], paper["journal"], str(paper["year"]), paper["identifiers"][0]["value"]):
        assert text in said
    for author in paper["authors"]:
        assert f"{author['family-names']}, {author['given-names']}" in said
    # braces balance, or BibTeX reads on to the end of the file
    assert said.count("{") == said.count("}") and said.count("@") == 2
