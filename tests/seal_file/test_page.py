"""The page of the seal file names every key, type and law, and its messages are those that come."""

import re
from pathlib import Path

import pytest

import seal_mdao as sm
from seal_mdao.materials.by_name import LAWS
from seal_mdao.materials.hyperfoam import Hyperfoam
from seal_mdao.seals.file import laws, measures, optimization, profiles, read, sections, shapes

PAGE = (Path(__file__).parents[2] / "docs" / "seal_file.md").read_text(encoding="utf-8")
BULB = Path(__file__).parent / "bulb.toml"


def test_every_key_type_and_law_is_on_the_page():
    tables = [
        laws.LAW_KEYS, laws.FIT_KEYS, laws.TERM_KEYS, laws.FOAM_KEYS,
        sections.SECTION_KEYS, sections.HOLE_KEYS, shapes.KEYS, shapes.ARC_KEYS, shapes.CIRCLE_KEYS,
        read.FIXED_KEYS, read.SYMMETRY_KEYS, read.CAVITY_KEYS, read.SELF_CONTACT_KEYS, read.FLUID_KEYS,
        sections.REGION_KEYS, sections.RAY_KEYS, read.DESIGN_KEYS,
        profiles.PROFILE_KEYS, profiles.STAGE_KEYS,
        optimization.OPTIMIZE_KEYS, optimization.CONSTRAINT_KEYS,
        *(kind.keys for kind in measures.KINDS.values()),
    ]  # fmt: skip
    names = {name for keys in tables for name in keys}
    names |= {*LAWS, *measures.KINDS, *Hyperfoam.__dataclass_fields__, *read.TABLES}
    words = set(re.findall(r"\w+", PAGE))
    assert not names - words


@pytest.mark.parametrize(("old", "new"), [
    ('contact = ["seal"]', 'contact = ["sael"]'),
    ("through = [0.0, 14.0]", "through = [0.0, 0.0]"),
    ("end = [-4.0", "end = [-5.0"),
])  # fmt: skip
def test_the_messages_on_the_page(tmp_path, monkeypatch, old, new):
    monkeypatch.chdir(tmp_path)
    Path("bulb.toml").write_text(BULB.read_text().replace(old, new, 1))
    with pytest.raises(sm.SealFileError) as caught:
        sm.read_seal_file("bulb.toml")
    assert str(caught.value) in PAGE.splitlines()
