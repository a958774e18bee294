"""Save designs of the page as seal files with drawing and particles, by ``write_design``."""

import tomllib
from importlib import import_module
from pathlib import Path

from seal_mdao.seals.file.export import on_lines, write_design
from seal_mdao.studio.workbench import Workbench


def save_design(bench: Workbench, design: list, folder, name: str) -> list[Path]:
    """Write a design as NAME.toml with NAME.dxf and NAME.vtu; an analysis of the seal file gives
    the same results.

    Parameters
    ----------
    bench : Workbench
    design : list of float
        Values of all numbers.
    folder : str or Path
        That of the seal file.
    name : str

    Raises
    ------
    GeometryError
        For a boundary that crosses itself.
    ImportError
        Without ezdxf, meshio or tomli-w.
    """
    offsets, parameters = bench.split(design)
    seal = bench.seal.with_parameters(parameters)
    # profiles that have been moved into the section are written with their interference
    file = bench.placed(design)
    paths = write_design(file, seal, offsets, bench.measures, folder, name)
    text = paths[0].read_text(encoding="utf-8")
    # the comment of ``write_design`` stays
    head = "".join(line for line in text.splitlines(True) if line.startswith("#"))
    tables = tomllib.loads(text)
    bench.write_numbers(tables, design)
    tables = import_module("tomli_w").dumps(tables)
    paths[0].write_text(head + on_lines(tables), encoding="utf-8")
    return paths
