"""Differences between seal files, as a restart with another file reports them."""

import tomllib

from seal_mdao.seals.file.differences import differences

BEFORE = """
[section]
spacing = 0.5
line = [[0.0, 1.0], [2.0, 3.0]]
[material.rubber]
law = "yeoh"
[[profile]]
name = "door"
friction = 0.3
[[profile.stage]]
translate = [0.0, -2.0]
"""


def changed(*pairs):
    text = BEFORE
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new)
    return differences(tomllib.loads(BEFORE), tomllib.loads(text))


def test_equal_tables_have_no_differences():
    assert changed(("[section]", "# comment\n[section]"), ("[0.0, -2.0]", "[ 0, -2]")) == ""


def test_differences_name_keys_and_values():
    found = changed(
        ("spacing = 0.5\n", ""), ("-2.0", "-3.0"), ("friction = 0.3", "friction = 0.3\nangle = 5.0")
    )
    assert found == (
        "section.spacing is missing (was 0.5); "
        "profile.door.stage.1.translate was [0.0, -2.0] and is [0.0, -3.0]; "
        "profile.door.angle = 5.0 was not in it"
    )


def test_long_lists_of_differences_are_shortened():
    found = differences({}, {"section": {f"key_{number}": "x" * 100 for number in range(8)}})
    assert found.endswith("; 3 more")
    assert all(len(part) < 100 for part in found.split("; "))
