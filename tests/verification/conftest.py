"""Every figure is asserted through ``figure`` and printed in a table at the end of the run."""

import pytest


@pytest.fixture
def figure(record_property):
    """Assert ``value <= tolerance`` and remember both for the table."""

    def check(name, value, tolerance):
        record_property("figure", (name, float(value), float(tolerance)))
        assert value <= tolerance, f"{name}: {value:.3g} exceeds {tolerance:.3g}"

    return check


def pytest_terminal_summary(terminalreporter):
    """The table of all verification figures."""
    rows = [
        value
        for outcome in ("passed", "failed")
        for report in terminalreporter.stats.get(outcome, [])
        for key, value in getattr(report, "user_properties", [])
        if key == "figure"
    ]
    if rows:
        terminalreporter.section("verification figures")
        for name, value, tolerance in rows:
            terminalreporter.write_line(f"{name:<72} {value:>10.3g} (<= {tolerance:.3g})")
