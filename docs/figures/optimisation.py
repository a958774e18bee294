"""Problem (71) solved: the histories and the optimised shape."""

import tempfile
from pathlib import Path

import numpy as np

import seal_mdao as sm
from figures.drawing import DOOR_SEAL
from seal_mdao.analysis_cache import AnalysisCache
from seal_mdao.door_optimization import door_task
from seal_mdao.optimization import OPTIMIZERS, RunOptions, optimization_problem
from seal_mdao.plotting import constraint_history, cost_history, design_comparison, save
from seal_mdao.plotting.captions import captioned
from seal_mdao.recording.recorded_optimization import read_optimization

OPTIMIZER = next(iter(OPTIMIZERS))


@captioned(DOOR_SEAL)
def make(out: Path, reduced: bool) -> dict:
    """Pictures of the optimisation; two iterations in the reduced mode."""
    cache, driver = AnalysisCache(), OPTIMIZERS[OPTIMIZER](2 if reduced else 50)
    with tempfile.TemporaryDirectory() as folder:
        recorder = Path(folder) / "cases.sql"
        run = RunOptions(driver, recorder=recorder, cache=cache, work_dir=folder)
        problem = optimization_problem(door_task(run.analyze(sm.door_seal())), run)
        problem.run_driver()
        problem.cleanup()
        history = read_optimization(recorder)
    initial, final = (cache.analyze(history.seal, *history.design_at(i)) for i in (0, -1))
    save(cost_history(history), out / "cost_history.png")
    figure = constraint_history(history, initial.measure("von_mises").points)
    save(figure, out / "constraint_history.png")
    words = [f"{r.gap_square_sum:.2e} mm², {r.reaction[-1, 1]:.1f} N/m" for r in (initial, final)]
    save(design_comparison(initial, final, words), out / "optimised_seal.png")
    return {"text": _text(history, initial, final)}


def _text(history, initial, final) -> str:
    ratio = 100 * history.objective_ratio
    below = np.flatnonzero(ratio <= 0.75)
    reached = ""
    if below.size:
        reached = f"After {below[0]} iterations the cost is below 0.75 % of its start. "
    return (
        f"Starting from zero offsets, {OPTIMIZER} takes {len(ratio) - 1} major iterations and "
        f"{history.evaluations} analyses. {reached}The final cost is "
        f"{ratio[-1]:.2g} % of its start "
        f"({initial.gap_square_sum:.4f} to {final.gap_square_sum:.2e} mm²), with a largest relative "
        f"constraint violation of {history.max_violation[-1]:.1e}. The vertical reaction changes "
        f"from {initial.reaction[-1, 1]:.1f} to {final.reaction[-1, 1]:.1f} N/m. The paper reports "
        "0.75 % after 7 iterations."
    )
