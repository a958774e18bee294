"""Stored values that the pages show are those that their scripts compute."""

import numpy as np
import pytest

from verification import accuracy_study
from verification.accuracy_study import FUNCTION, cases, compute, key, stored

SHOWN = 5e-5
"""Half a unit of the last digit of an error on the page, which is one of percent with two decimals."""
SAMPLE = [
    pytest.param(name, own[i], marks=pytest.mark.release if i else pytest.mark.long)
    for name, own in cases().items()
    for i in sorted({0, len(own) // 2})
    if own[i] != {"name": "lip"}
]
"""The first case of every quantity and one in the middle, but for the fine lip, which takes minutes."""


def test_every_case_is_stored_and_no_other():
    assert list(accuracy_study._values()) == list(FUNCTION) == list(cases())
    for name, own in cases().items():
        assert set(accuracy_study._values()[name]) == {*map(key, own)}, name


def test_a_missing_value_says_what_to_run():
    with pytest.raises(KeyError, match=r"run accuracy_study\.py worst_error"):
        stored("worst_error", rays=1)


def same_as_shown(value, reference):
    """Compare numbers to the digits that the page shows, counts and names exactly."""
    if isinstance(reference, dict):
        assert value.keys() == reference.keys()
        for name in reference:
            same_as_shown(value[name], reference[name])
    elif isinstance(reference, int | str):
        assert value == reference
    else:
        np.testing.assert_allclose(value, reference, rtol=1e-3, atol=SHOWN)


@pytest.mark.parametrize("across", [2, 3, 4])
def test_stored_errors_of_bending(across):
    own = {"across": across, "support": accuracy_study.PRODUCT}
    same_as_shown(compute("bending_error", own), stored("bending_error", **own))


@pytest.mark.parametrize(("quantity", "own"), SAMPLE, ids=lambda part: str(part)[:60])
def test_stored_errors_of_the_accuracy_page(quantity, own):
    value, reference = compute(quantity, own), stored(quantity, **own)
    if quantity == "difference":
        # rounding differs between processors: within what each is uncertain to
        uncertain = np.add(value.pop("uncertainty"), reference["uncertainty"])
        away = np.abs(np.subtract(value["value"], reference["value"]))
        assert np.all(away <= 5.0 * uncertain + 1e-12)
        reference = {name: reference[name] for name in value}
    same_as_shown(value, reference)
