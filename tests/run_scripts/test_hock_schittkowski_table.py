"""hock_schittkowski_table.py: both drivers solve every problem, and the table says so."""

import pytest


def test_table_of_both_drivers(tmp_path, run_script):
    pytest.importorskip("ipyopt")
    code, summary = run_script("hock_schittkowski_table", tmp_path)
    assert code == 0
    count = summary["problems"]
    assert summary["solved"] == {"IpoptDriver": count, "ResilientSLSQPDriver": count}
    rows = (tmp_path / "hock_schittkowski.md").read_text().splitlines()
    assert len(rows) == 2 + 2 * count
    assert len({row.count("|") for row in rows}) == 1
    known = [row.split("|")[4].strip() for row in rows if row.startswith("| 71 |")]
    found = [row.split("|")[6].strip() for row in rows if row.startswith("| 71 |")]
    assert float(found[0]) == pytest.approx(float(known[0]), abs=1e-5)
    assert float(known[0]) == pytest.approx(17.0140173)
