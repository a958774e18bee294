"""The project folder: names lead to files directly in it."""

import pytest

from seal_mdao.studio.project import Project, ProjectError

OUTSIDE = (
    "../secret.toml", "..", ".", "", "/etc/passwd", "sub/bulb.toml", "a\\b.toml", ".hidden.toml",
    "bulb.toml\n", "bulb", "bulb.py", "bulb.toml/../../x.toml", "%2e%2e%2fx.toml", "a..toml",
    "C:x.toml", "x" * 80 + ".toml", "bulb.toml\0.dxf", None, 3,
)  # fmt: skip


@pytest.mark.parametrize("name", OUTSIDE)
def test_names_that_are_no_file_of_the_folder_are_refused(tmp_path, name):
    with pytest.raises(ProjectError):
        Project(tmp_path).path(name)


def test_links_that_lead_elsewhere_are_refused(tmp_path):
    folder = tmp_path / "project"
    folder.mkdir()
    (tmp_path / "secret.toml").write_text("x = 1")
    (folder / "bulb.toml").symlink_to(tmp_path / "secret.toml")
    (folder / "new.toml").symlink_to(tmp_path / "not_there.toml")
    project = Project(folder)
    for name in ("bulb.toml", "new.toml"):
        with pytest.raises(ProjectError, match="not in the project folder"):
            project.path(name)
    assert project.seal_files() == []


def test_new_names_are_of_no_file(tmp_path):
    project = Project(tmp_path)
    assert project.path("door 1.v2.toml") == tmp_path.resolve() / "door 1.v2.toml"
    assert project.new("bulb") == "bulb"
    (tmp_path / "bulb.dxf").write_text("")
    assert project.new("bulb") == "bulb"
    assert project.new("bulb", (".toml", ".dxf")) == "bulb_2"


def test_a_folder_that_is_missing_is_refused(tmp_path):
    with pytest.raises(ProjectError, match="is not a folder"):
        Project(tmp_path / "missing")
