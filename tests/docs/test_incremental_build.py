"""Figures are remade where their sources have changed; a build without figures lacks nothing."""

import json

import pytest


@pytest.fixture
def sources(docs_module, tmp_path, monkeypatch):
    """The module that compares sources, with a repository of its own."""
    module = docs_module("figures.sources")
    monkeypatch.setattr(module, "ROOT", tmp_path)
    module._digest.cache_clear()
    yield module
    module._digest.cache_clear()


@pytest.mark.parametrize(
    ("name", "before", "after", "same"),
    [
        ("seal_mdao/law.py", "x = 1\n", "x = 1  # formula\n", True),
        ("seal_mdao/law.py", "x = 1\n", "x = 2\n", False),
        ("examples/lip.toml", "a = 1\n", "a = 2\n", False),
        ("examples/lip.toml", "a = 1\n", None, False),
    ],
)
def test_a_changed_source_is_found(sources, tmp_path, name, before, after, same):
    path, stored = tmp_path / name, tmp_path / "stored.json"
    path.parent.mkdir()
    path.write_text(before)
    stored.write_text(json.dumps({name: sources._digest(name)}))
    assert sources.unchanged(stored)
    sources._digest.cache_clear()
    if after is None:
        path.unlink()
    else:
        path.write_text(after)
    assert sources.unchanged(stored) == same


def test_what_was_never_made_is_not_unchanged(sources, tmp_path):
    assert not sources.unchanged(tmp_path / "none.json")


def test_placeholders_stand_for_missing_files_and_numbers(docs_module, tmp_path):
    placeholders, generated = docs_module("placeholders"), tmp_path / "_generated"
    generated.mkdir()
    (generated / "there.md").write_text("made")
    (tmp_path / "page.md").write_text(
        "```{figure} _generated/curve.png\n```\n```{include} _generated/there.md\n```\n"
        "{{ rates.cook }} and {{ rates.slope }} and {{ files.lip.force }}\n"
    )
    placeholders.write_missing(tmp_path, generated)
    assert (generated / "curve.png").stat().st_size > 0
    assert (generated / "there.md").read_text() == "made"
    found = placeholders.numbers(tmp_path, {"rates": {"cook": "0.2 %"}})
    assert found == {"rates": {"cook": "0.2 %", "slope": "…"}, "files": {"lip": {"force": "…"}}}
