"""Treloar's tests of vulcanised rubber, 1944, and constants published for them."""

from importlib.resources import as_file, files

from seal_mdao.calibration.data import MaterialTests, read_tests
from seal_mdao.materials.ogden import Ogden

OGDEN_1972 = Ogden(mu=(630.0, 1.2, -10.0), alpha=(1.3, 5.0, -2.0))
"""Constants of R. W. Ogden, Proc. R. Soc. Lond. A 326 (1972) 565: 6.3, 0.012 and -0.1 kg/cm^2, in
kPa with the factor 100 of later authors."""


def treloar_tests() -> MaterialTests:
    """Read the tests that come with the package in ``treloar.csv``."""
    with as_file(files("seal_mdao.calibration") / "treloar.csv") as path:
        tests = read_tests(path)
    return MaterialTests(tests.modes, "Treloar 1944")
