"""Compare the estimated error of the forces at the default spacing with analyses of new particles.

    python tests/benchmarks/default_spacing.py examples/lip.toml examples/weatherstrip.toml

The error is 4/3 of the change of the force, if particles with half of the default spacing and twice as
many cells across the walls are generated, at the same load steps and penalties. The spacing, layers and
edge spacings that the files give are left out. An example takes 10 s to 3 minutes.
"""

import argparse
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

import seal_mdao as sm
from seal_mdao.accuracy.error_estimate import ORDER
from seal_mdao.accuracy.force_error import force_error
from seal_mdao.seals.file.chosen import chosen_for
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.outline.sizes import DEFAULT_LAYERS, start_spacing
from seal_mdao.seals.refined_steps import force_difference


def at_default(file: SealFile, refinement: int = 1) -> SealFile:
    """Return the file with the default spacing, divided by ``refinement``."""
    section = file.section
    spacing = float(f"{start_spacing(np.ptp(section.outline.box, axis=0)):.3g}") / refinement
    layers = 1 + refinement * (DEFAULT_LAYERS - 1)
    return replace(file, section=replace(section, spacing=spacing, layers=layers, edge_spacing={}))


def compared(path: Path) -> str:
    """Describe the errors of a file by new particles and by the estimate, and the times."""
    file = at_default(sm.read_seal_file(path))
    begun = time.process_time()
    seal = sm.build_seal(file)
    result = sm.analyze(seal)
    analysis = time.process_time() - begun
    begun = time.process_time()
    found = force_error(file, result)
    estimate = time.process_time() - begun
    fine = sm.analyze(sm.build_seal(at_default(file, 2), **chosen_for(file, seal)))
    change = "not known (no complete path)"
    if fine.converged:
        steps = np.arange(seal.n_steps)
        change = f"{100.0 * force_difference(result, fine, steps) / (1.0 - 0.5**ORDER):.2f} %"
    own = found.unknown if found.relative is None else f"{100.0 * found.relative:.2f} %"
    return (
        f"{path.stem}: {len(result.particles)} particles, by new particles {change}, estimate {own}; "
        f"analysis {analysis:.1f} s, estimate {estimate:.1f} s"
    )


def main(argv=None) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("file", nargs="+", type=Path, help="seal files")
    for path in parser.parse_args(argv).file:
        print(compared(path), flush=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
