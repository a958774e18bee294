"""A seal that is pressed a little, and its tolerances."""

import pytest
from quick_study import quick_seal, quick_study, some_tolerances


@pytest.fixture(scope="session")
def seal():
    return quick_seal()


@pytest.fixture(scope="session")
def tolerances():
    return some_tolerances()


@pytest.fixture(scope="session")
def study():
    return quick_study()
