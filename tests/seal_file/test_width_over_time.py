"""Contact widths on a path on which the modulus of the rubber changes: relaxation and temperature."""

import numpy as np
import pytest
from block_files import exact_seal, read
from quotients import quotients

import seal_mdao as sm
from seal_mdao.measures.contact_modulus import ContactModulus
from seal_mdao.seals.profiles import profile_histories

DISC = """\
{model}
[material.rubber]
law = "neo_hookean"
c10 = {c10}
bulk_modulus = 8000.0
{material}
[section]
material = "rubber"
spacing = 0.8
outer = [
  {{ edge = "foot", line = [[-4.0, 0.0], [4.0, 0.0]] }},
  {{ edge = "side", line = [[4.0, 0.0], [4.0, 3.0]] }},
  {{ edge = "head", arc = {{ start = [4.0, 3.0], through = [0.0, 7.0], end = [-4.0, 3.0] }} }},
  {{ edge = "back", line = [[-4.0, 3.0], [-4.0, 0.0]] }},
]
[fixed]
edges = ["foot"]
[[profile]]
name = "lid"
friction = 0.2
contact = ["head"]
normal_penalty = 2e4
tangent_penalty = 2e4
line = [[-40.0, 0.0], [40.0, 0.0]]
start = [0.0, 7.01]
stage = [{stages}]
[[measure]]
type = "contact_width"
"""
CLOSED = "{ translate = [0.0, -0.8], steps = 4, duration = 0.1 }"
DWELL = f"{CLOSED}, {{ steps = 4, duration = 1e4 }}"
SERIES = """\
[material.rubber.viscoelastic]
moduli = "{moduli}"
g = [0.4, 0.3]
tau = [1.0, 100.0]
"""
SHIFT = "arrhenius = { activation_energy = 40.0, reference = 23.0 }\n"
HOT = "[model]\ntemperature = [40.0, 60.0]"


def relaxing(moduli="long_term", c10=100.0, stages=DWELL, shift="", model="") -> str:
    series = SERIES.format(moduli=moduli) + shift
    return DISC.format(model=model, c10=c10, material=series, stages=stages)


def widths(result) -> np.ndarray:
    (history,) = profile_histories(result)
    return history.width


def test_width_does_not_depend_on_how_the_constants_are_stated(tmp_path):
    """Long-term moduli are 0.3 times the instantaneous ones."""
    given = relaxing(c10=60.0), relaxing("instantaneous", 200.0)
    one, other = (sm.analyze(exact_seal(tmp_path, own)) for own in given)
    assert one.contact_width == pytest.approx(other.contact_width, rel=1e-9)
    np.testing.assert_allclose(widths(one), widths(other), rtol=1e-9)
    assert widths(one)[-1] == pytest.approx(one.contact_width, rel=1e-12)


def test_width_hardly_changes_while_a_closed_seal_relaxes(tmp_path):
    """Pressures fall to 0.3 times those of the closed seal, and the gaps beside the contact are kept;
    with one modulus for the complete path the width falls by 16 %."""
    found = sm.analyze(exact_seal(tmp_path, relaxing(stages=DWELL.replace("-0.8", "-0.3"))))
    (history,) = profile_histories(found)
    # closed at the end of step 4, 1e4 s later at the end of step 8
    assert history.peak[7] / history.peak[3] < 0.4
    assert history.width[7] == pytest.approx(history.width[3], rel=0.015)


STEPS = {
    "g_1": 1e-4, "g_2": 1e-4, "tau_1": 1e-3, "tau_2": 1e-1, "time": 1e-1, "duration_1": 1e-4,
    "duration_2": 1e-1, "activation_energy": 1e-2, "temperature": 1e-2, "expansion": 1e-6, "c10": 1e-2,
}  # fmt: skip


@pytest.fixture(scope="module")
def unfinished(tmp_path_factory):
    """A seal whose rubber has not relaxed completely, at a temperature that changes: it shifts the times
    of relaxation, changes the moduli and expands the rubber."""
    given = relaxing(stages=f"{CLOSED}, {{ steps = 3, duration = 30.0 }}", shift=SHIFT, model=HOT)
    given = given.replace(
        "bulk_modulus = 8000.0\n",
        "bulk_modulus = 8000.0\nexpansion = 2e-4\n"
        "modulus_over_temperature = [[0.0, 1.1], [90.0, 0.6]]\n",
    )
    seal = exact_seal(tmp_path_factory.mktemp("width"), given)
    return seal, sm.differentiate(sm.analyze(seal, keep_factors=True), tuple(STEPS))


@pytest.mark.parametrize("name", STEPS)
def test_derivatives_of_the_width_include_those_of_the_relaxed_modulus(unfinished, name):
    seal, gradients = unfinished
    ((quotient, bound),) = quotients(seal, name, STEPS[name]).values()
    found = np.atleast_2d(gradients["contact_width"])[0, gradients.parameters.index(name)]
    assert abs(found) > 0.0
    assert abs(found - quotient.item()) <= max(bound.item(), 1e-9 * abs(found))
    assert bound.item() <= 1e-4 * abs(found)


@pytest.mark.parametrize("kept", [1, 2])
def test_width_on_the_path_is_that_of_a_path_which_ends_there(tmp_path, kept):
    """The modulus at the end of the path is half of that at the end of the first stage."""
    factors = "modulus_over_temperature = [[0.0, 1.1], [23.0, 1.0], [90.0, 0.5]]"
    stages = [CLOSED.replace(", duration = 0.1", ""), "{ steps = 2 }"]
    temperatures = [23.0, 90.0]
    complete, cut = (
        sm.analyze(
            sm.build_seal(
                read(
                    tmp_path,
                    DISC.format(
                        model=f"[model]\ntemperature = {temperatures[:count]}",
                        c10=100.0, material=factors, stages=", ".join(stages[:count]),
                    ),
                )
            )
        )
        for count in (2, kept)
    )  # fmt: skip
    steps = len(widths(cut))
    np.testing.assert_allclose(widths(complete)[:steps], widths(cut), rtol=1e-12)
    assert cut.contact_width == pytest.approx(widths(complete)[steps - 1], rel=1e-12)


def test_modulus_in_contact_is_the_relaxation_function(tmp_path):
    """4 G of long-term constants c10, G = 2 c10, at the end and after the first step of 0.025 s."""
    stages = "{ translate = [0.0, -0.8], steps = 4, duration = 0.1 }, { steps = 2, duration = 5.0 }"
    modulus = ContactModulus(sm.analyze(exact_seal(tmp_path, relaxing(stages=stages))), "lid")
    for fraction, time in ((1.0, 0.025), (6.0, 5.1)):
        relaxed = 1.0 + (0.4 * np.exp(-time) + 0.3 * np.exp(-time / 100.0)) / 0.3
        np.testing.assert_allclose(modulus.after(fraction), 800.0 * relaxed, rtol=1e-12)
    np.testing.assert_array_equal(modulus.values, modulus.after(6.0))


def test_seal_without_design_parameters_has_empty_gradients(unfinished):
    """Without names of parameters, derivatives are those in the design, of which there are none."""
    seal, _ = unfinished
    result = sm.analyze(seal, keep_factors=True)
    for method in ("direct", "adjoint"):
        assert sm.differentiate(result, method=method)["contact_width"].size == 0
