"""Fits to Treloar's rubber beside published constants, and the calibration of the door seal."""

from pathlib import Path

import numpy as np

from figures.examples import write_example
from figures.tables import percent, table
from seal_mdao.calibration.cycles import SoftenedLaw, stress_in
from seal_mdao.calibration.data import ModeData, material_tests
from seal_mdao.calibration.fit_errors import errors_of
from seal_mdao.calibration.law_fit import fit
from seal_mdao.calibration.loading_modes import MODES
from seal_mdao.calibration.relaxation_data import relaxation_tests
from seal_mdao.calibration.relaxation_fit import fit_relaxation
from seal_mdao.calibration.relaxation_shift import Arrhenius
from seal_mdao.calibration.softening_fit import fit_softening
from seal_mdao.calibration.treloar import OGDEN_1972, treloar_tests
from seal_mdao.materials.ogden_roxburgh import OgdenRoxburgh
from seal_mdao.materials.yeoh import Yeoh
from seal_mdao.plotting import material_fit, relaxation_fit, save, softening_fit
from seal_mdao.plotting.captions import captioned, materials_text

DATA = "seal_mdao/calibration/treloar.csv"
FIT = f"fit {DATA} --law ogden --terms 3 --out out/material"
CALIBRATION = "calibrate_door_seal.py --out out/calibration"
ROWS = (
    ("neo-Hookean", "neo_hookean", 1), ("Mooney-Rivlin", "mooney_rivlin", 1), ("Gent", "gent", 1),
    ("Yeoh", "yeoh", 1), ("Ogden, 2 terms", "ogden", 2), ("Ogden, 3 terms", "ogden", 3),
)  # fmt: skip


def make(out: Path, reduced: bool) -> dict:
    """The picture, tables, and what the two scripts print."""
    tests = treloar_tests()
    fits = {label: fit(law, tests, terms=terms) for label, law, terms in ROWS}
    ogden, yeoh = fits["Ogden, 3 terms"], fits["Yeoh"]
    others = {"Ogden, published 1972": OGDEN_1972, "Yeoh, fitted": yeoh.law}
    with captioned({"tests of Treloar (1944)": materials_text({"fit": ogden.law})}):
        save(material_fit(ogden, others), out / "treloar.png")
    with captioned({"generated relaxation tests": "power law of time"}):
        save(relaxation_fit(fit_relaxation(_generated_relaxation())), out / "relaxation.png")
    with captioned({"generated cyclic test": "scatter of 2 %"}):
        save(softening_fit(fit_softening("yeoh", _generated_cycles())), out / "softening_fit.png")
    write_example("fit", FIT, out, reduced)
    write_example("calibration", CALIBRATION, out, reduced, " --steps 12 --depth 6")
    absolute = fit("ogden", tests, terms=3, weighting="absolute")
    laws = {label: found.law for label, found in fits.items()}
    laws |= {"Ogden, 3 terms, absolute": absolute.law, "Ogden, published 1972": OGDEN_1972}
    constants = {"fitted, relative": ogden.law, "fitted, absolute": absolute.law,
                 "published 1972": OGDEN_1972}  # fmt: skip
    errors = errors_of(OGDEN_1972, tests)
    return {
        "errors": _errors(laws, tests),
        "ogden": _ogden(constants),
        "yeoh": ", ".join(f"{name} = {yeoh.law.constants[name]:.4g}" for name in yeoh.unknowns),
        "fitted": percent(ogden.errors["all"].rms_relative, 1),
        "published": percent(errors["all"].rms_relative, 1),
    }


def _generated_relaxation():
    """Forces that fall by 6 % a decade, at three temperatures, with scatter of 0.2 %."""
    shift, rng, time = (
        Arrhenius((80.0,), 23.0),
        np.random.default_rng(3),
        np.geomspace(1.0, 1e4, 33),
    )
    curves = []
    for degrees in (23.0, 50.0, 80.0):
        reduced = time / np.exp(shift.log_factor(degrees)[0])
        force = 80.0 * (1.0 + reduced) ** -0.027 * (1.0 + 2e-3 * rng.normal(size=time.size))
        curves.append((time, force, degrees, "specimen"))
    return relaxation_tests(curves)


def _generated_cycles():
    """Three cycles of growing amplitude of a rubber that softens, with scatter of 2 %."""
    law = SoftenedLaw(Yeoh(300.0, -20.0, 3.0), OgdenRoxburgh(1.8, 30.0, 0.2))
    ends = [own for top in (1.3, 1.6, 2.0) for own in ((1.0, top), (top, 1.0))]
    stretch = np.concatenate([np.linspace(*own, 14)[1:] for own in ends])
    stress = stress_in(law, MODES["uniaxial"], ModeData(stretch, stretch, None, 3))
    stress *= 1.0 + 0.02 * np.random.default_rng(1).normal(size=stress.size)
    return material_tests({"uniaxial": (stretch, stress)})


def _errors(laws: dict, tests) -> str:
    rows = []
    for label, law in laws.items():
        found = errors_of(law, tests)
        cells = [f"{found[name].rms_kPa:.0f}" for name in (*MODES, "all")]
        rows.append(
            [label, *cells, percent(found["all"].rms_relative, 1), f"{found['all'].r2:.4f}"]
        )
    head = ["law", *(f"{name}, kPa" for name in MODES), "all, kPa", "all, % of reading", "R²"]
    return table(head, rows)


def _ogden(laws: dict) -> str:
    rows = []
    for label, law in laws.items():
        pairs = sorted(zip(law.mu, law.alpha, strict=True), key=lambda pair: -abs(pair[0]))
        rows.append([label, *(f"{number:.4g}" for pair in pairs for number in pair)])
    head = ["Ogden", *(f"{name} {i}" for i in (1, 2, 3) for name in ("μ (kPa)", "α"))]
    return table(head, rows)
