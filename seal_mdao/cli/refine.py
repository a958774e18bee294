"""Choose the particle spacing so that the estimated errors of the measures are at most PERCENT."""

import json
import os
import re
import tomllib
from pathlib import Path

from seal_mdao import plotting
from seal_mdao.accuracy.chosen_spacing import Cloud, refine
from seal_mdao.cli.arguments import WrongArgumentError, parser, percentage, write_summary
from seal_mdao.cli.error_table import error_summary, print_errors
from seal_mdao.cli.seal_files import file_errors, file_of
from seal_mdao.progress import LoadStepProgress
from seal_mdao.seals.file.described import named_in
from seal_mdao.seals.result import unloaded


def main(arguments) -> int:
    file, tried = file_of(arguments.file), []
    written = arguments.out / f"{arguments.file.stem}.toml"
    if written.resolve() == arguments.file.resolve():
        raise WrongArgumentError(
            f"argument --out: {written} is the seal file itself and would be overwritten; choose "
            "another folder"
        )
    with file_errors(arguments.file):
        require_line(arguments.file)

    def report(cloud: Cloud) -> None:
        tried.append(cloud)
        section = cloud.file.section
        name, error = cloud.worst(arguments.measures or [own.name for own in file.measures])
        print(
            f"spacing {section.spacing:g} mm, {section.layers} layers, "
            f"{len(cloud.result.particles)} particles: error up to {100.0 * error:.2g} % ({name})",
            flush=True,
        )

    with file_errors(arguments.file), LoadStepProgress(None, "error estimate") as progress:
        found = refine(file, arguments.to, arguments.measures, report, progress)
    print_errors(found.estimates, found.result)
    plotting.save(plotting.error_parts(found.estimates), arguments.out / "errors.png")
    plotting.save(
        plotting.section_cloud(unloaded(found.result.seal)), arguments.out / "section.png"
    )
    written.write_text(refined_text(arguments.file, found, arguments.out), encoding="utf-8")
    clouds = [
        {
            "spacing_mm": cloud.file.section.spacing, "layers": cloud.file.section.layers,
            "n_particles": len(cloud.result.particles), "errors": error_summary(cloud.estimates),
        }
        for cloud in tried
    ]  # fmt: skip
    write_summary(
        arguments.out, {"tolerance": arguments.to, "clouds": clouds, "file": written.name}
    )
    print(
        f"{written} has this spacing; errors.png, section.png and summary.json are in the same "
        "folder"
    )
    return 0


SPACING = re.compile(r"(?m)^spacing\s*=.*$")
"""Line of a seal file with the spacing."""


def require_line(path: Path) -> None:
    """Raise ValueError for a seal file without a line of its own for ``spacing``."""
    if not SPACING.search(path.read_text(encoding="utf-8")):
        raise ValueError(
            "the key spacing of [section] must be on a separate line of the seal file, spacing = "
            "..., so that its value can be replaced"
        )


def refined_text(path: Path, cloud: Cloud, folder: Path) -> str:
    """Write the chosen distances into the text of a seal file, whose other lines stay as they are.

    Paths of files beside it become relative to ``folder``.
    """
    text, section = path.read_text(encoding="utf-8"), cloud.file.section
    for name in named_in(tomllib.loads(text)):
        moved = Path(os.path.relpath(path.parent / name, folder)).as_posix()
        text = text.replace(json.dumps(name), json.dumps(moved)).replace(f"'{name}'", f"'{moved}'")
    lines = [f"spacing = {section.spacing:g}", f"layers = {section.layers}"]
    if section.edge_spacing:
        sizes = ", ".join(f"{name} = {h:g}" for name, h in section.edge_spacing.items())
        lines.append(f"edge_spacing = {{ {sizes} }}")
    # old lines of these keys, then the new ones where spacing was
    text = re.sub(r"(?m)^(layers|edge_spacing)\s*=.*\n", "", text)
    return SPACING.sub("\n".join(lines), text, count=1)


def arguments_parser():
    made = parser(__doc__, "out/refined", "FILE", "seal-mdao refine bulb.toml --to 1")
    made.add_argument(
        "file", type=Path, metavar="FILE", help="seal file (TOML) with spacing in [section]"
    )
    made.add_argument(
        "--to", type=percentage, default=0.01, metavar="PERCENT",
        help="allowed estimated numerical error of every measure, in percent of its value",
    )  # fmt: skip
    made.add_argument(
        "--measures",
        nargs="+",
        metavar="NAME",
        help="measures of the seal file to which the allowed error applies; default: all",
    )
    return made
