"""Material values far outside the range of rubber, which mostly indicate a wrong unit."""

from seal_mdao.materials.isotropic import Isotropic
from seal_mdao.structure.elastic_body import ElasticBody
from seal_mdao.structure.region import Region

SHEAR = (5.0, 2e4)
"""Shear moduli of dense rubber and foam, kPa: foam of grade 2A1 (ASTM D1056) has about 40, softer foams
less, rubber of 95 Shore A about 15,000."""
MOST_BULK = 1e7
"""Bulk modulus, kPa; dense rubber has 1e6 to 3e6."""
DENSITY = (20.0, 2e4)
"""kg/m3: light foam has about 50, dense rubber 900 to 2000, inserts of metal 2700 to 19,000."""
EXPANSION = (5e-5, 5e-4)
"""Linear coefficients of expansion, 1/K: filled rubber has about 1e-4, silicone up to 3.5e-4."""
SWELLING = (0.8, 3.0)
"""Volume in a liquid over dry volume; a fluid that extracts plasticiser shrinks rubber by some
percent, one that does not suit it doubles its volume."""
TEMPERATURE = (-100.0, 350.0)
"""Degrees Celsius: silicone is rubber down to about -100, and no rubber endures more than about 330."""


def unusual_values(body: ElasticBody) -> list[str]:
    """Describe material values of a body far outside the range of rubber, one line each, with the
    unit in seal files."""
    # beside another material a stiff one may be an insert
    insert = len(body.regions) > 1
    found = [text for own in body.regions for text in _of_region(own, body.environment, insert)]
    temperature = None if body.environment is None else body.environment.temperature
    if temperature is not None and not _within(temperature.value, TEMPERATURE):
        found.append(
            f"the temperature of {temperature.value:.4g} degrees Celsius is outside of the service "
            f"range of rubbers, {TEMPERATURE[0]:g} to {TEMPERATURE[1]:g}; temperatures are in "
            "degrees Celsius, not in kelvin"
        )
    return found


def unusual_moduli(what: str, material: Isotropic, insert: bool = False):
    """Yield a line for each modulus of a material, named ``what``, far outside the range of rubber; a
    stiff one may be an ``insert`` of another material."""
    shear, bulk = material.shear_modulus, material.initial_bulk_modulus
    if insert and shear > SHEAR[1]:
        yield (
            f"{what} has an initial shear modulus of {shear:.4g} kPa, larger than that of rubber and "
            f"foam, {SHEAR[0]:g} to {SHEAR[1]:g}: it is an insert of plastic (about 1e5 to 2e6) or "
            "metal (about 2e7 to 8e7), or its unit is wrong; moduli are in kPa: 1 MPa is 1000 kPa"
        )
        return
    if not _within(shear, SHEAR):
        compared = "smaller" if shear < SHEAR[0] else "larger"
        yield (
            f"{what} has an initial shear modulus of {shear:.4g} kPa, {compared} than that of rubber "
            f"and foam, {SHEAR[0]:g} to {SHEAR[1]:g}; moduli are in kPa: 1 MPa is 1000 kPa"
        )
    if bulk > MOST_BULK:
        yield (
            f"{what} has a bulk modulus of {bulk:.4g} kPa, larger than {MOST_BULK:g}; dense rubber has "
            "1e6 to 3e6; moduli are in kPa: 1 MPa is 1000 kPa"
        )


def _of_region(region: Region, environment, insert: bool):
    """Describe the unusual values of one material."""
    what = region.title
    yield from unusual_moduli(what, region.material, insert)
    if region.density is not None and not _within(region.density, DENSITY):
        yield (
            f"{what} has a density of {region.density:.4g} kg/m3, outside of {DENSITY[0]:g} to "
            f"{DENSITY[1]:g}, the range from light foam to metal; 1 g/cm3 is 1000 kg/m3"
        )
    if environment is None:
        return
    alpha, swelling = region.growth.expansion, region.growth.swelling
    if environment.temperature is not None and alpha and not _within(alpha, EXPANSION):
        yield (
            f"{what} has an expansion of {alpha:.4g} 1/K, outside of {EXPANSION[0]:g} to "
            f"{EXPANSION[1]:g}, the range of rubbers; the linear coefficient is needed, a third of "
            "the volumetric one"
        )
    if swelling is not None and not _within(swelling.value, SWELLING):
        yield (
            f"{what} has a swelling of {swelling.value:.4g}, outside of {SWELLING[0]:g} to "
            f"{SWELLING[1]:g}; swelling is the ratio of swollen to dry volume, 1.15 for 15 %"
        )


def _within(value: float, limits) -> bool:
    return limits[0] <= value <= limits[1]
