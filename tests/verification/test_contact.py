"""Contact and friction where the exact answer is known."""

import numpy as np

from seal_mdao.verification.hertz import press_cylinder
from seal_mdao.verification.sliding import drag_block, pull_belt


def test_hertz_line_contact(figure):
    widths, peaks = [], []
    for n in (4, 8, 12):
        contact = press_cylinder(n)
        widths.append(abs(contact.half_width / contact.exact_half_width - 1.0))
        peaks.append(abs(contact.peak / contact.exact_peak - 1.0))
    figure("Hertz line contact, 8 cells a half-width: half-width", widths[1], 0.02)
    figure("Hertz line contact, 8 cells a half-width: peak pressure", peaks[1], 0.02)
    figure("Hertz line contact, 12 cells a half-width: half-width", widths[2], 0.02)
    figure("Hertz line contact, 12 cells a half-width: peak pressure", peaks[2], 0.02)
    assert widths[2] < widths[1] < widths[0]
    assert max(peaks[1:]) < 0.5 * peaks[0]


def test_hertz_pressure_is_the_ellipse(figure):
    contact = press_cylinder(12)
    inside = np.abs(contact.x) < 0.9 * contact.exact_half_width
    ellipse = np.sqrt(1.0 - (contact.x[inside] / contact.exact_half_width) ** 2)
    error = contact.pressure[inside] / contact.exact_peak - ellipse
    figure("Hertz line contact: pressure on 90 % of the width", np.abs(error).max(), 0.02)


def test_dragged_block_slides_at_mu_times_the_normal_force(figure):
    block = drag_block(friction=0.3)
    right = block.slipping & (block.travel > 0.2) & (np.arange(45) < 15)
    left = block.slipping & (block.travel < 0.0)
    assert right.sum() >= 4
    assert left.sum() >= 10
    figure("dragged block, forwards: T/N + mu", np.abs(block.ratio[right] + 0.3).max(), 1e-9)
    figure("dragged block, backwards: T/N - mu", np.abs(block.ratio[left] - 0.3).max(), 1e-9)
    figure("dragged block: ratio at the base", np.abs(block.base_ratio - block.ratio).max(), 1e-7)
    stuck = ~block.slipping
    assert stuck.sum() > 5
    assert np.all(np.abs(block.ratio[stuck]) < 0.3)


def test_belt_on_a_cylinder_follows_the_capstan_law(figure):
    thick, thin = pull_belt(0.3, thickness=0.2, cells=72), pull_belt(0.3, thickness=0.1, cells=144)
    assert thick.slipping
    assert thin.slipping
    ratios = [belt.exponent / belt.exact for belt in (thick, thin)]
    figure("belt on a cylinder, t/R = 0.01: exponent over mu * angle", abs(ratios[1] - 1.0), 0.01)
    # the offset of the friction from the belt's axis is linear in the thickness
    figure("belt on a cylinder, t -> 0: exponent over mu * angle",
           abs(2.0 * ratios[1] - ratios[0] - 1.0), 2e-3)  # fmt: skip
    correction = [1.0 / (1.0 + 0.5 * belt.thickness) for belt in (thick, thin)]
    figure(
        "belt on a cylinder: thickness correction",
        np.abs(np.subtract(ratios, correction)).max(),
        3e-3,
    )
