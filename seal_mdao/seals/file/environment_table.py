"""Axial stretch, temperature and swelling of a seal file, one value at the end of every stage."""

import numpy as np

from seal_mdao.errors import SealFileError
from seal_mdao.materials.hoop_stretch import is_known
from seal_mdao.materials.viscoelastic import ABSOLUTE_ZERO
from seal_mdao.seals.conditions import HOTTEST
from seal_mdao.seals.file.model_table import ENTROPIC, GENERALISED, at_stage_ends
from seal_mdao.seals.file.softening_table import check_softening
from seal_mdao.seals.file.viscoelastic_table import check_relaxation, times_of
from seal_mdao.structure.environment import Environment, Growth
from seal_mdao.terms.ramp import Ramp, ramp_of_stages
from seal_mdao.values import formatted


def environment_of(file) -> Environment | None:
    """Make the environment of the body of a ``SealFile``, or None where nothing changes."""
    model = file.model
    swollen = any(own.swelling is not None for own in file.material_tables.values())
    times = times_of(file)
    if model.axial_stretch is None and model.temperature is None and not swollen and not times:
        return None
    ramps = (
        _ramp(file, "[model]: axial_stretch", 1.0, model.axial_stretch),
        _ramp(file, "[model]: temperature", model.reference_temperature, model.temperature),
    )
    return Environment(*ramps, times)


def growth_of(file, name: str) -> Growth:
    """Make the growth of the material ``name`` of a ``SealFile``."""
    own, factors = file.material_tables[name], None
    if own.modulus_over_temperature == ENTROPIC:
        # m = T / T_0 of absolute temperatures, a line through (T_0, 1) over all temperatures
        start = file.model.reference_temperature
        zero, hottest = ABSOLUTE_ZERO, max(HOTTEST, start + 1.0)
        factors = np.array(
            [[zero, 0.0], [start, 1.0], [hottest, (hottest - zero) / (start - zero)]]
        )
    elif own.modulus_over_temperature is not None:
        factors = np.array(own.modulus_over_temperature)
    swelling = _ramp(file, f"[material.{name}]: swelling", 1.0, own.swelling)
    return Growth(own.expansion, swelling, factors)


def _ramp(file, where: str, start: float, given) -> Ramp | None:
    """Make the ramp of a number, or of one at the end of every stage."""
    if given is None:
        return None
    values = at_stage_ends(file, where, given)
    return ramp_of_stages(start, values, [stage.steps for stage in file.stages])


def check_environment(file) -> None:
    """Raise SealFileError for tables of a ``SealFile`` that cannot be combined with its
    environment."""
    _check_axial_stretch(file)
    _check_temperature(file)
    check_relaxation(file)
    check_softening(file)
    # made once here, so that what is wrong is said before anything is analysed
    environment = environment_of(file)
    for name in file.materials:
        _check_factors(file, name)
    if environment is None or not any(
        environment.acts_on(growth_of(file, name)) for name in file.materials
    ):
        return
    for name, material in file.materials.items():
        if not is_known(material):
            raise SealFileError(
                f"[material.{name}]: this compressible law supports only plane strain without "
                "temperature, swelling or axial_stretch; use another law, or define its methods "
                "volumetric and volumetric_constants"
            )
    for where, measure in file.located_measures:
        if measure.type == "friction_work":
            raise SealFileError(
                f"{where}: friction_work is not available with temperature, swelling "
                "or axial_stretch, because these do work, too; leave out this measure"
            )


def _check_axial_stretch(file) -> None:
    given, kind = file.model.axial_stretch, file.model.kinematics
    if kind == GENERALISED and given is None:
        raise SealFileError(
            f'[model]: kinematics = "{GENERALISED}" needs axial_stretch, such as 1.03 for a seal that '
            "is 3 % longer on its flange"
        )
    if kind != GENERALISED and given is not None:
        raise SealFileError(
            f'[model]: axial_stretch = {formatted(given)} needs kinematics = "{GENERALISED}", not '
            f'"{kind}"; change kinematics, or leave axial_stretch out'
            + ("; a ring is stretched by a profile that moves along x" if file.axisymmetric else "")
        )


def _check_temperature(file) -> None:
    if file.model.temperature is None:
        for name, own in file.material_tables.items():
            _refuse_without_temperature(name, own)
        return
    # trapped air is heated with the seal
    if not file.cavities and not any(
        own.changes_with_temperature for own in file.material_tables.values()
    ):
        raise SealFileError(
            f"[model]: temperature = {formatted(file.model.temperature)}, but no material depends "
            "on temperature, and there is no trapped air ([[cavity]]); give a material an expansion "
            "(rubber about 2e-4 1/K), a modulus_over_temperature or a shift of its relaxation times, "
            "or leave temperature out"
        )


def _refuse_without_temperature(name: str, own) -> None:
    """Refuse keys of a material that a seal without a temperature does not have."""
    given = {"expansion": own.expansion, "modulus_over_temperature": own.modulus_over_temperature}
    for key, value in given.items():
        if value:
            raise SealFileError(
                f"[material.{name}]: {key} = {formatted(value)}, which has no effect, because "
                "[model] has no temperature; add temperature = 60 (degrees Celsius, at the end of "
                f"every stage) to [model], or leave out {key}"
            )


def _check_factors(file, name: str) -> None:
    """Refuse a table of moduli that does not reach the temperatures of the path."""
    table = file.material_tables[name].modulus_over_temperature
    if file.model.temperature is None or table in (None, ENTROPIC):
        return
    at = [temperature for temperature, _ in table]
    # temperatures at the start and at the ends of all stages
    given = np.append(file.model.reference_temperature, file.model.temperature)
    if given.min() < at[0] or given.max() > at[-1]:
        raise SealFileError(
            f"[material.{name}]: modulus_over_temperature goes from {at[0]:g} to {at[-1]:g} "
            f"degrees Celsius, but [model] has temperatures from {given.min():g} to "
            f"{given.max():g}, reference_temperature included; add points to this table"
        )
