"""Constants that give no stable material are refused, with the name of the constant."""

import numpy as np
import pytest

from seal_mdao.materials.gent import Gent
from seal_mdao.materials.hyperfoam import Hyperfoam
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.materials.neo_hookean import NeoHookean
from seal_mdao.materials.ogden import Ogden
from seal_mdao.materials.yeoh import Yeoh

FOAM = {"mu": (60.0,), "alpha": (6.0,), "nu": (0.3,)}
RUBBER = {"mu": (140.0,), "alpha": (2.0,)}
BAD = [
    (MooneyRivlin, {"c10": -1.0}, "c10"),
    (MooneyRivlin, {"c01": -1.0}, "c01"),
    (MooneyRivlin, {"c10": 0.0, "c01": 0.0}, "c10 and c01"),
    (MooneyRivlin, {"c10": np.nan}, "c10"),
    (MooneyRivlin, {"c01": np.inf}, "c01"),
    (NeoHookean, {"c10": 0.0}, "c10"),
    (Yeoh, {"c10": -1.0}, "c10"),
    (Yeoh, {"c20": np.nan}, "c20"),
    (Yeoh, {"c30": np.inf}, "c30"),
    (Gent, {"shear_modulus": 0.0}, "shear_modulus"),
    (Gent, {"limit": -1.0}, "limit"),
    (Gent, {"limit": np.inf}, "limit"),
    (Ogden, RUBBER | {"mu": (-140.0,)}, "shear modulus"),
    (Ogden, RUBBER | {"alpha": (0.0,)}, "alpha_1"),
    (Ogden, {"mu": (140.0, np.nan), "alpha": (2.0, 1.0)}, "mu_2"),
    (Ogden, {"mu": (140.0, 10.0), "alpha": (2.0,)}, "equally many values of mu and alpha"),
    (Ogden, {"mu": (), "alpha": ()}, "at least one"),
    (Hyperfoam, FOAM | {"mu": (-60.0,)}, "shear modulus"),
    (Hyperfoam, FOAM | {"alpha": (0.0,)}, "alpha_1"),
    (Hyperfoam, FOAM | {"nu": (0.5,)}, "nu_1"),
    (Hyperfoam, FOAM | {"nu": (-1.0,)}, "nu_1"),
    (Hyperfoam, FOAM | {"nu": (0.3, 0.3)}, "equally many values of mu and alpha and nu"),
    (Hyperfoam, {"mu": (90.0, -80.0), "alpha": (6.0, 2.0), "nu": (0.0, 0.45)}, "bulk modulus"),
    *((law, {"bulk_modulus": bad}, "bulk_modulus")
      for law in (MooneyRivlin, NeoHookean, Yeoh, Gent) for bad in (0.0, -1.0, np.inf)),
    *((Ogden, RUBBER | {"bulk_modulus": bad}, "bulk_modulus") for bad in (0.0, -1.0, np.inf)),
]  # fmt: skip


@pytest.mark.parametrize(("law", "constants", "word"), BAD)
def test_constants_without_a_stable_material_are_refused(law, constants, word):
    with pytest.raises(ValueError, match=word):
        law(**constants)


LAWS_WITH_BULK = [NeoHookean(c10=60.0), MooneyRivlin(50.0, 10.0), Yeoh(60.0, -1.0, 0.1),
                  Gent(120.0, 20.0), Ogden((120.0,), (2.0,))]  # fmt: skip


@pytest.mark.parametrize("law", LAWS_WITH_BULK, ids=lambda law: type(law).__name__)
def test_a_negative_poisson_ratio_is_refused_with_its_value(law):
    """nu = (3 K - 2 G) / (6 K + 2 G) with G = 120 is -0.1 for K = 60 and 0 for K = 80."""
    assert law.shear_modulus == pytest.approx(120.0, rel=1e-14)
    with pytest.raises(
        ValueError, match=r"bulk_modulus = 60 .* Poisson's ratio of -0.1 .* 2/3 .*80"
    ):
        law.with_(bulk_modulus=60.0)
    assert law.with_(bulk_modulus=80.001).bulk_modulus == 80.001


def test_a_change_is_checked_like_a_new_material():
    with pytest.raises(ValueError, match="nu_1"):
        Hyperfoam(**FOAM).with_(nu_1=0.6)
    with pytest.raises(ValueError, match="limit"):
        Gent().with_(limit=0.0)


def test_whole_numbers_are_taken_as_floating_ones():
    assert MooneyRivlin(80, 20, 80000) == MooneyRivlin()
    assert all(type(value) is float for value in Ogden((140, 2), (2, 1), 1000).constants.values())
