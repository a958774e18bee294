"""Tables that are made from the code."""

from seal_mdao.seals.door.door_seal import FURTHER, STANDARD


def test_every_measure_is_in_the_table_with_its_units(docs_module):
    table = docs_module("code_reference").measures()
    for measure in (*STANDARD, *FURTHER):
        name = measure.name
        row = table.partition(f"- `{name}`\n")[2].partition("* -")[0]
        assert f"- `{measure.units}`" in row
        assert measure.text in row


def test_every_class_of_measures_is_in_the_table(docs_module):
    table = docs_module("code_reference").measure_classes()
    assert table.count("{py:class}") == 22
    for name in ("mJ/m", "mm**3", "kPa", "N/m"):
        assert f"`{name}`" in table
