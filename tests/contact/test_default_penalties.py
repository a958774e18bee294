"""Default penalties are those of the material in contact."""

from types import SimpleNamespace

import numpy as np
import pytest
from foam_bulbs import BLOCK, foam_bulb

import seal_mdao as sm
from seal_mdao.contact.default_penalties import stiffness_at
from seal_mdao.structure.elastic_body import ElasticBody
from seal_mdao.structure.region import Region


@pytest.mark.parametrize("beside", [[1, 5, 6, 7], [5, 6, 1, 1]])
def test_material_that_begins_where_the_contact_ends_does_not_count(beside):
    """A quadrilateral or a triangle of a stiff material, with one corner at the end of the contact."""
    soft, stiff = sm.NeoHookean(100.0, 1e4), sm.NeoHookean(5e4, 1e6)
    body = SimpleNamespace(cells=np.array([[2, 0, 1, 3], beside]))
    elastic = ElasticBody((Region(soft, np.array([0])), Region(stiff, np.array([1]), "stiff_")))
    points = SimpleNamespace(anchors=np.array([[0, 0, 1, 1]]))
    where = SimpleNamespace(points=points, lengths=lambda particles: np.full(2, 0.5))
    assert stiffness_at(where, elastic, body, np.zeros((8, 2))) == 3.0 * 200.0 / 0.5
    # a side of it in contact counts
    body.cells[1] = [0, 1, 5, 6]
    assert stiffness_at(where, elastic, body, np.zeros((8, 2))) == 3.0 * 1e5 / 0.5


def test_penalties_of_a_bulb_do_not_depend_on_the_rubber_below(tmp_path):
    """Its edge in contact ends at the interface."""
    found = []
    for hardness in (40, 75):
        path = tmp_path / f"bulb_{hardness}.toml"
        text = foam_bulb(BLOCK, 0.8).replace("normal_penalty = 1e3\n", "")
        text = text.replace("shore_a = 75", f"shore_a = {hardness}")
        path.write_text(text + '[[measure]]\ntype = "reaction"\n')
        seal = sm.build_seal(path)
        found.append({n: own.value for n, own in seal.scalars.items() if "penalty" in n})
    assert found[0] == found[1]
