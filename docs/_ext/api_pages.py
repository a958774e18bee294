"""One page of the programming reference for every folder of the package and for the benchmarks of
the tests (``tests/verification``), made at each build."""

import pkgutil
from importlib import import_module
from pathlib import Path

import verification

import seal_mdao

TITLES = {
    "seal_mdao": "Model, analysis, errors",
    "design": "Design parameters",
    "geometry": "Geometry",
    "rkpm": "Reproducing kernel particle method",
    "materials": "Material",
    "calibration": "Constants from tests",
    "contact": "Contact",
    "equilibrium": "Discretisation and linear solvers",
    "analysis": "Analysis",
    "measures": "Measures",
    "accuracy": "Error bars",
    "dsa": "Design sensitivity analysis",
    "scenarios": "Scenarios",
    "tolerances": "Tolerances",
    "components": "OpenMDAO components",
    "drivers": "OpenMDAO drivers",
    "recording": "Recorder files",
    "plotting": "Figures",
    "report": "HTML report",
    "studio": "Live section",
    "verification": "Benchmarks",
}


def modules() -> dict[str, list[str]]:
    """Modules by package, those beside the folders under ``seal_mdao``; tests are left out."""
    found = {}
    for package in (seal_mdao, verification):
        root = package.__name__
        for info in pkgutil.walk_packages(package.__path__, f"{root}."):
            *parents, name = info.name.split(".")
            if not info.ispkg and not name.startswith(("_", "test_", "conftest")):
                found.setdefault(".".join(parents[:2]), []).append(info.name)
    return found


def page(package: str, names: list[str]) -> str:
    """MyST text of one folder's page."""
    folder = package.rpartition(".")[2]
    lines = [f"# {TITLES.get(folder, folder)}", ""]
    if package != "seal_mdao":
        text = import_module(package).__doc__ or ""
        lines += [f"`{package}`. {text.splitlines()[0] if text else ''}", ""]
    for name in names:
        lines += [f"## {name.removeprefix('seal_mdao.')}", "", "```{eval-rst}"]
        lines += [f".. automodule:: {name}", "   :members:", "   :show-inheritance:", "```", ""]
    return "\n".join(lines)


def write_all(folder: Path) -> None:
    """Write the pages and drop those of folders that are gone."""
    folder.mkdir(parents=True, exist_ok=True)
    texts = {
        "top" if package == "seal_mdao" else package.rpartition(".")[2]: page(package, names)
        for package, names in modules().items()
    }
    for old in folder.glob("*.md"):
        if old.stem not in texts:
            old.unlink()
    for name, text in texts.items():
        path = folder / f"{name}.md"
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
