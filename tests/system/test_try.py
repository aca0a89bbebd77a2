"""The page that calculates in the browser: its numbers are those of the program."""

import json
import shutil
import sys
import threading
import time
from functools import partial
from http.server import ThreadingHTTPServer

import numpy as np
import pytest
from places import ROOT

sys.path.insert(0, str(ROOT / "docs" / "try"))

import make
import seal

import fem_seal
from fem_seal.answers.profile_files import ImportedProfile
from fem_seal.answers.profile_leak import leak_of_profiles
from fem_seal.seal.problem import SealProblem

INPUTS = {"parameter": "Ra", "value": 0.4e-6, "process": "lapped", "hardness": 330 * 9.80665e6 / 0.927}
INPUTS |= {"fluid": "water", "fluid_pressure": 20e5, "force": 100.0}


@pytest.mark.parametrize(("process", "fluid"), [("lapped", "water"), ("turned", "helium")])
def test_its_numbers_are_those_of_the_program(process, fluid):
    asked = seal.Seal(**INPUTS | {"process": process, "fluid": fluid})
    steel = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "hardness": f"{asked.hardness} Pa"}
    case = fem_seal.Case(
        closure={"shape": "ball", "radius": f"{asked.radius} m", "material": steel},
        seat={"shape": "cone", "angle": f"{asked.angle} rad", "material": steel},
        roughness={"seat": {"Ra": f"{asked.value} m", "process": process}},
        fluid={"name": fluid},
        load={"fluid_pressure": f"{asked.fluid_pressure} Pa", "applied_force": f"{asked.force} N"},
    )
    flow, line, _ = asked.leak_of(asked.finish.surface())
    (load,) = fem_seal.derive(case).loads
    assert asked.line_load == pytest.approx(load.line_load, rel=1e-12)
    assert line.peak_pressure == pytest.approx(load.crossover.peak_pressure, rel=1e-9)
    x = np.linspace(-seal.REACH, seal.REACH, seal.POINTS) * line.std
    radius = asked.contact_radius + x * np.cos(asked.angle)
    profile = ImportedProfile(x, line.pressure(x), radius, asked.fluid_pressure)
    (given,) = leak_of_profiles(SealProblem.of(case), [profile])
    # tables of conductivity are good to 3e-4, and these have other pressures
    assert flow.leak_rate == pytest.approx(given.leak.leak_rate, rel=1e-4)


def test_the_interval_holds_the_usual_surface(monkeypatch):
    monkeypatch.setattr(seal, "SURFACES", 3)
    first, *_, last = seal.answers(seal.Seal(**INPUTS))
    assert last["surfaces"] == 3
    assert last["low_m3_per_s"] < first["leak_rate_m3_per_s"] < last["high_m3_per_s"]


@pytest.mark.skipif(not (make.PAGE / "python.wasm").exists(), reason="needs the page of `make try`")
@pytest.mark.skipif(shutil.which("chromedriver") is None, reason="needs chromium and chromedriver")
def test_the_browser_gives_the_same_numbers():
    webdriver = pytest.importorskip("selenium.webdriver", reason="selenium drives the browser")
    make.make()
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(make.Files, directory=str(make.PAGE)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium") or shutil.which("google-chrome")
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage"):
        options.add_argument(argument)
    browser = webdriver.Chrome(options=options, service=webdriver.ChromeService(shutil.which("chromedriver")))
    try:
        browser.get(f"http://127.0.0.1:{server.server_port}")
        button = browser.find_element("css selector", "button")
        end = time.monotonic() + 180.0
        while not button.is_enabled() and time.monotonic() < end:
            time.sleep(0.2)
        button.click()
        while (found := browser.execute_script("return window.answer")) is None and time.monotonic() < end:
            time.sleep(0.2)
    finally:
        browser.quit()
        server.shutdown()
    expected = next(seal.answers(seal.Seal(**json.loads(json.dumps(INPUTS)))))
    names = ("leak_rate_m3_per_s", "peak_pressure_Pa", "width_m", "line_load_N_per_m")
    assert [found[name] for name in names] == pytest.approx([expected[name] for name in names], rel=1e-9)
