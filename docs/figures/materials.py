"""Fits to Treloar's rubber beside published constants, and the calibration of the door seal."""

from pathlib import Path

from figures.examples import write_example
from figures.tables import percent, table
from seal_mdao.calibration.fit import fit
from seal_mdao.calibration.fit_errors import errors_of
from seal_mdao.calibration.loading_modes import MODES
from seal_mdao.calibration.treloar import OGDEN_1972, treloar_tests
from seal_mdao.plotting import material_fit, save
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
