"""Benchmarks as ratios measured in one run: ``python tests/benchmarks/run.py --out DIR``.

Not collected by pytest. BLAS is limited to one thread; the reference is one dense LU factorisation
and solution of the same order in SciPy on the same core.
"""

import argparse
import copy
import json
import os
import platform
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import openmdao.api as om
import scipy.linalg
from finite_elements import elements_figures
from threadpoolctl import threadpool_limits

import seal_mdao as sm
from seal_mdao.analysis.increment import Increment
from seal_mdao.analysis.load_path import solve_path
from seal_mdao.analysis.predictor import predict
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.dsa.sensitivity import particle_gradient
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.plotting.captions import today
from seal_mdao.seals.checks import findings

PATH_CLOUDS = (58, 3), (58, 5), (116, 5), (174, 7)
"""Radial rows and layers of complete paths."""
CLOUDS = ((58, 3), (116, 5), (174, 7), (290, 11), (580, 21), (754, 27))


def best(function, repeats):
    """Shortest time of several calls, s."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        function()
        times.append(time.perf_counter() - start)
    return min(times)


def processor_time(function):
    """Processor time of a call, s: other programs disturb it less than the time on the clock."""
    start = time.process_time()
    function()
    return time.process_time() - start


def dense_reference(n):
    """One dense LU factor-and-solve of order ``n``, s."""
    rng = np.random.default_rng(0)
    matrix, rhs = rng.random((n, n)) + n * np.eye(n), rng.random(n)
    return best(lambda: scipy.linalg.lu_solve(scipy.linalg.lu_factor(matrix), rhs), 30)


def kernel_times(seal):
    """Times of the parts of a Newton iteration at the end of the path, s."""
    result = sm.analyze(seal)
    disc, (before, step) = result.path.discretization, result.path.steps[-2:]
    problem, structure = result.path.problem, result.term("structure")
    rhs, layout = np.ones(disc.layout.n_equations), disc.layout
    raw = disc.transformation.coefficients(step.d)
    factor, at_step = problem.factorize_at(before), problem.assemble_at(step)
    increment = Increment(problem, step.fraction, before.after, result.seal.newton, before, factor)
    force, values = np.zeros(layout.force_size), np.zeros(layout.size)

    def internal():
        structure.add(step.d, raw, step.fraction, None, force, values)

    assemble = best(lambda: problem.assemble_at(step), 100)
    cells = best(internal, 100)
    return {
        "n_equations": layout.n_equations,
        "assembly": assemble,
        "assembly of cells": cells,
        "contact, condensation": assemble - cells,
        "factorisation": best(at_step.factorize, 100),
        "solution": best(lambda: factor.solve(rhs), 100),
        "predictor": best(lambda: predict(increment), 100),
    }


def analysis_figures(seal):
    """Analysis and sensitivities of the nominal seal: absolute times (ms) and ratios."""
    parts = kernel_times(seal)
    dense = dense_reference(parts["n_equations"])
    analysis = best(lambda: sm.analyze(seal), 7)
    result = sm.analyze(seal, keep_factors=True)
    iterations, measures = int(result.newton_iterations.sum()), result.measures()
    times = {
        (method, which): best(lambda f=function, m=method: f(result, method=m), 5)
        for method in ("direct", "adjoint")
        for which, function in (("26 parameters", sm.differentiate),)
    }
    times["adjoint", "all particle coordinates"] = best(
        lambda: particle_gradient(result, seal.inputs, measures, "adjoint"), 5
    )
    times["direct", "all particle coordinates"] = best(
        lambda: particle_gradient(result, seal.inputs, measures, "direct"), 1
    )
    iteration = parts["assembly"] + parts["factorisation"] + parts["solution"]
    return {
        "dense LU and solution, same order (ms)": 1e3 * dense,
        **{f"{name} (ms)": 1e3 * t for name, t in parts.items() if name != "n_equations"},
        "Newton iteration / dense": iteration / dense,
        "analysis (ms)": 1e3 * analysis,
        "analysis / dense": analysis / dense,
        "Newton iterations": iterations,
        **{f"{m}, {which} / analysis": t / analysis for (m, which), t in times.items()},
    }


def estimates():
    """Estimates of the time of an analysis, and of their own, over the time that it takes."""
    cases = {
        "58 x 3": {}, "116 x 5": {"rays": 116, "layers": 5}, "6 Gauss points": {"n_gauss": 6},
        "116 x 3, support 4": {"support": 4.0, "rays": 116},
        "58 x 9": {"layers": 9},
    }  # fmt: skip
    rows = {}
    for name, changes in cases.items():
        seal = sm.door_seal(**{"start": 9.6, "depth": 2.0, "n_steps": 21} | changes)
        sm.analyze(seal)  # compiles
        taken = best(lambda seal=seal: sm.analyze(seal), 3)
        rows[f"estimated / measured time, {name}"] = sm.estimate(seal).seconds / taken
    rows["time of an estimate (ms)"] = 1e3 * best(lambda: sm.estimate(sm.door_seal()), 3)
    return rows


def checks_figures(seal):
    """Checks of the end of the path over the analysis that found it."""
    path = sm.analyze(seal).path
    analysis = best(lambda: sm.analyze(seal), 5)
    checked = best(lambda: findings(copy.copy(path)), 5)
    return {"checks of the result / analysis": checked / analysis}


def openmdao_figures(seal):
    """``compute_totals`` over ``run_model``."""
    prob = om.Problem(sm.SealGroup(seal=seal), reports=None)
    prob.setup()
    design = np.zeros(seal.n_offsets)
    run, totals = [], []
    for k in range(4):
        design[:] = 1e-3 * k
        prob.set_val("boundary_offsets", design)
        run.append(best(prob.run_model, 1))
        of = ["gap_square_sum", "von_mises", "area", "reaction"]
        wrt = ["boundary_offsets", "door_radius"]
        totals.append(best(lambda of=of, wrt=wrt: prob.compute_totals(of, wrt), 1))
    return {"compute_totals / run_model": min(totals[1:]) / min(run[1:])}


def problem_of(seal):
    """The nominal seal with its terms."""
    terms = seal.terms()
    return PathProblem(discretize(seal.body, seal.nominal_particles, terms), terms)


def pressed_steps(seal):
    """Load steps after that of the first touch: their times (s), their iterations, and the path."""
    clock = []
    path = solve_path(
        problem_of(seal), seal.n_steps, seal.newton,
        callback=lambda step: clock.append(time.perf_counter()),
    )  # fmt: skip
    touched = int(np.argmax([response.branch.any() for response in path.at_nominal("door")]))
    return np.diff(clock)[touched:], path.newton_iterations[touched + 1 :], path


def tangent_time(path):
    """Assembly, factorisation and one solution at the end of a path, s."""
    problem, rhs = path.problem, np.ones(path.discretization.layout.n_equations)

    return best(lambda: problem.factorize_at(path.steps[-1]).solve(rhs), 3)


def growth(largest):
    """Times against the number of particles, and the fitted exponents.

    Load steps of 0.1 mm and their iterations are measured over six steps with the door in contact,
    without discretisation and first touch. The last kind is one Newton iteration by its parts.
    """
    sizes = []
    rows = {"load step": {}, "iteration": {}, "assembly, factorisation, solution": {}}
    for rays, layers in CLOUDS:
        if rays * layers > largest:
            break
        seal = sm.door_seal(rays=rays, layers=layers, start=9.6, depth=0.7, n_steps=8)
        runs = [pressed_steps(seal) for _ in range(5 if rays * layers < 5000 else 1)]
        times, iterations, path = min(runs, key=lambda run: run[0].sum())
        cloud = f"{rays} x {layers} particles (ms)"
        rows["load step"][cloud] = 1e3 * times.mean()
        rows["iteration"][cloud] = 1e3 * times.sum() / iterations.sum()
        rows["assembly, factorisation, solution"][cloud] = 1e3 * tangent_time(path)
        sizes.append(rays * layers)
    figures = {f"{kind}, {cloud}": t for kind, row in rows.items() for cloud, t in row.items()}
    if len(sizes) > 1:
        for kind, row in rows.items():
            slope = np.polyfit(np.log(sizes), np.log(list(row.values())), 1)[0]
            figures[f"growth exponent, {kind}"] = slope
    return figures | {
        "peak memory (MiB)": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    }


def path_growth():
    """Processor times of analyses of 35 load steps, and the exponent of their growth.

    The exponent is that of the first and the last cloud, log(t_n / t_1) / log(N_n / N_1).
    """
    sizes, times, figures = [], [], {}
    for rays, layers in PATH_CLOUDS:
        seal = sm.door_seal(rays=rays, layers=layers, n_steps=35)
        sm.analyze(seal)  # compiles kernels
        times.append(min(processor_time(lambda seal=seal: sm.analyze(seal)) for _ in range(5)))
        sizes.append(rays * layers)
        figures[f"{rays} x {layers} particles (s)"] = times[-1]
    exponent = np.log(times[-1] / times[0]) / np.log(sizes[-1] / sizes[0])
    return figures | {"growth exponent": float(exponent)}


def shares(largest):
    """Sensitivities over a short path that makes contact, against its analysis; factors kept."""
    rows = {}
    for rays, layers in CLOUDS:
        if rays * layers > largest:
            break
        seal = sm.door_seal(rays=rays, layers=layers, depth=0.3, n_steps=8)
        repeats = 3 if rays * layers < 5000 else 1
        analysis = best(lambda seal=seal: sm.analyze(seal), repeats)
        result = sm.analyze(seal, keep_factors=True)
        _ = result.measures()  # their places once for a seal, with an analysis of the nominal seal
        for method in ("direct", "adjoint"):
            time_of = best(lambda r=result, m=method: sm.differentiate(r, method=m), repeats)
            rows[f"{method} / analysis, {rays} x {layers} particles"] = time_of / analysis
    return rows


def start_up():
    """Import time beyond OpenMDAO's, and the first analysis with an empty kernel cache, s."""

    def run(code, **environment):
        start = time.perf_counter()
        subprocess.run([sys.executable, "-c", code], check=True, env={**os.environ, **environment})
        return time.perf_counter() - start

    base = min(run("import openmdao.api") for _ in range(3))
    both = min(run("import openmdao.api, seal_mdao") for _ in range(3))
    short = "import seal_mdao as sm; sm.analyze(sm.door_seal(depth=0.5, n_steps=10))"
    with tempfile.TemporaryDirectory() as folder:
        first = run(short, NUMBA_CACHE_DIR=folder)
        later = run(short, NUMBA_CACHE_DIR=folder)
    return {
        "import beyond OpenMDAO's (s)": both - base,
        "first analysis ever, kernels compiled (s)": first,
        "the same in a later process (s)": later,
    }


def machine() -> str:
    """Processor and versions."""
    names = (
        [
            line.split(":")[1].strip()
            for line in Path("/proc/cpuinfo").read_text().splitlines()
            if line.startswith("model name")
        ]
        if Path("/proc/cpuinfo").exists()
        else []
    )
    return (
        f"{names[0] if names else platform.processor()}, one core; Python "
        f"{platform.python_version()}, NumPy {np.__version__}, SciPy {scipy.__version__}"
    )


def page(figures) -> str:
    """The tables as Markdown."""
    lines = [f"Measured on {machine()}.", ""]
    for title, table in figures.items():
        lines += [f"| {title} | |", "|---|---|"]
        lines += [f"| {name} | {_text(value)} |" for name, value in table.items()]
        lines.append("")
    return "\n".join(lines)


def _text(value) -> str:
    return f"{value:.3g}" if isinstance(value, float) and value < 1000 else f"{value:.0f}"


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, help="write benchmarks.json and benchmarks.md there")
    parser.add_argument("--largest", type=int, default=21_000, help="largest cloud (particles)")
    parser.add_argument("--only", metavar="TITLE", help="measure one table, keep those of --out")
    arguments = parser.parse_args(argv)
    seal, largest = sm.door_seal(), arguments.largest
    tables = {
        "nominal seal, 174 particles": lambda: analysis_figures(seal),
        "checks of the result": lambda: checks_figures(seal),
        "estimates before an analysis": estimates,
        "through OpenMDAO": lambda: openmdao_figures(seal),
        '`accuracy="engineering"` beside finite elements': elements_figures,
        "analysis of 35 load steps": path_growth,
        "load steps of seals with many particles": lambda: growth(largest),
        "sensitivities of 8 steps": lambda: shares(largest),
        "start": start_up,
    }
    if arguments.only and arguments.only not in tables:
        parser.error(f"unknown table {arguments.only!r}; there are {', '.join(tables)}")
    stored = arguments.out / "benchmarks.json" if arguments.out else None
    kept = json.loads(stored.read_text(encoding="utf-8")) if arguments.only and stored else {}
    date = kept.pop("date", today())
    with threadpool_limits(1):
        measured = {
            title: table() for title, table in tables.items() if arguments.only in (None, title)
        }
    # a new table comes last; those of solvers that are not installed stay
    figures = kept | measured
    print(page(figures))
    if stored:
        arguments.out.mkdir(parents=True, exist_ok=True)
        stored.write_text(json.dumps({"date": date} | figures, indent=1))
        (arguments.out / "benchmarks.md").write_text(page(figures), encoding="utf-8")


if __name__ == "__main__":
    main()
