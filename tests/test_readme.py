"""The README's script and commands are what they claim to be."""

import re
from pathlib import Path

import pytest

import seal_mdao as sm
from seal_mdao.cli.subcommands import COMMANDS

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()


def code_blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def test_script_closes_the_gap(tmp_path, monkeypatch, capsys):
    """The script's optimum: less than 0.75 % of the start, feasible."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("OPENMDAO_REPORTS", "0")
    (script,) = code_blocks("python")
    names = {}
    exec(compile(script, "README.md", "exec"), names)
    prob, start = names["prob"], names["start"]
    ratio = prob.get_val("gap_square_sum")[0] / start.gap_square_sum
    assert ratio <= 0.0075
    assert (prob.get_val("von_mises") <= (0.8 * start.von_mises).clip(100.0) * 1.001).all()
    assert prob.get_val("area")[0] <= 110.0 * 1.001
    printed = float(capsys.readouterr().out.split()[-1].strip("[]"))
    assert printed == pytest.approx(ratio, rel=1e-6)


def test_ci_runs_the_readme_test_command():
    _, command, *_ = (block.strip() for block in code_blocks("sh"))
    assert command in (ROOT / ".ci" / "run").read_text().splitlines()


def test_the_documentation_is_built_as_the_readme_says():
    """By the same commands as in .ci/run, which stops at warnings as well, beside other tests."""
    *_, command = (block.strip() for block in code_blocks("sh"))
    install, build = command.split(" && ")
    lines = [line.removesuffix(" &") for line in (ROOT / ".ci" / "run").read_text().splitlines()]
    assert install.replace("install", "install -q", 1) in lines
    assert build.replace("sphinx", "sphinx -W -q", 1) in lines


def test_the_seal_file_of_the_readme_can_be_analysed():
    """tests/run_scripts run the script; the examples have tests of their own."""
    _, _, command, _ = (block.strip() for block in code_blocks("sh"))
    *_, program, name, file, _, _ = command.split()
    assert program.endswith("/seal-mdao")
    assert name in COMMANDS
    assert sm.read_seal_file(ROOT / file).measures


def test_links_and_folders_exist():
    for target in re.findall(r"\]\((?!http)([^)]+)\)", README):
        assert (ROOT / target).exists(), target
    for folder in re.findall(r"`([\w/]+)`(?=[,| ])", README):
        if "/" in folder or folder in ("run_scripts", "docs", "tests"):
            assert (ROOT / folder).exists(), folder


def test_the_seal_file_shown_can_be_built(tmp_path):
    """Its load steps and penalties are chosen when it is built; here they are given, to save time."""
    (text,) = code_blocks("toml")
    text = (
        text.replace("-4.0] }]", "-4.0], steps = 8 }]")
        + "normal_penalty = 1e4\ntangent_penalty = 1e2\n"
    )
    path = tmp_path / "seal.toml"
    path.write_text(text)
    result = sm.analyze(sm.build_seal(path))
    assert result.converged
    assert not [line for line in result.warnings if "layers of particles" in line]


def test_the_numbers_are_those_of_their_sources():
    """Costs of analysis and adjoint method, optimum of the paper's case, accuracy of ``engineering``."""
    analysis, cost, ratio, iterations = (
        re.search(rf"\| {words}.*?\| {number}", README)[1]
        for words, number in (
            ("time of an analysis with this setting, relative to a finite element", r"([\d.]+) \|"),
            ("time for all 26 shape derivatives", r"([\d.]+) \|"),
            ("sum of squared gaps at the optimum", r"([\d.]+) %"),
            ("sum of squared gaps at the optimum", r".*? in (\d+) iterations"),
        )
    )
    benchmarks = (ROOT / "docs" / "benchmarks" / "benchmarks.md").read_text()
    for benchmark, quoted in (
        ("adjoint, 26 parameters / analysis", cost),
        ("corner door: analysis / finite elements", analysis),
    ):
        (measured,) = re.findall(rf"\| {re.escape(benchmark)} \| ([\d.]+)", benchmarks)
        assert f"{float(measured):.1g}" == quoted, benchmark
    matrix = (ROOT / "docs" / "optimisation_matrix.md").read_text()
    assert re.search(rf"\| paper \| {iterations} iterations, \d+ analyses, {ratio} %", matrix)
    index = (ROOT / "docs" / "verification" / "index.md").read_text()
    (force,) = re.findall(r"engineering.*?\| ([\d.]+ %),", index)
    assert f"within {force} |" in README


def test_the_animation_is_small():
    assert (ROOT / "docs" / "_static" / "seal_closing.gif").stat().st_size <= 600_000
