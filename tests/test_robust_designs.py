"""The optima of the page on tolerances, on samples that the page has not seen."""

import json
from pathlib import Path

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.scenarios.running import usual_workers
from seal_mdao.tolerances.file import OF_THE_DOOR, read_tolerances
from seal_mdao.tolerances.placement import with_clearance
from seal_mdao.tolerances.tolerance_study import ToleranceStudy

FOUND = Path(__file__).parents[1] / "docs" / "benchmarks" / "tolerances.json"
SAMPLES, SEED = 64, 77


@pytest.fixture(scope="module")
def page():
    return json.loads(FOUND.read_text(encoding="utf-8"))


def gaps_and_forces(design, file):
    seal, tolerances = with_clearance(sm.door_seal(n_steps=53)), read_tolerances(OF_THE_DOOR)
    shape = np.array(design["boundary_offsets"]), {"door_radius": design["door_radius"]}
    study = ToleranceStudy(seal, tolerances, ("gap_square_integral", "reaction"), *shape)
    sampled = study.run(file, SAMPLES, seed=SEED, workers=usual_workers())
    assert sampled.completed.mean() > 0.95
    values = sampled.values[sampled.completed]
    return values[:, 0], values[:, 2]


@pytest.mark.release
def test_the_robust_optimum_is_better_on_cars_that_nobody_has_seen(page, tmp_path):
    gaps, forces = {}, {}
    for name, design in page["designs"].items():
        gaps[name], forces[name] = gaps_and_forces(design, tmp_path / f"{name}.sqlite")
    ends = {name: np.quantile(own, 0.95) for name, own in gaps.items()}
    assert ends["robust"] <= 0.5 * ends["nominal"]
    low, high = page["robust"]["reaction_band_N_per_m"]
    assert np.mean((forces["robust"] >= low) & (forces["robust"] <= high)) >= 0.95


def test_the_page_says_what_was_asked_for(page):
    compared = page["robust"]["compared"]
    ends = [
        compared[f"{name} optimum"]["gap_square_integral"]["q95"] for name in ("nominal", "robust")
    ]
    assert page["robust"]["samples"] == 1000
    assert ends[1] <= 0.5 * ends[0]
    assert page["robust"]["ratio_of_95_percent_gaps"] == pytest.approx(ends[1] / ends[0])
    assert compared["robust optimum"]["share_in_reaction_band"] >= 0.95
