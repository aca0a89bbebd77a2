"""Build the wheel, install it into a fresh environment, and run the example from it, outside the checkout.

The fresh environment borrows the dependencies of the interpreter that runs this script and nothing else: the editable
install of the checkout is not seen there, so that a package or a template missing from the wheel is missed.

`python tests/wheel.py python3.12 python3.13` also does it in empty environments of other interpreters, with everything
from the index: the wheel with all dependencies, and the source distribution with those alone that a run needs.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import time
import venv
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("fem_seal", "leak", "meshes")


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        source = copied(place / "source")
        wheel = built(source, place / "dist")
        complete(wheel, source)
        python = installed(wheel, place / "venv")
        run_example(python, place / "work")
        for name in sys.argv[1:]:
            from_index(name, source, place / Path(name).name)


def from_index(name: str, source: Path, place: Path) -> None:
    """Wheel and source distribution in environments of an interpreter that hold nothing else."""
    maker = empty(name, place / "maker")
    call(str(maker), "-m", "pip", "install", "--quiet", "build")
    call(str(maker), "-m", "build", "--outdir", str(place / "dist"), str(source), quiet=True)
    light = ["--no-deps", "--requirement", str(ROOT / "locks" / "light.txt")]
    for kind, end, options in (("all dependencies", ".whl", []), ("a light installation", ".tar.gz", light)):
        (distribution,) = (place / "dist").glob(f"*{end}")
        python = empty(name, place / end)
        start = time.monotonic()
        call(str(python), "-m", "pip", "install", "--quiet", *options, str(distribution))
        seconds = time.monotonic() - start
        files = [path for path in (place / end).rglob("*") if path.is_file() and not path.is_symlink()]
        size = sum(path.stat().st_size for path in files if "pip" not in path.parts) / 1e6
        print(f"{Path(name).name}, {distribution.name}, {kind}: {size:.0f} MB in {seconds:.0f} s", flush=True)
        run_example(python, place / f"work{end}")
        shutil.rmtree(place / end)


def empty(name: str, folder: Path) -> Path:
    """Python of an environment without packages."""
    call(name, "-m", "venv", str(folder))
    return folder / "bin" / "python"


def built(source: Path, folder: Path) -> Path:
    """The wheel of a checkout."""
    call(
        sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", str(folder), str(source)
    )
    (wheel,) = folder.glob("fem_seal-*.whl")
    return wheel


def copied(folder: Path) -> Path:
    """What the wheel is made of, without anything that an earlier build has left behind."""
    folder.mkdir()
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, folder)
    for package in PACKAGES:
        shutil.copytree(ROOT / package, folder / package, ignore=shutil.ignore_patterns("__pycache__"))
    return folder


def complete(wheel: Path, source: Path) -> None:
    """SystemExit unless the wheel holds every module, template and mark of typed packages, and nothing else."""
    with zipfile.ZipFile(wheel) as archive:
        found = {name for name in archive.namelist() if ".dist-info/" not in name}
    files = {
        path.relative_to(source).as_posix()
        for package in PACKAGES
        for path in (source / package).rglob("*")
        if path.is_file()
    }
    if found != files:
        sys.exit(f"the wheel lacks {sorted(files - found)} and holds {sorted(found - files)} besides")
    print(f"{wheel.name}: all {len(files)} files of {', '.join(PACKAGES)}")


def installed(wheel: Path, folder: Path) -> Path:
    """Python of a fresh environment with the wheel, beside the dependencies of this interpreter."""
    venv.create(folder, with_pip=False)
    python = folder / "bin" / "python"
    call(sys.executable, "-m", "pip", "--python", str(python), "install", "--quiet", "--no-deps", str(wheel))
    site = Path(output(python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))", cwd=folder))
    # a plain path: the .pth files of that folder, which hold the editable install, are not read from here
    (site / "dependencies.pth").write_text(sysconfig.get_path("purelib") + "\n", encoding="utf-8")
    return python


def run_example(python: Path, folder: Path) -> None:
    """Solve the example from the wheel, in a folder that has nothing to do with the checkout."""
    folder.mkdir()
    case = folder / "ball_cone.toml"
    case.write_bytes((ROOT / "examples" / "ball_cone.toml").read_bytes())
    for package in PACKAGES:
        place = Path(output(python, "-c", f"import {package}; print({package}.__file__)", cwd=folder))
        if ROOT in place.parents or python.parent.parent not in place.parents:
            sys.exit(f"{package} comes from {place}, not from the wheel")
    program = python.parent / "fem-seal"
    call(str(program), "run", "--quiet", str(case), cwd=folder)
    results = folder / "ball_cone.out"
    missing = [
        name
        for name in ("leak.csv", "profile.csv", "summary.json", "report.html", "mesh.msh")
        if not (results / name).stat().st_size
    ]
    if missing:
        sys.exit(f"the example wrote no {', '.join(missing)}")
    print("the example runs from the wheel")


def call(*command: str, cwd: Path | None = None, quiet: bool = False) -> None:
    subprocess.run(command, check=True, cwd=cwd, env=_clean(), stdout=subprocess.DEVNULL if quiet else None)


def output(python: Path, *arguments: str, cwd: Path) -> str:
    done = subprocess.run(
        [str(python), *arguments], check=True, cwd=cwd, env=_clean(), capture_output=True, text=True
    )
    return done.stdout.strip()


def _clean() -> dict[str, str]:
    """The environment variables without those that could bring the checkout in."""
    return {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}


if __name__ == "__main__":
    main()
