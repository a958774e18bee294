"""Benchmarks as ratios measured in one run: ``python tests/benchmarks/run.py --out DIR``.

Not collected by pytest. BLAS is limited to one thread; the reference is one dense LU factorisation
and solution of the same order in SciPy on the same core.
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import openmdao.api as om
import scipy.linalg
from threadpoolctl import threadpool_limits

import seal_mdao as sm
from seal_mdao.analysis.body import discretize
from seal_mdao.analysis.loading import LoadPoint
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.contact.friction import no_history

CLOUDS = ((58, 3), (116, 5), (174, 7), (290, 11), (580, 21), (754, 27))


def best(function, repeats):
    """Shortest time of several calls, s."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        function()
        times.append(time.perf_counter() - start)
    return min(times)


def dense_reference(n):
    """One dense LU factor-and-solve of order ``n``, s."""
    rng = np.random.default_rng(0)
    matrix, rhs = rng.random((n, n)) + n * np.eye(n), rng.random(n)
    return best(lambda: scipy.linalg.lu_solve(scipy.linalg.lu_factor(matrix), rhs), 30)


def kernel_shares(model):
    """Times of the parts of a Newton iteration at the end of the path, s."""
    result = sm.analyze(model)
    disc, step = result.path.discretization, result.path.steps[-1]
    problem = PathProblem(disc, model.material, model.profile(result.door_radius), model.law)
    rhs = np.ones(disc.layout.n_equations)
    problem.assemble_at(step)
    factor = disc.layout.factorize(problem.values).kept()

    def factorize():
        problem.assemble_at(step)
        disc.layout.factorize(problem.values)

    assemble = best(lambda: problem.assemble_at(step), 100)
    return {
        "n_equations": disc.layout.n_equations,
        "assemble": assemble,
        "factorize": best(factorize, 100) - assemble,
        "solve": best(lambda: factor.solve(rhs), 100),
    }


def analysis_figures(model):
    """Analysis and sensitivities of the drawn seal, absolute (s) and as ratios."""
    parts = kernel_shares(model)
    dense = dense_reference(parts["n_equations"])
    analysis = best(lambda: sm.analyze(model), 5)
    result = sm.analyze(model, keep_factors=True)
    iterations = int(result.newton_iterations.sum())
    times = {
        m: best(lambda m=m: sm.differentiate(result, method=m), 5) for m in ("direct", "adjoint")
    }
    iteration = parts["assemble"] + parts["factorize"] + parts["solve"]
    return {
        **{f"{name}_ms": 1e3 * parts[name] for name in ("assemble", "factorize", "solve")},
        "dense_ms": 1e3 * dense,
        "iteration_over_dense": iteration / dense,
        "analysis_s": analysis,
        "analysis_over_dense": analysis / dense,
        "newton_iterations": iterations,
        "direct_over_analysis": times["direct"] / analysis,
        "adjoint_over_analysis": times["adjoint"] / analysis,
    }


def openmdao_figures(model):
    """``compute_totals`` over ``run_model``."""
    prob = om.Problem(sm.SealGroup(model=model), reports=None)
    prob.setup()
    design = np.zeros(model.n_offsets)
    run, totals = [], []
    for k in range(4):
        design[:] = 1e-3 * k
        prob.set_val("boundary_offsets", design)
        run.append(best(prob.run_model, 1))
        of = ["gap_square_sum", "von_mises", "area", "reaction"]
        wrt = ["boundary_offsets", "door_radius"]
        totals.append(best(lambda of=of, wrt=wrt: prob.compute_totals(of, wrt), 1))
    return {"totals_over_run_model": min(totals[1:]) / min(run[1:])}


def growth(largest):
    """Time of one Newton iteration against the number of particles, and the fitted exponent."""
    rows = []
    for rays, layers in CLOUDS:
        if rays * layers > largest:
            break
        model = sm.door_seal(rays=rays, layers=layers)
        disc = discretize(model.body, model.drawn_particles)
        problem = PathProblem(disc, model.material, model.profile(4.0), model.law)
        point = LoadPoint(np.array([0.0, 9.9]), None, None)
        history = no_history(len(model.body.contact))
        d, rhs = np.zeros_like(model.drawn_particles), np.ones(disc.layout.n_equations)

        def iteration(problem=problem, disc=disc, d=d, point=point, history=history, rhs=rhs):
            problem.assemble(d, point, history)
            disc.layout.factorize(problem.values).solve(rhs)

        rows.append((rays * layers, best(iteration, 3)))
    n, t = np.log(np.array(rows)).T
    return {
        "particles_and_seconds": rows,
        "exponent": float(np.polyfit(n, t, 1)[0]) if len(rows) > 1 else None,
        "peak_memory_MiB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    }


def start_up():
    """Import time beyond OpenMDAO's, and the first analysis with an empty kernel cache, s."""

    def run(code, **environment):
        start = time.perf_counter()
        subprocess.run([sys.executable, "-c", code], check=True, env={**_environ(), **environment})
        return time.perf_counter() - start

    base = min(run("import openmdao.api") for _ in range(3))
    both = min(run("import openmdao.api, seal_mdao") for _ in range(3))
    short = "import seal_mdao as sm; sm.analyze(sm.door_seal(depth=0.5, n_steps=10))"
    with tempfile.TemporaryDirectory() as folder:
        first = run(short, NUMBA_CACHE_DIR=folder)
        later = run(short, NUMBA_CACHE_DIR=folder)
    return {"import_extra_s": both - base, "first_analysis_s": first, "later_process_s": later}


def _environ():
    import os

    return dict(os.environ)


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, help="write benchmarks.json there")
    parser.add_argument("--largest", type=int, default=21_000, help="largest cloud (particles)")
    arguments = parser.parse_args(argv)
    model = sm.door_seal()
    with threadpool_limits(1):
        figures = {
            "analysis": analysis_figures(model),
            "openmdao": openmdao_figures(model),
            "growth": growth(arguments.largest),
            "start_up": start_up(),
        }
    for title, table in figures.items():
        print(title)
        for name, value in table.items():
            text = f"{value:.4g}" if isinstance(value, float) else value
            print(f"  {name:28} {text}")
    if arguments.out:
        arguments.out.mkdir(parents=True, exist_ok=True)
        (arguments.out / "benchmarks.json").write_text(json.dumps(figures, indent=1))


if __name__ == "__main__":
    main()
