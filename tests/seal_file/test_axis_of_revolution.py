"""Sections of bodies of revolution that touch the axis, or lie beyond it."""

import pytest
from ring_files import HEAD, PLANE, under_a_lid

import seal_mdao as sm

FILE = (
    HEAD.replace("{bulk}", "80000.0").replace("{spacing}", "0.5")
    + """\
outer = [ {outer} ]
[[moved]]
edges = ["top"]
stage = [{{ translate = [0.0, -0.1] }}]
[[measure]]
type = "reaction"
"""
)
BASE = '{{ edge = "top", line = [[{b}, 0.0], [{a}, 0.0]] }}'
ARC = '{{ edge = "round", arc = {{ start = [{a}, 0.0], through = [{m}, {d}], end = [{b}, 0.0] }} }}'


def half_disc(a, b):
    """A file of the lower half of a disc between the radii ``a`` and ``b``."""
    at = {"a": a, "b": b, "m": 0.5 * (a + b), "d": -0.5 * (b - a)}
    return FILE.format(outer=", ".join(own.format(**at) for own in (ARC, BASE)))


def read(tmp_path, text):
    path = tmp_path / "ring.toml"
    path.write_text(text, encoding="utf-8")
    return sm.read_seal_file(path)


def test_an_arc_beside_the_axis(tmp_path):
    assert read(tmp_path, half_disc(1.0, 5.0)).axisymmetric


def test_an_arc_that_touches_the_axis_is_refused(tmp_path):
    with pytest.raises(
        sm.SealFileError, match=r"edge '\w+' touches the axis x = 0 in the single point y = 0"
    ):
        read(tmp_path, half_disc(0.0, 4.0))


def test_an_arc_beyond_the_axis_is_refused(tmp_path):
    with pytest.raises(sm.SealFileError, match=r"reaches x = -1, beyond the axis of revolution"):
        read(tmp_path, half_disc(-1.0, 3.0))


def test_an_arc_that_ends_at_an_edge_on_the_axis(tmp_path):
    """A quarter of a disc: its arc ends where the edge on the axis does."""
    arc = "{ start = [0.0, -4.0], through = [2.8284271247, -2.8284271247], end = [4.0, 0.0] }"
    outer = f'{{ edge = "round", arc = {arc} }}, {BASE.format(a=0.0, b=4.0)}, '
    outer += '{ edge = "axis", line = [[0.0, 0.0], [0.0, -4.0]] }'
    file = read(tmp_path, FILE.format(outer=outer))
    assert file.supports["axis"] == (0,)


def cylinder(radius):
    """A file of a ring that nothing holds at its base, with this inner radius."""
    own = under_a_lid((radius, 4.0), 2.0, 2.1, -0.3, 3, bulk=80000.0, points="edges")
    return own + '[[measure]]\ntype = "reaction"\n'


@pytest.mark.parametrize("radius", [0.0, 1.0])
def test_a_plane_of_symmetry_across_the_axis_holds_a_ring(tmp_path, radius):
    """And no profile has to touch it at the start: it can only move along the axis."""
    file = read(tmp_path, PLANE + cylinder(radius))
    result = sm.analyze(sm.build_seal(file))
    result.require_converged()
    assert result.value("reaction")[-1] > 0.0


@pytest.mark.parametrize("radius", [0.0, 1.0])
def test_the_axis_holds_nothing_along_itself(tmp_path, radius):
    with pytest.raises(sm.SealFileError, match="profiles must support the section"):
        read(tmp_path, cylinder(radius))
