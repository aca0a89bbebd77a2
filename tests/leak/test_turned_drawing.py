"""Interval of "turned Ra 0.4 um" against direct simulations of faces that fit it: `benchmarks/turned_drawing.py`."""

import csv
import math
from collections import Counter

import numpy as np
import pytest
import turned_drawing

import leak
from leak.surfaces.finish import process_named


def rows():
    return list(csv.DictReader(turned_drawing.TABLE.open(encoding="utf-8")))


def test_simulated_faces_are_those_of_the_drawing_within_its_ranges():
    turned = process_named("turned")
    for row in rows():
        texture = turned_drawing.texture(*turned_drawing.FACES[row["face"]])
        assert texture.Ra == pytest.approx(turned_drawing.RA, rel=1e-5)
        assert texture.feed == pytest.approx(float(row["feed_m"]), rel=1e-4)
        ratio = texture.fine.rms_height / texture.crest_height
        assert turned.fine_height.low < ratio < turned.fine_height.high
        low, high = turned.nose_radius.low, turned.nose_radius.high
        assert low * (1 - 1e-9) < texture.nose_radius < high * (1 + 1e-9)
        assert turned.rolloff.low < float(row["rolloff_m"]) < turned.rolloff.high
        assert turned.hurst.low < float(row["hurst"]) < turned.hurst.high


def test_one_simulated_face_comes_back():
    """At the lowest pressure, within the error of the theory."""
    row = rows()[0]
    crests = turned_drawing.texture(*turned_drawing.FACES[row["face"]])
    face = leak.TurnedContact(
        feed=crests.feed, nose_radius=crests.nose_radius, fine=crests.fine, **turned_drawing.METAL
    )
    p = float(row["pressure_Pa"])
    error = face.flow_error(p)
    deviation = (
        math.log(float(row["k_across_m3"]) / float(face.flow_conductivity(p, 1.0 / 12.0))) - error.bias
    )
    assert abs(deviation) < 3.0 * float(error.spread)


@pytest.mark.slow
def test_interval_of_a_drawing_holds_simulated_faces():
    held = Counter()
    for _, p, k, low, high in turned_drawing.held(64):
        held[p] += low <= k <= high
    assert all(held[p] >= 7 for p in turned_drawing.PRESSURES)
    # not by an interval without ends
    low, _, high = turned_drawing.interval(64)[0]
    assert high / low < 300.0


PAIRS = [
    (6.178672e-05, 3.1043016e-04, 0.294335, "50845.76 427572.9 3206572.3", 1.57067699e-26, 1.7434e-29),
    (5.70065e-05, 2.6398335e-04, 0.150053, "55109.376 108978.286 3619565.3", 2.54014e-25, 1.09753e-30),
]


@pytest.mark.parametrize(("feed", "nose_radius", "phase", "q", "low", "high"), PAIRS)
def test_pairs_of_crests_are_known_until_they_are_flat(feed, nose_radius, phase, q, low, high):
    """Samples of small noses: crests are as wide as their distance, and the gap of the last level is wider."""
    fine = leak.PowerSpectrum([float(one) for one in q.split()], [low, low, high])
    pair = {"feed": feed, "nose_radius": nose_radius, "other": leak.Cusps(feed, nose_radius), "phase": phase}
    face = leak.TurnedContact(**pair, fine=fine, effective_modulus=1.5e10 / 0.13, hardness=7.4e9)
    law = face.interface_law(plastic=True)
    gaps = law.gap(np.log(np.geomspace(1e6, 0.97 * face.contact_pressure, 60)))
    assert np.all(np.diff(gaps) < 0.0) and gaps[-1] > 0.0
