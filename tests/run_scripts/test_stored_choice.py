"""What a command has chosen for a seal file is stored for the next command on the same file."""

import json
import os
import time

import numpy as np
import pytest
from coarse_seal import OPEN, written

import seal_mdao as sm
from seal_mdao import registry, stored_choice, user_cache
from seal_mdao.cli import seal_files
from seal_mdao.seals.file import build
from seal_mdao.studio.workbench import Workbench

STORED = "(by an earlier command)"


@pytest.fixture
def choices(tmp_path, monkeypatch):
    """Folder of stored choices of one test, in which no extensions are registered."""
    folder = tmp_path / "choices"
    monkeypatch.setenv(user_cache.FOLDER, str(folder))
    monkeypatch.setattr(registry, "_registered", {})
    return folder


@pytest.fixture
def made(monkeypatch):
    """Seals for which load steps and penalties have been chosen."""
    found, choose = [], build.choose

    def counted(seal, *arguments, **others):
        found.append(seal)
        return choose(seal, *arguments, **others)

    monkeypatch.setattr(build, "choose", counted)
    return found


def stored(folder):
    """Choices in a folder."""
    return sorted(folder.glob("choice-*"))


def seal_of(path):
    """Build the seal of a file as the commands do."""
    return seal_files.seal_of(seal_files.file_of(path))[1]


def test_a_second_command_chooses_nothing_and_has_the_same_results(
    tmp_path, choices, made, run_script, capsys
):
    path = written(tmp_path, OPEN)
    codes, summaries, printed = [], [], []
    for number in (1, 2):
        code, summary = run_script("analyze", tmp_path / str(number), path, "--no-vtu")
        codes.append(code)
        summaries.append({name: value for name, value in summary.items() if name != "wall_s"})
        printed.append(capsys.readouterr().out)
    assert codes == [0, 0]
    assert len(made) == 1
    # the same bits
    assert summaries[0] == summaries[1]
    chosen = [[line for line in text.splitlines() if " chosen for an " in line] for text in printed]
    assert len(chosen[0]) == 2
    assert [f"{line} {STORED}" for line in chosen[0]] == chosen[1]


def test_a_changed_file_is_another_choice(tmp_path, choices, made):
    seal_of(written(tmp_path, OPEN))
    seal_of(written(tmp_path, OPEN | {"[0.0, -1.2]": "[0.0, -1.1]"}))
    assert len(made) == 2
    assert len(stored(choices)) == 2


def test_a_changed_drawing_is_another_choice(tmp_path, choices, made, monkeypatch):
    path, contents = written(tmp_path, OPEN), stored_choice.contents
    seal_of(path)
    # packed contents of files beside the seal file
    monkeypatch.setattr(
        stored_choice, "contents", lambda file: contents(file) | {"beside": {"a.dxf": "eJw="}}
    )
    seal_of(path)
    assert len(made) == 2


def test_other_code_is_another_choice(tmp_path, choices, made, monkeypatch):
    path = written(tmp_path, OPEN)
    seal_of(path)
    for number in (1, 2):
        package = tmp_path / f"package_{number}"
        package.mkdir()
        (package / "new.py").write_text(f"constant = {number}\n")
        monkeypatch.setattr(user_cache, "PACKAGE", package)
        seal_of(path)
    assert len(made) == 3
    seal_of(path)
    assert len(made) == 3


def test_nothing_is_stored_with_extensions(tmp_path, choices, made):
    path = written(tmp_path, OPEN)
    sm.registry.register("friction_laws", "own_law", lambda pressure, friction: friction * pressure)
    for _ in range(2):
        seal_of(path)
    assert len(made) == 2
    assert not stored(choices)


def test_nothing_is_stored_without_a_folder(tmp_path, choices, made, monkeypatch):
    monkeypatch.setenv(user_cache.FOLDER, "")
    path = written(tmp_path, OPEN)
    for _ in range(2):
        seal_of(path)
    assert len(made) == 2
    assert not choices.exists()


def test_steps_with_a_larger_error_are_chosen_again(tmp_path, choices, made, monkeypatch):
    """Their warning has the error that only the choice knows."""
    path, choose = written(tmp_path, OPEN), build.choose

    def inaccurate(*arguments, **others):
        found = choose(*arguments, **others)
        object.__setattr__(found.seal, "step_error", 0.2)
        return found

    monkeypatch.setattr(build, "choose", inaccurate)
    assert any("20.0%" in text for text in seal_of(path).warnings)
    assert any("20.0%" in text for text in seal_of(path).warnings)
    assert len(made) == 2


@pytest.mark.parametrize("content", ["", '{"step_ends": [0.', "\udcff"])
def test_a_damaged_file_is_replaced(tmp_path, choices, made, content):
    path = written(tmp_path, OPEN)
    seal_of(path)
    (own,) = stored(choices)
    whole = own.read_text()
    own.write_bytes(content.encode(errors="surrogateescape"))
    seal_of(path)
    assert len(made) == 2
    assert own.read_text() == whole
    assert json.loads(whole).keys() == {"step_ends", "penalties"}


def test_a_folder_that_is_a_file_is_no_error(tmp_path, choices, made):
    choices.write_text("")
    path = written(tmp_path, OPEN)
    for _ in range(2):
        seal_of(path)
    assert len(made) == 2


def test_unused_choices_are_deleted(tmp_path, choices):
    paths = [choices / f"{name}.json" for name in ("unused", "used")]
    choices.mkdir()
    now = time.time()
    for path, age in zip(paths, (1.1, 0.9), strict=True):
        path.write_text("{}")
        os.utime(path, (now, now - age * user_cache.UNUSED))
    seal_of(written(tmp_path, OPEN))
    assert [path.exists() for path in paths] == [False, True]


def test_reading_a_choice_counts_as_use(tmp_path, choices):
    path = written(tmp_path, OPEN)
    seal_of(path)
    (own,) = stored(choices)
    os.utime(own, (0.0, 0.0))
    seal_of(path)
    assert time.time() - own.stat().st_mtime < user_cache.UNUSED


def test_files_that_leave_nothing_open_store_nothing(tmp_path, choices, made):
    path = written(tmp_path)
    seal_of(path)
    Workbench(path, report=lambda text: None, watch=lambda: None)
    assert not made
    assert not stored(choices)


def test_the_live_section_takes_the_choice_of_a_command(tmp_path, choices, made):
    path = written(tmp_path, OPEN)
    seal = seal_of(path)
    bench = Workbench(path, report=lambda text: None, watch=lambda: None)
    assert len(made) == 1
    assert bench.seal.n_steps == seal.n_steps


def test_a_command_takes_the_choice_of_the_live_section(tmp_path, choices, made):
    path = written(tmp_path, OPEN)
    bench = Workbench(path, report=lambda text: None, watch=lambda: None)
    assert len(made) == 1
    assert seal_of(path).n_steps == bench.seal.n_steps
    assert len(made) == 1


def test_particles_for_an_accuracy_are_stored_for_the_file_as_written(tmp_path, choices, made):
    accurate = {"spacing = 1.8": 'spacing = 1.8\naccuracy = { reaction = "40 %" }'}
    path = written(tmp_path, OPEN | accurate)
    first = seal_of(path)
    chosen = len(made)
    again = seal_of(path)
    assert len(made) == chosen > 0
    np.testing.assert_array_equal(again.nominal_particles, first.nominal_particles)
