"""``[material.x.softening]``: the Mullins effect of a material."""

from pydantic import model_validator

from seal_mdao.errors import SealFileError
from seal_mdao.materials.hoop_stretch import is_isochoric
from seal_mdao.materials.ogden_roxburgh import MOST, OgdenRoxburgh
from seal_mdao.seals.file.forms import number
from seal_mdao.seals.file.schema import Table, key, table

_WITHOUT_HISTORY = {
    "strain_energy": "part of the work is dissipated by softening; use profile_work",
    "friction_work": "softening dissipates energy, too; profile_work over a closed cycle includes "
    "both",
    "leak_rate": "it needs a constant modulus of the rubber, but the modulus depends on the "
    "largest energy so far",
}
"""Types of measures that a softening body does not have, and why."""


@table(kw_only=True)
class SofteningTable(Table):
    """Softening (Mullins effect) by the law of Ogden and Roxburgh, as in Abaqus."""

    r: number(above=1.0, most=MOST) = key(
        "limit of the softening: the factor eta of the stress is at least 1 - 1/r"
    )
    m: number("kPa", least=0.0, most=MOST) = key(
        "energy per volume in eta = 1 - erf((W_max - W) / (m + beta W_max)) / r; W_max: largest "
        "strain energy so far"
    )
    beta: number(least=0.0, most=MOST) = key(
        "fraction of the largest energy that is added to m; m and beta must not both be 0", 0.0
    )

    @model_validator(mode="after")
    def _possible(self):
        # refuses m = beta = 0
        self.made()
        return self

    def made(self) -> OgdenRoxburgh:
        """Make the law."""
        return OgdenRoxburgh(self.r, self.m, self.beta)


def softening_of(file, name: str) -> OgdenRoxburgh | None:
    """Make the softening of the material ``name`` of a ``SealFile``; None where it has none."""
    own = file.material_tables[name].softening
    return None if own is None else own.made()


def check_softening(file) -> None:
    """Raise SealFileError for keys that softening materials cannot be combined with.

    Raises
    ------
    SealFileError
    """
    softening = [name for name, own in file.material_tables.items() if own.softening is not None]
    for name in softening:
        where = f"[material.{name}.softening]"
        if not is_isochoric(file.materials[name]):
            raise SealFileError(
                f"{where}: Mullins softening is available for nearly incompressible material laws "
                "only, but this law is compressible; leave out softening"
            )
        relaxing = [n for n, own in file.material_tables.items() if own.viscoelastic is not None]
        if relaxing:
            raise SealFileError(
                f"{where}: Mullins softening cannot be combined with relaxation "
                f"([material.{relaxing[0]}.viscoelastic]); leave out either"
            )
        if file.model.axial_stretch is not None:
            raise SealFileError(
                f"{where}: Mullins softening cannot be combined with axial_stretch; leave out "
                "either"
            )
    for where, measure in file.located_measures:
        if softening and measure.type in _WITHOUT_HISTORY:
            raise SealFileError(
                f"{where}: {measure.type} is not available with softening "
                f"([material.{softening[0]}.softening]): {_WITHOUT_HISTORY[measure.type]}; leave "
                "out this measure"
            )
