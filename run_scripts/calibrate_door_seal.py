"""Calibrate rubber and friction of the door seal to a measured compression-load-deflection curve.

The "measurement" is made here: the seal with known constants, closed and opened again, with noise. The
optimiser then starts elsewhere and finds them back from the force alone, by exact gradients.
"""

import sys
import time
from dataclasses import dataclass, replace

import numpy as np
import openmdao.api as om

import seal_mdao as sm
from seal_mdao import plotting
from seal_mdao.cli.arguments import (
    WrongArgumentError,
    checked_arguments,
    parser,
    run,
    write_summary,
)
from seal_mdao.geometry.motion import Stage, staged_motion
from seal_mdao.measures.reaction import Reaction

UNKNOWNS = ("c10", "friction")
TRUE = {"c10": 92.0, "friction": 0.32}
START = {"c10": 70.0, "friction": 0.15}
LOWER, UPPER = {"c10": 40.0, "friction": 0.0}, {"c10": 200.0, "friction": 0.8}
TOUCH = 9.5
"""Height of the door at which it touches the nominal seal, mm."""


@dataclass(frozen=True)
class Bench:
    """A press that closes on the seal and goes back.

    Attributes
    ----------
    depth : float
        Travel, mm.
    steps : int
        Load steps each way; a reading after every one but the last, where there is no contact.
    """

    depth: float
    steps: int

    def seal(self, constants) -> sm.Seal:
        """The door seal in the press."""
        nominal = sm.door_seal().with_parameters(constants)
        body, door = nominal.terms()
        ways = [Stage(self.steps, (0.0, -self.depth)), Stage(self.steps, (0.0, self.depth))]
        door = replace(door, motion=staged_motion(ways, start=(0.0, TOUCH)))
        return sm.Seal(
            nominal.nominal_particles,
            nominal.design_velocity,
            nominal.body,
            (body, door),
            2 * self.steps,
        )

    @property
    def force(self) -> Reaction:
        """The vertical force after every step."""
        travels = tuple(self.depth / self.steps * k for k in range(1, 2 * self.steps))
        return Reaction("door", travels, (1,), name="force")

    @property
    def travel(self) -> np.ndarray:
        """Of every reading, mm."""
        step = np.arange(1, 2 * self.steps)
        return self.depth * (1.0 - np.abs(step / self.steps - 1.0))

    def readings(self, constants) -> np.ndarray:
        """Force of a seal with these constants, N/m."""
        result = sm.analyze(self.seal(constants))
        result.require_converged()
        return result.value(self.force)


def problem(bench: Bench, measured, noise: float) -> om.Problem:
    """Sum of squared differences between computed and measured force, over the noise."""
    prob, shape = om.Problem(reports=None), measured.shape
    group = sm.SealGroup(
        seal=bench.seal(START), measures=(bench.force,), parameters=(*UNKNOWNS, "c01")
    )
    prob.model.add_subsystem("seal", group, promotes=["*"])
    misfit = om.ExecComp(
        "misfit = sum(((force - measured) / noise)**2)",
        force={"shape": shape, "units": "N/m"}, measured={"val": measured, "units": "N/m"},
        noise={"val": noise, "units": "N/m"},
    )  # fmt: skip
    prob.model.add_subsystem("difference", misfit, promotes=["*"])
    for name in UNKNOWNS:
        prob.model.add_design_var(
            name, lower=LOWER[name], upper=UPPER[name], ref=UPPER[name], ref0=LOWER[name]
        )
    prob.model.add_objective("misfit", ref=float(measured.size) * 100.0)
    prob.driver = sm.UnoDriver()
    prob.setup()
    return prob


@dataclass(frozen=True, eq=False)
class Identified:
    """What the data tell about constants, to first order around the optimum.

    Attributes
    ----------
    names : tuple of str
    values, deviations : ndarray, shape (k,)
        Constants and their standard deviations.
    covariance : ndarray, shape (k, k)
        noise^2 (J^T J)^-1, from the Gauss-Newton Hessian.
    singular_values : ndarray, shape (k,)
        Of J with each column times its constant, over the noise: a change of a constant by one part
        in the smallest of them is as large as the noise.
    """

    names: tuple
    values: np.ndarray
    deviations: np.ndarray
    covariance: np.ndarray
    singular_values: np.ndarray


def identified(prob: om.Problem, names, noise: float) -> Identified:
    """Covariance of the constants ``names`` from the exact derivatives of the force."""
    totals = prob.compute_totals(of=["force"], wrt=list(names))
    slope = np.column_stack([totals["force", name].ravel() for name in names])
    values = np.array([prob.get_val(name)[0] for name in names])
    covariance = noise**2 * np.linalg.inv(slope.T @ slope)
    singular = np.linalg.svd(slope * values / noise, compute_uv=False)
    return Identified(tuple(names), values, np.sqrt(np.diag(covariance)), covariance, singular)


def main(arguments) -> int:
    begun = time.perf_counter()
    if not arguments.noise > 0.0 or not np.isfinite(arguments.noise):
        raise WrongArgumentError(f"argument --noise: {arguments.noise} is not a positive number")
    bench = Bench(arguments.depth, arguments.steps)
    with checked_arguments():
        start = bench.readings(START)
    exact = bench.readings(TRUE)
    rng = np.random.default_rng(arguments.seed)
    measured = exact + arguments.noise * rng.normal(size=exact.size)
    prob = problem(bench, measured, arguments.noise)
    failed = prob.run_driver().success is False
    found = identified(prob, UNKNOWNS, arguments.noise)
    both = identified(prob, (*UNKNOWNS, "c01"), arguments.noise)
    fitted = prob.get_val("force").copy()
    summary = summarize(prob, bench, found, both, arguments) | {
        "optimum_found": not failed, "wall_s": time.perf_counter() - begun,
        "reading_mm_N_per_m": np.column_stack([bench.travel, measured, fitted]),
    }  # fmt: skip
    write_summary(arguments.out, summary)
    curves = {"start": start, "calibrated": fitted}
    figure = plotting.calibration_figure(
        bench.travel, measured, curves, found, TRUE, arguments.noise
    )
    plotting.save(figure, arguments.out / "calibration.png")
    report(summary, found, both, arguments.out)
    return 1 if failed else 0


def summarize(prob, bench, found: Identified, both: Identified, arguments) -> dict:
    """summary.json without what only ``main`` knows."""
    return {
        "constants": {
            name: {"true": TRUE[name], "start": START[name], "found": value, "deviation": deviation}
            for name, value, deviation in zip(
                UNKNOWNS, found.values, found.deviations, strict=True
            )
        },
        "correlation": found.covariance[0, 1] / np.prod(found.deviations),
        "with_c01": dict(zip(both.names, both.deviations, strict=True)),
        "singular_values": found.singular_values,
        "singular_values_with_c01": both.singular_values,
        "misfit_per_reading": prob.get_val("misfit")[0] / bench.travel.size,
        "readings": bench.travel.size,
        "noise_N_per_m": arguments.noise,
        "analyses": prob.driver.result.model_evals,
        "gradients": prob.driver.result.deriv_evals,
    }  # fmt: skip


def report(summary: dict, found: Identified, both: Identified, out) -> None:
    print(
        f"{summary['readings']} readings, {summary['analyses']} analyses, {summary['gradients']} "
        f"gradients, {summary['wall_s']:.1f} s"
    )
    for name, entry in summary["constants"].items():
        print(
            f"{name:9s} start {entry['start']:g}, found {entry['found']:.4g} +- "
            f"{entry['deviation']:.2g}, true {entry['true']:g}"
        )
    print(f"mean squared difference over noise^2: {summary['misfit_per_reading']:.3f}")
    loose = ", ".join(
        f"{name} +- {deviation:.2g}"
        for name, deviation in zip(both.names, both.deviations, strict=True)
    )
    print(f"with c01 unknown as well: {loose}")
    print("this curve determines little but the sum of c10 and c01")
    print(f"calibration.png and summary.json in {out}")


def arguments_parser():
    made = parser(__doc__.splitlines()[0], "out/calibration")
    made.add_argument("--noise", type=float, default=0.05, metavar="N/M", help="standard deviation")
    made.add_argument("--seed", type=int, default=1, metavar="N", help="seed of the noise")
    made.add_argument("--depth", type=float, default=10.0, metavar="MM", help="travel of the press")
    made.add_argument(
        "--steps", type=int, default=30, metavar="N", help="load steps of loading and of unloading"
    )
    return made


if __name__ == "__main__":
    sys.exit(run(arguments_parser(), main))
