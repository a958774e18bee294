"""Scenarios of a seal file: placement of its profile, and what wrong scenarios report."""

import numpy as np
import openmdao.api as om
import pytest
from seal_file.block_files import DESIGN, FIXED, LID, MEASURES, MOVED, seal_of

import seal_mdao as sm
from seal_mdao.components.scenario_comp import ScenarioComp

VARIED = (sm.Variation("lid_friction"), sm.Variation("lid_y", "shift"))
NUMBERS = [[0.1, 0.0], [0.3, -0.1]]


@pytest.fixture(scope="module")
def lid(tmp_path_factory):
    return seal_of(tmp_path_factory.mktemp("lid"), FIXED, DESIGN, LID, spacing=1.3)


def ran(seal, kind=sm.ScenarioGroup, variations=VARIED, numbers=NUMBERS, **options):
    """A problem with scenarios of a seal, run once."""
    made = om.Problem(reports=None)
    scenarios = sm.Scenarios(variations, np.array(numbers))
    options = {"parameters": ("lid_y",), "workers": 0} | options
    made.model.add_subsystem("seal", kind(seal=seal, scenarios=scenarios, **options))
    made.setup()
    made.run_model()
    return made


@pytest.mark.parametrize("kind", [sm.ScenarioGroup, ScenarioComp])
def test_placements_are_added_where_a_scenario_varies_one(lid, kind):
    assert "lid_y" not in lid.scalars
    of, wrt = ["seal.reaction_scenarios"], ["seal.lid_y", "seal.boundary_offsets"]
    found = []
    for seal in (lid, lid.with_placements()):
        made = ran(seal, kind)
        totals = made.compute_totals(of, wrt, return_format="array")
        found.append((made.get_val(of[0]).tobytes(), totals.tobytes()))
    assert found[0] == found[1]
    assert np.abs(totals[:, 0]).min() > 1.0


def test_seal_with_placements_is_in_the_settings(lid):
    """A report rebuilds the seal from them."""
    made = ran(lid, parameters=())
    assert made.model.seal.options["seal_settings"] == [lid.with_placements().settings()]
    # only where a scenario varies one
    made = ran(lid, variations=VARIED[:1], numbers=[[0.1], [0.2]], parameters=())
    assert made.model.seal.options["seal_settings"] == [lid.settings()]


def test_unknown_parameter_is_reported_with_those_of_the_placement(lid, tmp_path):
    wrong = {"variations": (sm.Variation("lid_z"),), "numbers": [[0.0]], "parameters": ()}
    with pytest.raises(
        ValueError, match=r"unknown parameter 'lid_z'; the parameters of the seal are .*, lid_y"
    ):
        ran(lid, **wrong)
    moved = seal_of(tmp_path, FIXED, DESIGN, MOVED, MEASURES)
    for seal in (moved, moved.with_placements()):
        with pytest.raises(
            ValueError, match=r"unknown parameter 'lid_z'; the parameters of the seal are .*, top_y"
        ):
            ran(seal, **wrong)


def test_input_that_every_scenario_replaces_is_refused(lid):
    text = "input 'lid_friction' would have no effect, since the variation 'grip' of kind 'value'"
    for kind in ("value", "shift"):
        grip = sm.Variation("grip", kind, ("lid_friction",))
        group = sm.ScenarioGroup(
            seal=lid, scenarios=sm.Scenarios((grip,), np.array([[0.1], [0.2]])), workers=0,
            parameters=("lid_friction",),
        )  # fmt: skip
        made = om.Problem(group, reports=None)
        if kind == "value":
            with pytest.raises(ValueError, match=text):
                made.setup()
        else:
            made.setup()


LEAK = """\
[[measure]]
type = "leak_rate"
rms_roughness = 150.0
roll_off_wavelength = 500.0
shortest_wavelength = 10.0
pressure = 30.0
"""


@pytest.mark.filterwarnings("error")
def test_scenario_without_contact_counts_as_failed_for_a_leak_rate(tmp_path):
    """Its leak rate is infinite, so that mean and deviation would be undefined."""
    seal = seal_of(tmp_path, FIXED, DESIGN, LID, LEAK, spacing=1.3)
    own = {
        "variations": (sm.Variation("lid_y", "shift"),), "numbers": [[0.0], [5.0], [-0.1]],
        "parameters": (), "measures": ("leak_rate", "reaction"),
    }  # fmt: skip
    with pytest.raises(
        om.AnalysisError, match=r"scenario 2 of 3 .*: the seal has lost contact, so "
    ):
        ran(seal, **own)
    found = ran(seal, failed="leave_out", **own)
    rows = found.get_val("seal.leak_rate_scenarios")
    assert np.isnan(rows[1]).all()
    left = rows[[0, 2], 0]
    assert found.get_val("seal.leak_rate_mean").item() == pytest.approx(left.mean(), rel=1e-14)
    assert found.get_val("seal.share_failed").item() == pytest.approx(1.0 / 3.0, rel=1e-15)
    totals = found.compute_totals(["seal.leak_rate_std"], ["seal.boundary_offsets"])
    assert np.isfinite([*totals.values()]).all()
    # without the leak rate the scenario is one of three
    assert np.isfinite(ran(seal, **own | {"measures": ("reaction",)}).get_val("seal.reaction_std"))
