"""The stored ladder belongs to the seal files of today."""

import json
from pathlib import Path

import pytest
from benchmarks.ladder.estimates import estimated_errors
from benchmarks.ladder.rungs import RUNGS, timed, values_of

STORED = json.loads(
    (Path(__file__).parents[2] / "docs" / "benchmarks" / "ladder.json").read_text(encoding="utf-8")
)["rungs"]
SHOWN = 1e-4
"""The page shows differences with two decimals of one percent."""


def test_every_rung_is_stored_and_no_other():
    assert list(STORED) == list(RUNGS)


@pytest.mark.parametrize("name", RUNGS)
def test_stored_values_are_of_the_seal_file(name):
    """A changed seal file needs ``python -m tests.benchmarks.ladder NAME``."""
    rung, own = RUNGS[name], STORED[name]
    assert own["seal_file"] == rung.digest
    assert [row["spacing"] for row in own["particles"]] == list(rung.spacings)
    assert [row["size"] for row in own.get("elements", [])] == list(rung.sizes)
    assert [row["size"] for row in own.get("triangles", [])] == list(rung.triangles)
    for row in (*own["particles"], *own.get("elements", []), *own.get("triangles", [])):
        assert len(row["values"]) == len(rung.quantities)


def coarse_values_agree(name):
    rung, own = RUNGS[name], STORED[name]
    result, _ = timed(rung.seal(rung.spacings[0]))
    assert len(result.particles) == own["particles"][0]["particles"]
    assert values_of(rung, result) == pytest.approx(own["particles"][0]["values"], rel=SHOWN)


@pytest.mark.parametrize("name", [name for name, rung in RUNGS.items() if rung.quick])
def test_coarse_cloud_has_the_stored_values(name):
    coarse_values_agree(name)


@pytest.mark.release
@pytest.mark.parametrize("name", [name for name, rung in RUNGS.items() if not rung.quick])
def test_coarse_cloud_of_a_long_rung_has_the_stored_values(name):
    coarse_values_agree(name)


def test_stored_estimate_of_the_error():
    """That of the quickest rung: ``python -m tests.benchmarks.ladder.estimates``."""
    own = STORED["as568_214"]["particles"][0]
    ten, twenty = estimated_errors(RUNGS["as568_214"], own["spacing"])
    assert ten is own["estimated_error"][0] is None
    assert twenty == pytest.approx(own["estimated_error"][1], abs=0.5 * SHOWN)
