"""The laws as a parameter."""

import laws
import pytest


@pytest.fixture(params=list(laws.LAWS))
def law(request):
    return laws.LAWS[request.param]


@pytest.fixture(params=laws.ISOCHORIC)
def isochoric(request):
    return laws.LAWS[request.param]
