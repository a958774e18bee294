"""``[material.x.viscoelastic]``: relaxation of a material, and the times of the stages that it needs."""

import numpy as np
from pydantic import model_validator

from seal_mdao.errors import SealFileError
from seal_mdao.materials.viscoelastic import (
    ABSOLUTE_ZERO,
    Arrhenius,
    PronySeries,
    WilliamsLandelFerry,
)
from seal_mdao.seals.conditions import HOTTEST
from seal_mdao.seals.file.forms import many, number, one_of
from seal_mdao.seals.file.model_table import at_stage_ends
from seal_mdao.seals.file.schema import Table, key, table
from seal_mdao.terms.ramp import StageTimes, times_of_stages

LONG, SHORT = "long_term", "instantaneous"
LONGEST = 1e12
"""Longest time, s."""
Reference = number("degC", above=ABSOLUTE_ZERO, most=HOTTEST)
_WITHOUT_TIME = {
    "strain_energy": "the stored energy of viscoelastic rubber cannot be computed from its stress",
    "friction_work": "viscoelastic rubber dissipates energy, too",
    "leak_rate": "it needs a constant modulus of the rubber, but the modulus depends on time",
}
"""Types of measures that a relaxing body does not have, and why."""


@table(kw_only=True)
class WlfTable(Table):
    """Shift of the relaxation times with temperature by Williams, Landel and Ferry."""

    c1: number(least=0.0, most=1e3) = key("c1 of log10 a_T = -c1 (T - T_r) / (c2 + T - T_r)")
    c2: number("K", above=0.0, most=1e4) = key(
        "c2 of this law, which holds above the temperature T_r - c2"
    )
    reference: Reference = key("T_r, the temperature for which tau is given")


@table(kw_only=True)
class ArrheniusTable(Table):
    """Shift of the relaxation times with temperature by Arrhenius."""

    activation_energy: number("kJ/mol", least=0.0, most=1e3) = key(
        "E of ln a_T = (E / R) (1 / T - 1 / T_r)"
    )
    reference: Reference = key("T_r, the temperature for which tau is given")


@table(kw_only=True)
class ViscoelasticTable(Table):
    """Relaxation: finite linear viscoelasticity with a Prony series, as in Abaqus."""

    g: many(number(least=0.0, most=1.0), "a list of numbers of at least 0") = key(
        "relaxing fractions of the instantaneous modulus; their sum is below 1"
    )
    tau: many(number(above=0.0, most=LONGEST), "a list of numbers above 0 (s)") = key(
        "relaxation time of each fraction"
    )
    moduli: one_of(LONG, SHORT) = key(
        f'whether the constants of the law are those after complete relaxation ("{LONG}") or before '
        f'any ("{SHORT}")',
        LONG,
    )
    wlf: WlfTable | None = key(
        "change of the relaxation times with temperature, near the glass transition", None
    )
    arrhenius: ArrheniusTable | None = key(
        "change of the relaxation times with temperature, far above the glass transition", None
    )

    @model_validator(mode="after")
    def _possible(self):
        if self.wlf is not None and self.arrhenius is not None:
            raise ValueError(
                "the keys wlf and arrhenius are given together, but both define the "
                "shift of the relaxation times with temperature; use only one of them"
            )
        # refuses parts and times that do not belong together
        self.made()
        return self

    def made(self) -> PronySeries:
        """Make the series."""
        shift = None
        if self.wlf is not None:
            shift = WilliamsLandelFerry(self.wlf.c1, self.wlf.c2, self.wlf.reference)
        if self.arrhenius is not None:
            shift = Arrhenius(self.arrhenius.activation_energy, self.arrhenius.reference)
        return PronySeries(self.g, self.tau, self.moduli == SHORT, shift)


def series_of(file, name: str) -> PronySeries | None:
    """Make the Prony series of the material ``name`` of a ``SealFile``; None where it has none."""
    own = file.material_tables[name].viscoelastic
    return None if own is None else own.made()


def relaxes(file) -> bool:
    """Return whether a material of a ``SealFile`` relaxes."""
    return any(own.viscoelastic is not None for own in file.material_tables.values())


def times_of(file) -> StageTimes | None:
    """Make the times of the stages of a ``SealFile``, whose first moving part has the durations; None
    where nothing relaxes."""
    if not relaxes(file):
        return None
    steps = [stage.steps for stage in file.stages]
    # first step of a dwell: the shortest relaxation time
    first = [
        _shortest(file, number) if dwells(file, number) else np.inf for number in range(len(steps))
    ]
    return times_of_stages([stage.duration for stage in file.stages], first, steps)


def _temperatures(file) -> list | None:
    """Temperatures at the beginning of the path and at the ends of the stages."""
    given, model = file.model.temperature, file.model
    if given is None:
        return None
    return [model.reference_temperature, *at_stage_ends(file, "[model]: temperature", given)]


def _conditions(file) -> list[list]:
    """Temperatures, and swelling ratios of every material that has them, at the beginning of the path
    and at the ends of the stages."""
    temperatures = _temperatures(file)
    found = [] if temperatures is None else [temperatures]
    for name, own in file.material_tables.items():
        if own.swelling is not None:
            where = f"[material.{name}]: swelling"
            found.append([1.0, *at_stage_ends(file, where, own.swelling)])
    return found


def dwells(file, number: int) -> bool:
    """Whether motions, temperature, swelling and pressures are constant in a stage, counted from 0."""
    moving = [own for own in file.moving if own.stages]
    counts = {len(own.stages) for own in moving}
    # all moving parts have as many stages, and none moves in this one
    still = len(counts) == 1 and not any(own.stages[number].moves for own in moving)
    still = still and all(own[number] == own[number + 1] for own in _conditions(file))
    # a fluid grows over its last steps, by default those of the last stage
    ends = np.cumsum([stage.n_steps for stage in file.stages])
    begun = [ends[-1] - (own.steps or file.stages[-1].n_steps) for own in file.fluids]
    return still and all(ends[number] <= begin for begin in begun)


def _shortest(file, number: int) -> float:
    """Least relaxation time of all materials at the temperature of a stage, s."""
    temperatures, found = _temperatures(file), []
    for name in file.materials:
        own = series_of(file, name)
        if own is not None:
            shift = 1.0
            if own.shift is not None:
                at = np.array(temperatures[number + 1], float)
                # tau_i a_T at the end of the stage
                shift = float(np.exp(own.shift.log_factor(at)[0]))
            found.append(min(own.tau) * shift)
    return min(found)


def check_relaxation(file) -> None:
    """Raise SealFileError for keys that relaxing materials need or cannot be combined with.

    Raises
    ------
    SealFileError
    """
    for name, own in file.material_tables.items():
        given = own.viscoelastic
        if given is None:
            continue
        where = f"[material.{name}.viscoelastic]"
        kind = "wlf" if given.wlf is not None else "arrhenius"
        if getattr(given, kind) is not None and file.model.temperature is None:
            raise SealFileError(
                f"{where}: {kind} has no effect, because [model] has no temperature; add "
                f"temperature to [model], or leave out {kind}"
            )
        _check_shift(file, where, given)
    if not relaxes(file):
        return
    relaxing = next(n for n, own in file.material_tables.items() if own.viscoelastic is not None)
    _check_times(file, relaxing)
    if file.model.axial_stretch is not None:
        raise SealFileError(
            f"[material.{relaxing}.viscoelastic]: viscoelasticity cannot be combined with "
            "axial_stretch; leave out either"
        )
    for where, measure in file.located_measures:
        if measure.type in _WITHOUT_TIME:
            raise SealFileError(
                f"{where}: {measure.type} is not available with relaxation: "
                f"{_WITHOUT_TIME[measure.type]}; leave out this measure"
            )


def _check_shift(file, where: str, given: ViscoelasticTable) -> None:
    """Refuse temperatures of the path at which the shift does not exist."""
    temperatures, shift = _temperatures(file), given.made().shift
    if shift is None or temperatures is None:
        return
    try:
        shift.log_factor(np.array(temperatures))
    except ValueError as error:
        raise SealFileError(f"{where}: {error}") from None


def _check_times(file, relaxing: str) -> None:
    """Refuse stages without a duration, and durations of what does not move first."""
    kinds = [("profile", file.profiles), ("moved", file.moved)]
    first = file.leading
    for kind, tables in kinds:
        for i, own in enumerate(tables, 1):
            for k, stage in enumerate(own.stages, 1):
                where = f"[[{kind}]] {i} ({own.name!r}): [[{kind}.stage]] {k}"
                if own is first and stage.duration is None:
                    raise SealFileError(
                        f"{where} has no duration, but [material.{relaxing}] is viscoelastic; give "
                        "every stage a duration (s)"
                    )
                if own is not first and stage.duration is not None:
                    raise SealFileError(
                        f"{where} has a duration, but the stages of {first.name!r} already define "
                        "the times; leave out this duration"
                    )
