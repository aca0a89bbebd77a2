"""The recipes for clusters run as they stand in the manual, on a batch system that is two short scripts."""

from __future__ import annotations

import ast
import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pandas as pd
import pytest
from places import ROOT

from fem_seal import StudyResult, load_study

PAGE = (ROOT / "docs" / "guide" / "studies.md").read_text(encoding="utf-8")
STUDY = f"""
base = "{ROOT / "examples" / "ball_cone.toml"}"
responses = ["peak_pressure_Pa", "leak_rate_m3_per_s"]

[changes]
mesh.contact_size = "60 um"

[parameters]
roughness.spectrum.rms_height = ["1 um", "2 um"]
load.fluid_pressure = {{ start = "5 bar", stop = "20 bar", num = 8 }}
"""
# What a batch system does: it keeps the script, starts it somewhere, tells a number, and ends it when asked to.
SBATCH = """#!/bin/sh
kept=$(mktemp "$FAKE_SLURM/XXXXXX.sh") && cp "$1" "$kept"
setsid bash "$kept" > "$kept.log" 2>&1 &
echo "Submitted batch job $!"
"""
SCANCEL = """#!/bin/sh
echo "$1" >> "$FAKE_SLURM/cancelled"
kill -TERM -- "-$1"
"""
# What the workers of the recipe have, printed at its end.
ASK = """
import json, os
def about(dask_worker):
    names = ("MALLOC_TRIM_THRESHOLD_", "MALLOC_MMAP_THRESHOLD_")
    return [dask_worker.state.nthreads, *(os.environ.get(name) for name in names)]
print(json.dumps(list(Client(cluster).run(about).values())))
"""


def recipe(system: str) -> str:
    """Python of the recipe for a batch system."""
    (text,) = re.findall(rf"\*\*{system}\*\*.*?```python\n(.*?)```", PAGE, re.DOTALL)
    return text


@pytest.fixture
def slurm(tmp_path, monkeypatch):
    """Folder of a batch system."""
    pytest.importorskip("distributed")
    pytest.importorskip("dask_jobqueue", reason='needs dask-jobqueue: pip install "fem-seal[dev]"')
    if os.name != "posix":
        pytest.skip("the scripts are for a shell")
    for name, text in (("sbatch", SBATCH), ("scancel", SCANCEL)):
        script = tmp_path / "bin" / name
        script.parent.mkdir(exist_ok=True)
        script.write_text(text)
        script.chmod(0o755)
    jobs = tmp_path / "jobs"
    jobs.mkdir()
    monkeypatch.setenv("PATH", str(tmp_path / "bin"), prepend=os.pathsep)
    monkeypatch.setenv("PYTHONPATH", str(ROOT), prepend=os.pathsep)
    monkeypatch.setenv("FAKE_SLURM", str(jobs))
    return jobs


def test_the_job_of_the_slurm_recipe_asks_for_what_the_recipe_says(slurm, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    # all but what starts jobs
    parts = ast.parse(recipe("SLURM")).body
    names: dict[str, object] = {}
    exec(compile(ast.Module(parts[:-2], []), "recipe", "exec"), names)
    with names["cluster"] as cluster:
        script = cluster.job_script()
    lines = script.splitlines()
    # 32 GB are 29.8 GiB, which SLURM calls GB
    for line in ("-p normal", "-n 1", "--cpus-per-task=16", "--mem=30G", "-t 02:00:00"):
        assert f"#SBATCH {line}" in lines
    (command,) = [line for line in lines if "dask_worker" in line]
    for option in ("--nthreads 1", "--nworkers 16", "--nanny"):
        assert option in command
    for name in ("MALLOC_TRIM_THRESHOLD_", "MALLOC_MMAP_THRESHOLD_"):
        assert lines.index(f"export {name}=268435456") < lines.index(command)


def is_there(group: int) -> bool:
    """Whether anything of a job still runs."""
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


@pytest.mark.slow
def test_the_slurm_recipe_runs_a_study(slurm, tmp_path):
    (tmp_path / "STUDY.toml").write_text(STUDY)
    text = recipe("SLURM")
    # a node of one core
    for large, small in (("cores=16", "cores=1"), ("processes=16", "processes=1"), ("_jobs=4", "_jobs=1")):
        assert large in text
        text = text.replace(large, small)
    done = subprocess.run(
        [sys.executable, "-c", text + ASK], cwd=tmp_path, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr + "".join(log.read_text() for log in slurm.glob("*.log"))
    table = StudyResult(tmp_path / "results").table
    here = load_study(tmp_path / "STUDY.toml").run(workers=0, folder=tmp_path / "here").table
    pd.testing.assert_frame_equal(table, here, check_exact=True)
    assert (table["status"] == "done").all() and len(table) == 16
    for threads, *thresholds in json.loads(done.stdout):
        assert threads == 1
        assert thresholds == ["268435456", "268435456"]
    # the job is given back when the script ends
    (job,) = (slurm / "cancelled").read_text().split()
    assert len(list(slurm.glob("*.sh"))) == 1
    until = time.monotonic() + 30
    while is_there(int(job)) and time.monotonic() < until:
        time.sleep(0.1)
    assert not is_there(int(job))


@pytest.fixture
def pods(monkeypatch):
    """What the Kubernetes recipe asks for, and the operator that makes pods of it."""
    pytest.importorskip("distributed")
    reason = "needs dask-kubernetes, which brings some thirty packages: pip install dask-kubernetes"
    operator = pytest.importorskip("dask_kubernetes.operator", reason=reason)
    names: dict[str, object] = {}
    # all but what asks a cluster for it
    parts = ast.parse(recipe("Kubernetes")).body
    exec(compile(ast.Module(parts[:-2], []), "recipe", "exec"), names)
    return names["spec"], Path(operator.__file__).parent


def closed(schema):
    """A schema that refuses every key that it does not name, where Kubernetes would drop it without a word."""
    if isinstance(schema, list):
        return [closed(one) for one in schema]
    if not isinstance(schema, dict):
        return schema
    made = {key: closed(one) for key, one in schema.items()}
    if "properties" in schema and not schema.get("x-kubernetes-preserve-unknown-fields"):
        made.setdefault("additionalProperties", False)
    # either a number or a text, which JSON schema says in another way
    if schema.get("x-kubernetes-int-or-string"):
        made.pop("type", None)
    return made


def test_the_kubernetes_recipe_keeps_to_the_schema_of_the_operator(pods):
    spec, operator = pods
    jsonschema, yaml = pytest.importorskip("jsonschema"), pytest.importorskip("yaml")
    told = operator / "deployment" / "helm" / "dask-kubernetes-operator" / "crds" / "daskcluster.yaml"
    (version,) = yaml.safe_load(told.read_text(encoding="utf-8"))["spec"]["versions"]
    schema = closed(version["schema"]["openAPIV3Schema"])
    # every object of Kubernetes has these
    schema["properties"] |= {
        "apiVersion": {"const": "kubernetes.dask.org/v1"},
        "kind": {"const": "DaskCluster"},
    }
    schema["properties"] |= {"metadata": {"type": "object"}}
    # what is null Kubernetes takes for not given
    spec = json.loads(
        json.dumps(spec), object_hook=lambda one: {k: v for k, v in one.items() if v is not None}
    )
    jsonschema.validate(spec, schema)
    spec["spec"]["worker"]["spec"]["containers"][0]["comand"] = ["dask"]
    with pytest.raises(jsonschema.ValidationError, match="comand"):
        jsonschema.validate(spec, schema)


@pytest.mark.slow
def test_the_containers_of_the_kubernetes_recipe_run_a_study(pods, tmp_path):
    """Their commands as processes of this machine, with the environment that the operator gives them."""
    from urllib.request import urlopen

    from dask.distributed import Client
    from dask_kubernetes.operator.controller.controller import build_worker_deployment_spec

    spec, _ = pods
    name, address = spec["metadata"]["name"], "tcp://127.0.0.1:8786"
    worker = build_worker_deployment_spec(name, "default", name, "0", spec["spec"]["worker"]["spec"], {}, {})
    (tmp_path / "STUDY.toml").write_text(STUDY)
    started = []

    def start(pod) -> None:
        (container,) = pod["containers"]
        given = {one["name"]: one["value"] for one in container["env"]}
        if "DASK_SCHEDULER_ADDRESS" in given:
            assert (
                given["DASK_SCHEDULER_ADDRESS"] == "tcp://fem-seal-scheduler.default.svc.cluster.local:8786"
            )
            given["DASK_SCHEDULER_ADDRESS"] = address
        words = [
            re.sub(r"\$\((\w+)\)", lambda found: given[found[1]], word)
            for word in (*container["command"], *container["args"])
        ]
        path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
        environment = {**os.environ, **given, "PATH": path, "PYTHONPATH": str(ROOT)}
        started.append(subprocess.Popen(words, env=environment, cwd=tmp_path, start_new_session=True))

    try:
        start(spec["spec"]["scheduler"]["spec"])
        start(worker["spec"]["template"]["spec"])
        with Client(address, timeout=60) as client:
            client.wait_for_workers(1, timeout=60)
            # what Kubernetes asks before it sends anybody there
            (probe,) = (one["readinessProbe"] for one in spec["spec"]["scheduler"]["spec"]["containers"])
            assert urlopen(f"http://127.0.0.1:8787{probe['httpGet']['path']}", timeout=20).status == 200
            (about,) = client.scheduler_info(n_workers=-1)["workers"].values()
            assert (about["nthreads"], about["name"]) == (1, worker["metadata"]["name"])
            thresholds = client.run(lambda: os.environ["MALLOC_TRIM_THRESHOLD_"])
            assert list(thresholds.values()) == ["268435456"]
            table = load_study(tmp_path / "STUDY.toml").run(client, folder=tmp_path / "results").table
    finally:
        for process in started:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
    here = load_study(tmp_path / "STUDY.toml").run(workers=0, folder=tmp_path / "here").table
    pd.testing.assert_frame_equal(table, here, check_exact=True)
