"""The attributes of a ``SealModel`` as text, for recorder files."""

import json
from dataclasses import asdict

from seal_mdao.model import SealModel

SETTINGS_OPTION = "seal_settings"
"""Option of a ``SealGroup`` that holds the attributes of its model as JSON."""
PROBLEM_OPTION = "problem_settings"
"""Option of the recorded model with the other arguments of ``seal_problem`` that define the problem,
as JSON: what a restart needs to set up the same problem again."""


def settings_json(model: SealModel) -> str:
    """All attributes of a model as JSON."""
    return json.dumps(asdict(model))


def model_from_json(text: str) -> SealModel:
    """The model whose attributes ``settings_json`` wrote.

    Raises
    ------
    ValueError
        When they are not those of this version's ``SealModel``.
    """
    settings, defaults = json.loads(text), SealModel()
    try:
        for name in ("section", "material", "newton"):
            settings[name] = type(getattr(defaults, name))(**settings[name])
        return SealModel(**settings)
    except (TypeError, KeyError) as error:
        raise ValueError(f"the settings are not those of this version's model: {error}") from error
