"""``seal-mdao sweep`` of bodies of revolution: forces in N and in N per mm of circumference."""

import csv

import numpy as np
import pytest
from ring_files import ring

import seal_mdao as sm
from seal_mdao.cli.subcommands import main


def swept(tmp_path, monkeypatch, *vary, text=None):
    """Sweep a ring, or that of a seal file's ``text``; return the figures by their names, the rows of
    both tables, and the seal."""
    pytest.importorskip("netgen")
    path, out, drawn = tmp_path / "ring.toml", tmp_path / "out", {}
    own = ring() if text is None else text
    path.write_text(own + '[[measure]]\ntype = "reaction"\n', encoding="utf-8")
    monkeypatch.setattr("seal_mdao.plotting.save", lambda own, path: drawn.update({path.name: own}))
    assert main(["sweep", str(path), "--vary", *vary, "--out", str(out)]) == 0
    tables = []
    for name in ("sweep.csv", "curves.csv"):
        with (out / name).open(newline="", encoding="utf-8") as file:
            tables.append(list(csv.DictReader(file)))
    return drawn, *tables, sm.build_seal(path)


def test_forces_of_a_ring_are_per_mm_of_its_circumference_too(tmp_path, monkeypatch):
    drawn, rows, curves, seal = swept(tmp_path, monkeypatch, "friction", "0.1,0.3")
    # the section is a rectangle from r = 3 to 5 mm
    circumference = 2.0 * np.pi * 4.0
    assert seal.units.radius == 4.0
    assert len(rows) == 2
    for row in rows:
        for name in ("plate_Fx", "plate_Fy"):
            wanted = float(row[f"{name}_N"]) / circumference
            assert float(row[f"{name}_N_per_mm"]) == pytest.approx(wanted, rel=1e-9)
        wanted = float(row["reaction"]) / circumference
        assert float(row["reaction_N_per_mm"]) == pytest.approx(wanted, rel=1e-9)
        assert wanted > 0.0
    for row in curves:
        wanted = float(row["Fy_N"]) / circumference
        assert float(row["Fy_N_per_mm"]) == pytest.approx(wanted, rel=1e-9)
    # a right axis in N per mm, no panel of its own
    panels = {axes.get_title(loc="left"): axes for axes in drawn["measures.png"].axes}
    assert set(panels) - {""} == {
        "radial force on plate (N)", "axial force on plate (N)", "reaction (N)",
    }  # fmt: skip
    for axes in filter(lambda own: own.get_title(loc="left"), panels.values()):
        (right,) = axes.child_axes
        low, high = axes.get_ylim()
        drawn["measures.png"].canvas.draw()
        np.testing.assert_allclose(right.get_ylim(), [low / circumference, high / circumference])
        assert right.get_ylabel().startswith("N per mm of circumference")


def test_rings_of_different_circumference_have_panels_of_their_own(tmp_path, monkeypatch):
    """The section within the chords of an arc changes with their length."""
    side = "line = [[5.0, 0.0], [5.0, 2.0]]"
    arc = "arc = { start = [5.0, 0.0], through = [5.5, 1.0], end = [5.0, 2.0] }"
    text = ring().replace(side, arc)
    assert text != ring()
    drawn, rows, _, _ = swept(tmp_path, monkeypatch, "section.spacing", "0.35,0.6", text=text)
    titles = {axes.get_title(loc="left"): axes for axes in drawn["measures.png"].axes}
    force = "axial force on plate"
    assert {f"{force} (N)", f"{force} (N per mm)"} <= set(titles)
    assert {"reaction (N)", "reaction (N per mm)"} <= set(titles)
    assert not any(axes.child_axes for axes in titles.values())
    ratios = [float(row["plate_Fy_N"]) / float(row["plate_Fy_N_per_mm"]) for row in rows]
    assert ratios[0] != pytest.approx(ratios[1], rel=1e-6)
