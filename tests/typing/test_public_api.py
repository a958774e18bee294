"""The types of the public API: of the stub, and as a type checker sees them."""

import ast
import subprocess
import sys
from pathlib import Path

import seal_mdao as sm

ROOT = Path(__file__).parents[2]
WRONG = """
import seal_mdao as sm
result: int = sm.analyze(sm.door_seal())
sm.differentiate(sm.door_seal().n_steps, method=3)
sm.no_such_name
"""
ERRORS = ("[assignment]", "[arg-type]", "[attr-defined]")
"""Of each line in turn."""


def check(path):
    command = [sys.executable, "-m", "mypy", "--no-incremental", str(path)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


def test_the_stub_names_what_is_loaded():
    tree = ast.parse((ROOT / "seal_mdao" / "__init__.pyi").read_text())
    imports = [node for node in tree.body if isinstance(node, ast.ImportFrom)]
    stub = {(alias.asname, node.module) for node in imports for alias in node.names}
    assert stub == {*sm._LAZY.items()}


def test_the_public_api_has_its_types():
    done = check("tests/typing/public_api.py")
    assert done.returncode == 0, done.stdout


def test_wrong_use_is_reported(tmp_path):
    path = tmp_path / "wrong.py"
    path.write_text(WRONG)
    lines = check(path).stdout.splitlines()
    found = [line for line in lines if ": error: " in line]
    assert len(found) == len(ERRORS), lines
    assert all(line.endswith(error) for line, error in zip(found, ERRORS, strict=True)), lines
