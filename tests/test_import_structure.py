"""Imports go one way, those within functions included; numerics know nothing of OpenMDAO."""

import ast
from graphlib import TopologicalSorter
from pathlib import Path

import seal_mdao

PACKAGE = Path(seal_mdao.__file__).parent
NUMERICS = (
    "accuracy", "analysis", "calibration", "contact", "dsa", "equilibrium", "geometry", "loads",
    "materials", "measures", "rkpm", "scenarios", "seals", "structure", "terms", "tolerances", "errors",
)  # fmt: skip


def _named(tree):
    """All that a module imports, by dotted name, longest first for each import."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ([alias.name] for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute here"
            yield from ([f"{node.module}.{alias.name}", node.module] for alias in node.names)


def imports():
    """What every module of the package imports: modules of the package, and names of others."""
    trees = {}
    for path in PACKAGE.rglob("*.py"):
        parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
        name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        trees[name] = ast.parse(path.read_text(encoding="utf-8"))
    return {
        name: {next((n for n in names if n in trees), names[-1]) for names in _named(tree)}
        for name, tree in trees.items()
    }


def own(graph):
    """The imports within the package alone."""
    return {name: {n for n in found if n in graph} for name, found in graph.items()}


def folder(module):
    """The folder, or the single module, right below the package."""
    return [*module.split("."), "seal_mdao"][1]


def folders(graph):
    between = {}
    for name, found in own(graph).items():
        between.setdefault(folder(name), set()).update(map(folder, found))
    return {name: found - {name} for name, found in between.items()}


def test_modules_import_each_other_one_way():
    assert list(TopologicalSorter(own(imports())).static_order())


def test_folders_import_each_other_one_way():
    assert list(TopologicalSorter(folders(imports())).static_order())


def test_live_section_is_imported_by_the_command_alone():
    """Analyses need neither its server nor the library of that."""
    graph = imports()
    users = {folder(name) for name in graph if "studio" in map(folder, graph[name])}
    assert users == {"cli", "studio"}
    assert {folder(name) for name in graph if "tornado" in str(graph[name])} == {"studio"}


def test_numerics_reach_no_openmdao():
    """Neither they nor anything that they import."""
    graph = imports()
    reached, waiting = set(), [name for name in graph if folder(name) in NUMERICS]
    while waiting:
        name = waiting.pop()
        if name not in reached:
            reached.add(name)
            waiting += own(graph)[name]
    users = {name for name in graph if any(n.split(".")[0] == "openmdao" for n in graph[name])}
    assert users
    assert not users & reached


def test_private_names_of_openmdao_are_in_one_module():
    """Attributes with a leading underscore of anything but ``self``, where OpenMDAO is imported."""
    found = {}
    for path in PACKAGE.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        if "openmdao" in text and path.name != "openmdao_access.py":
            found[path.name] = [
                node.attr
                for node in ast.walk(ast.parse(text))
                if isinstance(node, ast.Attribute)
                and node.attr.startswith("_")
                and not node.attr.startswith("__")
                and not (isinstance(node.value, ast.Name) and node.value.id in ("self", "cls"))
            ]
    assert len(found) > 10
    assert not {name: names for name, names in found.items() if names}
