"""Warnings of an optimum: limits violated with new particles, and limits of a meaningless stress."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.cli import optimum_warnings
from seal_mdao.cli.arguments import print_design_warnings
from seal_mdao.cli.optimum_warnings import meaningless_limits, violated_anew
from seal_mdao.measures.stress import LargestVonMises, VonMises

LIMITS = {
    "cld_5": {"unit": "N/m", "end": 38.4003, "lower": 38.4, "upper": 43.5},
    "von_mises": {"unit": "kPa", "end": 1199.63, "lower": None, "upper": 1200.0},
}


def test_violated_limits_are_named_with_what_to_do():
    anew = {"cld_5": np.array([37.3875]), "von_mises": np.array([2025.32])}
    (text,) = violated_anew(LIMITS, anew)
    assert "37.39 N/m is below its limit 38.4 by 2.6%" in text
    assert "2025 kPa is above its limit 1200 by 68.8%" in text
    assert "smaller spacing" in text


@pytest.mark.parametrize("anew", [
    None, {}, {"cld_5": np.array([38.1]), "von_mises": np.array([1209.0])},
    {"cld_5": np.array([43.6]), "von_mises": np.array([1.0, 1e4])},
])  # fmt: skip
def test_changes_within_one_per_cent_are_no_violation(anew):
    assert violated_anew(LIMITS, anew) == []


def test_a_limit_violated_already_is_no_matter_of_particles():
    limits = {"von_mises": LIMITS["von_mises"] | {"end": 1900.0}}
    assert violated_anew(limits, {"von_mises": np.array([2025.32])}) == []


@pytest.fixture(scope="module")
def pressed():
    return sm.analyze(sm.door_seal(door="flat", depth=2.0, n_steps=8))


@pytest.mark.parametrize("kind", [LargestVonMises, VonMises])
def test_a_stress_limited_where_it_is_meaningless_is_reported(pressed, monkeypatch, kind):
    measure = kind() if kind is LargestVonMises else kind().frozen(pressed)
    places = pressed.seal.body.samples.at(pressed.particles)
    if kind is VonMises:
        places = pressed.particles[list(measure.points)]
        stress = pressed.value(measure)
    else:
        stress = pressed.section_stress()[1]
        places = pressed.section_stress()[0]
    peak = places[stress.argmax()]

    def found_at(place):
        monkeypatch.setattr(
            optimum_warnings, "findings", lambda path: [SimpleNamespace(place=np.array(place))]
        )
        gap = next(own for own in pressed.seal.standard if own.name == "gap_square_sum")
        return meaningless_limits(pressed, [gap, measure])

    (text,) = found_at(peak)
    assert "a point at which the stress is meaningless" in text
    assert found_at(-peak + (0.0, 30.0)) == []
    assert meaningless_limits(replace(pressed, path=replace(pressed.path, steps=())), []) == []


def test_warnings_of_both_designs_are_printed_once(capsys):
    first, last = (SimpleNamespace(warnings=own) for own in (("thin", "steep"), ("thin", "folded")))
    print_design_warnings(first, last, ["a limit is violated"])
    assert capsys.readouterr().out.splitlines() == [
        "WARNING: thin", "WARNING (first design): steep", "WARNING (last design): folded",
        "WARNING (last design): a limit is violated",
    ]  # fmt: skip
