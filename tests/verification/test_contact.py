"""Contact and friction where the exact answer is known."""

import numpy as np
import pytest

from seal_mdao.contact.friction import OPEN, SLIP
from verification.contact_patch import pressed, slid
from verification.hertz import press_cylinder
from verification.sliding import drag_block, pull_belt
from verification.tolerances import TOLERANCES


@pytest.fixture(scope="module")
def hertz():
    """The cylinder on two meshes with 7 and 13 points in contact."""
    return [press_cylinder(n) for n in (4, 8)]


def hertz_errors(figure, meshes):
    """Relative errors of half-width and peak on every mesh; those on the last one are small."""
    widths, peaks = [], []
    for contact in meshes:
        widths.append(abs(contact.half_width / contact.exact_half_width - 1.0))
        peaks.append(abs(contact.peak / contact.exact_peak - 1.0))
    for contact, width, peak in zip(meshes, widths, peaks, strict=True):
        name = f"Hertz line contact, {len(contact.x)} points: "
        figure(name + "half-width", width, TOLERANCES["hertz"])
        figure(name + "peak pressure", peak, TOLERANCES["hertz"])
    return widths, peaks


def test_hertz_line_contact(figure, hertz):
    assert [len(contact.x) for contact in hertz] == [7, 13]
    widths, peaks = hertz_errors(figure, hertz)
    assert widths[1] < 0.5 * widths[0]
    assert peaks[1] < 0.25 * peaks[0]


@pytest.mark.long
def test_hertz_line_contact_on_a_fine_mesh(figure, hertz):
    """Converging until about 0.1 % is left, which no longer depends on the mesh."""
    widths, peaks = hertz_errors(figure, [*hertz, press_cylinder(12)])
    assert widths[2] < 0.5 * widths[1]
    assert peaks[2] < 0.25 * peaks[0]


def test_hertz_pressure_is_the_ellipse(figure, hertz):
    contact = hertz[-1]
    inside = np.abs(contact.x) < 0.9 * contact.exact_half_width
    ellipse = np.sqrt(1.0 - (contact.x[inside] / contact.exact_half_width) ** 2)
    error = contact.pressure[inside] / contact.exact_peak - ellipse
    worst = np.abs(error).max()
    figure("Hertz line contact: pressure on 90 % of the width", worst, TOLERANCES["hertz"])


def test_dragged_block_slides_at_mu_times_the_normal_force(figure):
    block = drag_block(friction=0.3)
    right = block.slipping & (block.travel > 0.2) & (np.arange(45) < 15)
    left = block.slipping & (block.travel < 0.0)
    assert right.sum() >= 4
    assert left.sum() >= 10
    forwards = np.abs(block.ratio[right] / -0.3 - 1.0).max()
    backwards = np.abs(block.ratio[left] / 0.3 - 1.0).max()
    base = np.abs(block.base_ratio - block.ratio).max()
    figure("dragged block, forwards: T/N over mu", forwards, TOLERANCES["drag"])
    figure("dragged block, backwards: T/N over mu", backwards, TOLERANCES["drag"])
    figure("dragged block: ratio at the base", base, TOLERANCES["drag_base"])
    stuck = ~block.slipping
    assert stuck.sum() > 5
    assert np.all(np.abs(block.ratio[stuck]) < 0.3)


def thickness_correction(belt):
    """Relative error of the exponent with the offset of the friction from the belt's axis."""
    return abs(belt.exponent / belt.exact * (1.0 + 0.5 * belt.thickness) - 1.0)


def test_belt_on_a_cylinder_follows_the_capstan_law(figure):
    belt = pull_belt(0.3, thickness=0.2, cells=72)
    assert belt.slipping
    away, limit = thickness_correction(belt), TOLERANCES["belt_corrected"]
    figure("belt on a cylinder, t/R = 0.02: thickness correction", away, limit)


@pytest.mark.long
def test_thin_belts_converge_to_the_capstan_law(figure):
    thick, thin = pull_belt(0.3, thickness=0.2, cells=72), pull_belt(0.3, thickness=0.1, cells=144)
    assert thick.slipping
    assert thin.slipping
    for belt in (thick, thin):
        # the pull turns by less than pi: the ends lean outward, by no more than a thickness over R
        assert 0.0 < np.pi - belt.wrap < belt.thickness
    ratios = [belt.exponent / belt.exact for belt in (thick, thin)]
    name = "belt on a cylinder, {}: exponent over mu * angle"
    figure(name.format("t/R = 0.01"), abs(ratios[1] - 1.0), TOLERANCES["belt"])
    # the offset of the friction from the belt's axis is linear in the thickness
    limit = 2.0 * ratios[1] - ratios[0]
    figure(name.format("t -> 0"), abs(limit - 1.0), TOLERANCES["belt_limit"])
    away = thickness_correction(thin)
    figure("belt on a cylinder: thickness correction", away, TOLERANCES["belt_corrected"])


@pytest.mark.parametrize("basis_order", [1, 2])
@pytest.mark.parametrize("share", [0.0, 0.25], ids=["even", "uneven"])
def test_contact_patch_test(figure, share, basis_order):
    """Uniform pressure below a smooth plate, with a plane of symmetry and a free end."""
    patch = pressed("averages", share, basis_order)
    figure(f"contact patch test, order {basis_order}", patch.deviation, TOLERANCES["patch"])
    # what contact at the particles leaves
    assert pressed("particles", share, basis_order).deviation > 0.1


@pytest.mark.parametrize("basis_order", [1, 2])
@pytest.mark.parametrize("share", [0.0, 0.25], ids=["even", "uneven"])
def test_contact_patch_test_with_free_sides(figure, share, basis_order):
    """The plate may touch both sides of the block: of the two points of a corner one is pressed."""
    alone, patch = (pressed("averages", share, basis_order, sides=own) for own in (False, True))
    assert (patch.state != OPEN).sum() == len(alone.pressure)
    name = f"contact patch test with free sides, order {basis_order}"
    figure(name, patch.deviation, TOLERANCES["patch"])
    assert patch.pressure.max() == pytest.approx(alone.pressure.max(), rel=TOLERANCES["patch"])
    # what a single point of a corner leaves
    assert pressed("particles", share, basis_order, sides=True).deviation > 0.1


@pytest.mark.parametrize("basis_order", [1, 2])
@pytest.mark.parametrize("share", [0.0, 0.25], ids=["even", "uneven"])
def test_contact_patch_test_of_sliding(figure, share, basis_order):
    """Uniform pressure and friction where a rough plate slides over all points."""
    patch, error = slid("averages", share, basis_order)
    assert np.all(patch.state == SLIP)
    name = f"contact patch test with sliding, order {basis_order}"
    figure(name, max(patch.deviation, error), TOLERANCES["patch"])
    assert slid("particles", share, basis_order)[0].deviation > 0.1
