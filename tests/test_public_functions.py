"""What is no argument of a public function is named, with what it has to be."""

import pytest

import seal_mdao as sm


@pytest.mark.parametrize(
    ("name", "arguments", "said"),
    [
        ("build_seal", ["seal.toml"], "file must be a SealFile, got 'seal.toml'"),
        ("write_dxf", ["seal.toml", "x.dxf"], "outline must be an Outline, got 'seal.toml'"),
        ("restart", ["cases.sql", "cases.sql"], "problem must be a Problem, got 'cases.sql'"),
    ],
)
def test_paths_in_place_of_what_was_read_from_them(name, arguments, said):
    with pytest.raises(TypeError) as error:
        getattr(sm, name)(*arguments)
    assert str(error.value) == said
