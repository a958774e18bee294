"""Analyse a seal and write an animation of its closing: section with stress, force over travel."""

from pathlib import Path

from tqdm import tqdm

from seal_mdao.cli.analyze import analyzed
from seal_mdao.cli.arguments import checked_arguments, parser
from seal_mdao.cli.seal_files import file_of
from seal_mdao.plotting.animation import check_format, save_animation
from seal_mdao.progress import hidden


def main(arguments) -> int:
    path = arguments.animation
    path = path if path.is_absolute() else arguments.out / path
    with checked_arguments():
        # an unknown ending or missing ffmpeg fails before the analysis
        check_format(path)
    # as the folder of --out
    path.parent.mkdir(parents=True, exist_ok=True)
    _, result, _ = analyzed(file_of(arguments.file))
    # nothing to animate without a converged load step
    if not len(result.path.nominal_steps):
        print(f"NOT CONVERGED: {result.failure}")
        return 1
    with tqdm(unit="frame", desc="animation", disable=hidden(), leave=False) as bar:
        save_animation(result, path, arguments.fps, lambda number, of: bar.update())
    # an incomplete path is still animated
    if not result.converged:
        print(f"NOT CONVERGED: {result.failure}")
    print(path)
    return 0 if result.converged else 1


def arguments_parser():
    made = parser(__doc__, ".", "FILE", "seal-mdao animate bulb.toml -o close.gif")
    made.add_argument("file", type=Path, metavar="FILE", help="seal file (TOML)")
    made.add_argument(
        "-o", dest="animation", type=Path, default=Path("close.gif"), metavar="NAME",
        help="file to write: .gif, .html or .mp4 (needs the program ffmpeg)",
    )  # fmt: skip
    made.add_argument("--fps", type=int, default=12, metavar="N", help="frames per second")
    return made
