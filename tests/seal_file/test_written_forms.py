"""How tables begin in a seal file, as `seal-mdao keys` says it."""

import pytest

from seal_mdao.seals.file.reference import TABLES, written_as


@pytest.mark.parametrize(("name", "form"), [
    ("fixed", "[fixed]"), ("symmetry", "[[symmetry]]"), ("profile", "[[profile]]"),
    ("stage", "[[moved.stage]], [[profile.stage]]"), ("region", "[[section.region]]"),
    ("pair", "[[self_contact.pair]]"), ("constraint", "[[optimize.constraint]]"),
    ("material", "[material.NAME]"), ("viscoelastic", "[material.NAME.viscoelastic]"),
    ("vary", "[tolerance.vary.NAME]"), ("boundary", "[tolerance.boundary]"),
    ("arc", "arc = {...}"), ("friction", "friction = {...}"),
])  # fmt: skip
def test_tables_are_written_so(name, form):
    assert written_as(name) == form


def test_every_table_has_a_form():
    assert all(map(written_as, TABLES))
