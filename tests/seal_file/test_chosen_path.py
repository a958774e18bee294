"""The last path of a choice is the next analysis of that seal, and of no other."""

import gc
import re
import weakref
from dataclasses import replace

import numpy as np
import pytest
from test_build import COARSE, read

import seal_mdao as sm

OPEN = re.sub(r"steps = \d\n", "", COARSE)


class Choice:
    """A callback with weak references to the displacements of the last path."""

    def __init__(self):
        self.displacements = []

    def begin_analysis(self, number, of, steps):
        self.displacements = []

    def __call__(self, step):
        self.displacements.append(weakref.ref(step.d))

    def is_path_of(self, result):
        steps = result.path.nominal_steps
        return all(a.d is b() for a, b in zip(steps, self.displacements, strict=False))


@pytest.fixture
def file(tmp_path):
    return read(tmp_path, OPEN)


def chosen(file):
    choice = Choice()
    return sm.build_seal(file, choice), choice


def test_only_the_same_seal_takes_it(file):
    seal, choice = chosen(file)
    others = (
        (seal, np.full(seal.n_offsets, 1e-3), None),
        (seal, None, {"door_friction": 0.3}),
        (seal.with_parameters({"c10": 70.0}), None, None),
        (replace(seal, newton=sm.NewtonOptions(tolerance=1e-12)), None, None),
        (replace(seal, standard=()), None, None),
    )
    for other, offsets, parameters in others:
        assert not choice.is_path_of(sm.analyze(other, offsets, parameters))
    assert choice.is_path_of(sm.analyze(seal))


def test_taken_once_without_factors_unless_they_are_asked_for(file):
    seal, _ = chosen(file)
    with_factors = sm.analyze(seal, keep_factors=True)
    assert all(step.factor is not None for step in with_factors.path.steps)
    seal, choice = chosen(file)
    first, second = sm.analyze(seal), sm.analyze(seal)
    assert choice.is_path_of(first)
    assert not choice.is_path_of(second)
    for a, b in zip(first.path.steps, second.path.steps, strict=True):
        assert a.factor is None
        assert a.d.tobytes() == b.d.tobytes()
        assert a.residuals == b.residuals


def test_options_are_not_mixed_up(file, tmp_path):
    """Of two seals the one that was built last has its path; the other is analysed anew."""
    (tmp_path / "other").mkdir()
    tight = read(tmp_path / "other", f"{OPEN}[steps]\ntolerance = 1e-4\n")
    (one, first), (other, second) = chosen(file), chosen(tight)
    assert other.n_steps > one.n_steps
    result = sm.analyze(one)
    assert len(result.path.nominal_steps) == one.n_steps
    assert not first.is_path_of(result)
    assert second.is_path_of(sm.analyze(other))


def test_memory_is_freed_with_the_seal_or_by_the_next_choice(file):
    (one, first), (other, second) = chosen(file), chosen(file)
    gc.collect()
    assert not any(d() is not None for d in first.displacements)
    assert all(d() is not None for d in second.displacements)
    del other
    gc.collect()
    assert not any(d() is not None for d in second.displacements)
    assert one.n_steps == len(first.displacements)


def test_of_the_door_seal_too():
    seal = sm.door_seal(n_steps=1, depth=2.0, steps="auto", step_tolerance=0.05)
    path, shown = sm.analyze(seal, keep_factors=True).path, []
    again = sm.analyze(seal, callback=shown.append).path
    assert len(shown) == seal.n_steps
    for a, b in zip(path.steps, again.steps, strict=True):
        assert a.d.tobytes() == b.d.tobytes()
