"""``seal-mdao new --from`` a drawing whose layers are not the edges: everything on one layer."""

import math
from itertools import pairwise

import pytest

import seal_mdao as sm
from seal_mdao.cli.subcommands import main


def draw(path, gap=0.0, centre_line=True, inside="profile"):
    """A bulb on a foot on the layer "profile" with a hole ``inside``; ``gap`` opens the contour."""
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new("R2010", units=4)
    model, on = document.modelspace(), {"layer": "profile"}
    corners = [(-4, 2), (-5, 2), (-5, 0), (5, 0), (5, 2), (4, 2 - gap)]
    for first, last in pairwise(corners):
        model.add_line(first, last, on)
    model.add_arc((0, 6), math.hypot(4, 4), -45, 225, dxfattribs=on)
    model.add_circle((0, 6.2), 3.9, {"layer": inside})
    if centre_line:
        model.add_line((0, -2), (0, 14), {"layer": "centreline"})
    model.add_linear_dim(base=(0, -3), p1=(-5, 0), p2=(5, 0)).render()
    document.saveas(path)


@pytest.mark.parametrize("inside", ["profile", "inner"])
def test_edges_between_corners_get_layers_of_their_own(tmp_path, monkeypatch, capsys, inside):
    """Where outside and hole are on one layer, or on one each."""
    monkeypatch.chdir(tmp_path)
    draw("bulb.dxf", inside=inside, centre_line=inside == "profile")
    assert main(["new", "mine", "--from", "bulb.dxf"]) == 0
    names = ("base", "edge_1", "edge_2", "edge_3", "edge_4", "edge_5", "hole_1")
    assert (
        f"with one layer for every edge between two corners: {', '.join(names)}"
        in capsys.readouterr().out
    )
    file = sm.read_seal_file("mine.toml")
    outline = file.section.outline
    assert outline.edge_names == names
    assert file.fixed_edges == ("base",)
    assert [own.contact for own in file.profiles] == [("edge_3",)]
    # the section is that of the drawing: foot, circular segment, hole
    radius, half = math.hypot(4, 4), 0.75 * math.pi
    bulb = radius**2 * (half - math.sin(2.0 * half) / 2.0)
    assert outline.area == pytest.approx(20.0 + bulb - math.pi * 3.9**2, rel=1e-9)
    (base,) = outline.edge("base")
    assert sorted([base.start[0], base.end[0]]) == pytest.approx([-5.0, 5.0])
    # nothing is written over
    (tmp_path / "mine.toml").unlink()
    with pytest.raises(SystemExit):
        main(["new", "mine", "--from", "bulb.dxf"])
    assert "mine_edges.dxf already exists" in capsys.readouterr().err


def test_a_drawn_centre_line_is_left_out_and_named(tmp_path, monkeypatch):
    """Beside layers that are edges; its type of line says nothing."""
    ezdxf = pytest.importorskip("ezdxf")
    monkeypatch.chdir(tmp_path)
    document = ezdxf.new("R2010", units=4)
    model, corners = document.modelspace(), [(0, 0), (2, 0), (2, 1), (0, 1)]
    for name, i in (("base", 0), ("right", 1), ("top", 2), ("left", 3)):
        model.add_line(corners[i], corners[(i + 1) % 4], {"layer": name})
    model.add_line((1, -1), (1, 2), {"layer": "Axis"})
    document.saveas("box.dxf")
    assert main(["new", "box", "--from", "box.dxf"]) == 0
    text = (tmp_path / "box.toml").read_text(encoding="utf-8")
    assert 'ignore = ["Axis"]' in text
    assert "left out Axis (1 entities)" in text
    assert sm.read_seal_file("box.toml").section.outline.edge_names == (
        "base", "right", "top", "left",
    )  # fmt: skip


@pytest.mark.parametrize("options", [[], ["--parting", "split"]], ids=["found", "given"])
@pytest.mark.parametrize("axis", [False, True], ids=["no axis", "axis"])
def test_one_layer_around_two_rubbers_gets_edges_and_keeps_the_line_between_them(
    tmp_path, monkeypatch, options, axis
):
    """The texts of the drawing still name the rubbers; a centre line that crosses is left out."""
    ezdxf = pytest.importorskip("ezdxf")
    monkeypatch.chdir(tmp_path)
    document = ezdxf.new("R2010", units=5)
    model, corners = document.modelspace(), [(0, 0), (2, 0), (2, 3), (0, 3)]
    model.add_lwpolyline(corners, close=True, dxfattribs={"layer": "contour"})
    model.add_line((0, 1), (2, 1), {"layer": "split"})
    for text, at in (("foot", (1, 0.5)), ("sponge", (1, 2))):
        model.add_text(text, dxfattribs={"layer": "words"}).set_placement(at)
    if axis:
        model.add_line((1, -1), (1, 4), {"layer": "Mittellinie"})
    document.saveas("block.dxf")
    assert main(["new", "mine", "--from", "block.dxf", *options]) == 0
    file = sm.read_seal_file("mine.toml")
    assert file.section.outline.edge_names == ("base", "edge_1", "edge_2", "edge_3")
    assert file.section.outline.area == pytest.approx(600.0)
    assert file.fixed_edges == ("base",)
    # the part below the line, of 20 x 10 mm, is the foot
    assert list(file.materials) == ["sponge", "foot"]
    text = (tmp_path / "mine.toml").read_text(encoding="utf-8")
    assert 'material = "sponge"\nspacing' in text
    (region,) = file.section.regions
    assert region.at == pytest.approx((10.0, 5.0))


@pytest.mark.parametrize("options", [[], ["--parting", "JOINT"]], ids=["found", "given"])
def test_a_line_across_the_hole_stays_beside_edges_of_one_layer(
    tmp_path, monkeypatch, capsys, options
):
    """Outside and hole are on one layer; the line between rubbers begins at corners of the outside."""
    ezdxf = pytest.importorskip("ezdxf")
    monkeypatch.chdir(tmp_path)
    draw("bulb.dxf", centre_line=False)
    document = ezdxf.readfile("bulb.dxf")
    model = document.modelspace()
    model.query("CIRCLE").first.dxf.center = (0, 5.5)
    model.add_line((-4, 2), (4, 2), {"layer": "JOINT"})
    document.saveas("bulb.dxf")
    assert main(["new", "mine", "--from", "bulb.dxf", *options]) == 0
    assert "lines between rubbers, from JOINT, are on parting" in capsys.readouterr().out
    section = sm.read_seal_file("mine.toml").section
    assert section.outline.edge_names == (
        "base", "edge_1", "edge_2", "edge_3", "edge_4", "edge_5", "hole_1",
    )  # fmt: skip
    # the hole is 3.5 mm below its centre at the height of the line
    half = math.sqrt(3.9**2 - 3.5**2)
    ends = sorted(x for line in section.parting for x, _ in (line[0], line[-1]))
    assert ends == pytest.approx([-4.0, -half, half, 4.0], abs=1e-5)
    assert len(section.regions) == 1


def test_a_drawing_that_is_no_section_is_refused_as_before(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    draw("bulb.dxf", gap=0.5, centre_line=False)
    with pytest.raises(SystemExit):
        main(["new", "mine", "--from", "bulb.dxf"])
    assert "the contour is open" in capsys.readouterr().err
    assert sorted(own.name for own in tmp_path.iterdir()) == ["bulb.dxf"]
