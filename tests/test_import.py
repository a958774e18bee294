"""What importing loads: the numerics need no OpenMDAO, and the package itself is light."""

import json
import subprocess
import sys
from importlib import metadata

import pytest

import seal_mdao as sm

BLOCK = """
import importlib.abc, sys

class Block(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] == "openmdao":
            raise ImportError("openmdao is blocked")

sys.meta_path.insert(0, Block())
"""

NUMERICS = """
import importlib, pkgutil, json
import seal_mdao
names = []
for folder in ("analysis", "calibration", "contact", "dsa", "equilibrium", "geometry", "loads",
               "materials", "measures", "rkpm", "scenarios", "seals", "structure", "terms",
               "tolerances"):
    package = importlib.import_module("seal_mdao." + folder)
    for module in pkgutil.walk_packages(package.__path__, f"seal_mdao.{folder}."):
        names.append(importlib.import_module(module.name).__name__)
names.append(importlib.import_module("seal_mdao.errors").__name__)
model = seal_mdao.door_seal(depth=2.0, n_steps=10)
result = seal_mdao.analyze(model)
rates = seal_mdao.differentiate(result)
try:
    seal_mdao.SealGroup
    blocked = False
except ImportError:
    blocked = True
print(json.dumps([names, result.converged, rates.von_mises.shape, blocked,
                  [n for n in ("openmdao", "matplotlib", "tqdm") if n in sys.modules]]))
"""


def run(code):
    """The last line that a fresh interpreter prints, as JSON."""
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def test_numerics_run_without_openmdao():
    """All numeric modules, a path and its sensitivities with OpenMDAO blocked; no plotting."""
    names, converged, shape, blocked, loaded = run(BLOCK + NUMERICS)
    assert {"seal_mdao.dsa.sensitivity", "seal_mdao.seals.door.door_seal"} < set(names)
    assert converged
    assert shape == [7, 26]
    assert blocked
    assert loaded == []


def test_importing_the_package_is_light():
    heavy = ("openmdao", "numba", "scipy", "matplotlib", "numpy", "tqdm")
    code = "import seal_mdao, sys, json; print(json.dumps([n for n in {} if n in sys.modules]))"
    assert run(code.format(heavy)) == []


def test_every_public_name_can_be_loaded():
    for name in sm.__all__:
        assert getattr(sm, name) is getattr(sm, name)
    assert set(sm.__all__) <= set(dir(sm))


def test_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no_such_name"):
        _ = sm.no_such_name


def test_version_is_that_of_the_installed_package():
    assert sm.__version__ == metadata.version("seal_mdao")


@pytest.mark.parametrize(
    "group", ["openmdao_component", "openmdao_group", "openmdao_driver", "openmdao_command",
              "openmdao_report"]
)  # fmt: skip
def test_entry_points_load(group):
    """At submodules, so that OpenMDAO lists them under the package's name."""
    ours = [e for e in metadata.entry_points(group=group) if e.value.startswith("seal_mdao")]
    if group in ("openmdao_component", "openmdao_group"):
        assert ours
    for entry in ours:
        assert entry.value.split(":")[0].count(".") >= 1
        assert callable(entry.load()) or isinstance(entry.load(), tuple)
