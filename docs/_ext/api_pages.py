"""One page of the programming reference for every folder of the package, made at each build."""

import pkgutil
from importlib import import_module
from pathlib import Path

import seal_mdao

TITLES = {
    "": "Model, analysis, errors",
    "design": "Design parameters",
    "geometry": "Geometry",
    "rkpm": "Reproducing kernel particle method",
    "materials": "Material",
    "calibration": "Constants from tests",
    "contact": "Contact",
    "analysis": "Analysis",
    "measures": "Measures",
    "dsa": "Design sensitivity analysis",
    "scenarios": "Scenarios",
    "tolerances": "Tolerances",
    "components": "OpenMDAO components",
    "drivers": "OpenMDAO drivers",
    "recording": "Recorder files",
    "plotting": "Figures",
    "report": "HTML report",
    "verification": "Benchmarks",
}


def modules() -> dict[str, list[str]]:
    """Modules of the package by folder; those beside the folders under the empty name."""
    found = {folder: [] for folder in TITLES}
    for info in pkgutil.walk_packages(seal_mdao.__path__, "seal_mdao."):
        parts = info.name.split(".")
        if info.ispkg or parts[-1].startswith("_"):
            continue
        found.setdefault(parts[1] if len(parts) > 2 else "", []).append(info.name)
    return found


def page(folder: str, names: list[str]) -> str:
    """MyST text of one folder's page."""
    lines = [f"# {TITLES.get(folder, folder)}", ""]
    if folder:
        text = import_module(f"seal_mdao.{folder}").__doc__ or ""
        lines += [f"`seal_mdao.{folder}`. {text.splitlines()[0] if text else ''}", ""]
    for name in names:
        lines += [f"## {name.removeprefix('seal_mdao.')}", "", "```{eval-rst}"]
        lines += [f".. automodule:: {name}", "   :members:", "   :show-inheritance:", "```", ""]
    return "\n".join(lines)


def write_all(folder: Path) -> None:
    """Write the pages and drop those of folders that are gone."""
    folder.mkdir(parents=True, exist_ok=True)
    texts = {key or "top": page(key, names) for key, names in modules().items() if names}
    for old in folder.glob("*.md"):
        if old.stem not in texts:
            old.unlink()
    for name, text in texts.items():
        path = folder / f"{name}.md"
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
