"""The wheel in folders that users have: not writable, with spaces and umlauts, upgraded in place."""

import hashlib
import json

import pytest

from seal_mdao.compilation import MESSAGE

pytestmark = pytest.mark.long

ANALYSIS = """
import json
import seal_mdao as sm
result = sm.analyze(sm.door_seal(depth=1.0, n_steps=8))
print(json.dumps([sm.__file__, result.converged, result.reaction.tolist()]))
"""
GRADIENT = """
import numpy as np
import seal_mdao.rkpm.shape_functions as shapes
from seal_mdao.structure.particle_stress import deformation_gradients

table = shapes.ShapeTable(
    np.array([0, 3]), np.arange(3), np.full(3, 1 / 3), np.array([-1.0, 1, 0, -1, 0, 1]), 1
)
d = np.array([[0.0, 0.0], [0.1, 0.0], [0.02, -0.05]])
print(deformation_gradients(table, d)[0, 0])
"""
AND_A_CHILD = """
import subprocess, sys
print(subprocess.run([sys.executable, "-B", "-c", GRADIENT], check=True, capture_output=True))
"""


def files_of(folder):
    """Every file under a folder with a digest of what it holds."""
    return {
        path.relative_to(folder): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in folder.rglob("*")
        if path.is_file()
    }


def close_caches(folder):
    """No cache can be made beside the modules, by root either: a file is in its place."""
    for module_folder in {path.parent for path in folder.rglob("*.py")}:
        (module_folder / "__pycache__").touch()
    for path in folder.rglob("*"):
        path.chmod(0o555 if path.is_dir() else 0o444)


def test_read_only_folder_with_spaces_and_umlauts_and_two_processes_at_once(
    tmp_path, install, start
):
    folder, home = tmp_path / "Türen & Dichtungen, größer", tmp_path / "my häuschen"
    install(folder)
    close_caches(folder)
    home.mkdir()
    before = files_of(folder)
    both = [run.lines() for run in [start(folder, ANALYSIS, home) for _ in range(2)]]
    again, said = start(folder, ANALYSIS, home).lines()
    origin, converged, reaction = json.loads(again[-1])
    assert origin.startswith(str(folder))
    assert converged
    assert max(abs(force) for pair in reaction for force in pair) > 1.0
    assert [lines for lines, _ in both] == [again, again]
    # the kernels were compiled into the user's cache, and found there
    assert all(MESSAGE in errors for _, errors in both)
    assert said == ""
    assert files_of(folder) == before


def test_without_any_writable_folder_one_warning_and_a_temporary_cache(tmp_path, install, start):
    """Processes that the command starts use the same cache and say nothing again."""
    folder, scratch = tmp_path / "site-packages", tmp_path / "tmp"
    install(folder)
    close_caches(folder)
    scratch.mkdir()
    code = GRADIENT + f"GRADIENT = {GRADIENT!r}\n" + AND_A_CHILD
    run = start(folder, code, "/dev/null", TMPDIR=str(scratch))
    (own, child), errors = run.lines()
    assert errors.count("NUMBA_CACHE_DIR") == 1
    assert errors.count(MESSAGE) == 1
    assert f"stdout=b'{own}\\n'" in child
    assert "stderr=b''" in child
    assert list(scratch.iterdir()) == []


def test_cache_folder_chosen_by_the_user_is_kept(tmp_path, install, start):
    folder, chosen = tmp_path / "site-packages", tmp_path / "chosen"
    install(folder)
    close_caches(folder)
    said = [
        start(folder, GRADIENT, "/dev/null", NUMBA_CACHE_DIR=str(chosen)).lines()[1]
        for _ in range(2)
    ]
    assert said == [MESSAGE + "\n", ""]


def test_upgrade_over_the_kernel_cache_of_an_older_version(tmp_path, install, start):
    """The older one had other gradients, in a file that their caller does not see change, and a type
    in a module that is no longer there.
    """
    folder = tmp_path / "site-packages"
    install(folder)
    package = folder / "seal_mdao"
    (new,), _ = start(folder, GRADIENT, tmp_path, NUMBA_CACHE_DIR=str(tmp_path / "other")).lines()
    inner, shapes = (
        package / "structure" / "deformation.py",
        package / "rkpm" / "shape_functions.py",
    )
    for path, found, older in (
        (inner, "g11 += displacement[0, i] * a", "g11 += 4.0 * displacement[0, i] * a"),
        (shapes, "class ShapeTable(NamedTuple)", "class _Unused(NamedTuple)"),
        (shapes, "class Cloud(", "from seal_mdao.rkpm.gone import ShapeTable\n\n\nclass Cloud("),
    ):
        text = path.read_text(encoding="utf-8")
        assert text.count(found) == 1
        path.write_text(text.replace(found, older), encoding="utf-8")
    gone = package / "rkpm" / "gone.py"
    gone.write_text(
        "from typing import NamedTuple\n\nimport numpy as np\n\n\nclass ShapeTable(NamedTuple):\n"
        "    start: np.ndarray\n    neighbours: np.ndarray\n    phi: np.ndarray\n"
        "    grad: np.ndarray\n    group_size: int\n    n_groups = 1\n",
        encoding="utf-8",
    )
    (old,), said = start(folder, GRADIENT, tmp_path).lines()
    assert MESSAGE in said
    assert abs(float(old) / float(new) - 1.0) > 0.1
    gone.unlink()
    install(folder)
    (upgraded,), said = start(folder, GRADIENT, tmp_path).lines()
    assert upgraded == new
    assert MESSAGE in said


def test_removing_the_package_leaves_nothing(tmp_path, install, start):
    """What pip did not bring it leaves, and Python takes a folder without modules for a package."""
    folder = tmp_path / "site-packages"
    install(folder)
    before = files_of(folder)
    start(folder, GRADIENT, tmp_path).lines()
    assert files_of(folder) == before
    assert list(tmp_path.rglob("*.nbc"))
