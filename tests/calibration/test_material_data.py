"""CSV files of test data: good ones, and one line for each bad one."""

import numpy as np
import pytest

from seal_mdao.calibration.data import MaterialDataError, material_tests, read_tests

HEAD = "mode,stretch,stress_kPa\n"
GOOD = HEAD + "uniaxial,1.2,230\nplanar,1.1,100\nuniaxial,1.1,120\nuniaxial,1,0\n"

BAD = {
    "empty": ("", "empty"),
    "only comments": ("# nothing\n\n", "empty"),
    "only a header": (HEAD, "no reading"),
    "only rest": (HEAD + "uniaxial,1.0,0\n", "every reading has the stretch 1"),
    "no header": ("uniaxial,1.2,230\n", "line 1: there is no column 'mode'"),
    "semicolons": ("mode;stretch;stress_kPa\nuniaxial;1.2;230\n", "line 1: there is no column 'mode'"),
    "unknown column": ("mode,stretch,stress_kPa,force\n", "unknown column 'force'"),
    "missing column": ("mode,stretch\nuniaxial,1.2\n", "no column 'stress_kPa'"),
    "column twice": ("mode,stretch,stretch,stress_kPa\n", "twice"),
    "too few values": (HEAD + "uniaxial,1.2\n", "line 2: 2 values for 3 columns"),
    "decimal comma": (HEAD + "uniaxial,1,2,230\n", "write decimals with a point"),
    "word": (HEAD + "uniaxial,long,230\n", "line 2, column stretch: 'long' is not a number"),
    "nothing": (HEAD + "uniaxial,,230\n", "line 2, column stretch: '' is not a number"),
    "wrong order": (HEAD + "1.2,uniaxial,230\n", "column stretch: 'uniaxial' is not a number"),
    "negative stretch": (HEAD + "uniaxial,1.1,9\nuniaxial,-1.2,230\n", "line 3, column stretch: -1.2"),
    "zero stretch": (HEAD + "uniaxial,0,230\n", "column stretch: 0 is not positive"),
    "percent": (HEAD + "uniaxial,120,230\n", "column stretch: 120 is not between"),
    "strain": (HEAD + "uniaxial,0.2,230\n", "column stretch: 0.2 has a stress of 230"),
    "wrong sign": (HEAD + "uniaxial,1.4,-230\n", "column stretch: 1.4 has a stress of -230"),
    "NaN stretch": (HEAD + "uniaxial,nan,230\n", "column stretch: nan"),
    "NaN stress": (HEAD + "uniaxial,1.2,NaN\n", "column stress_kPa: nan"),
    "infinite": (HEAD + "uniaxial,1.2,inf\n", "column stress_kPa: inf"),
    "400 digits": (HEAD + f"uniaxial,{'9' * 400},230\n", "column stretch: inf"),
    "stress of 400 digits": (HEAD + f"uniaxial,1.2,{'9' * 400}\n", "column stress_kPa: inf"),
    "long line": (HEAD + "9" * 10**6, "line 2: 1 values for 3 columns"),
    "long header": ("9" * 10**6, "line 1: there is no column 'mode'"),
    "underscore": (HEAD + "uniaxial,1_0,230\n", "column stretch: '1_0' is not a number"),
    "no stress": (HEAD + "uniaxial,1.2,0\nuniaxial,1.3,0\n", "every stress of the mode uniaxial"),
    "unknown mode": (HEAD + "biaxial,1.2,230\n", "column mode: unknown mode 'biaxial'"),
    "lateral": (
        "mode,stretch,stress_kPa,lateral_stretch\nuniaxial,1.2,230,-0.9\n",
        "column lateral_stretch: -0.9",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("text", "expected"), BAD.values(), ids=BAD)
def test_bad_file_in_one_line(tmp_path, text, expected):
    path = tmp_path / "tests.csv"
    path.write_text(text)
    with pytest.raises(MaterialDataError) as caught:
        read_tests(path)
    message = str(caught.value)
    assert expected in message
    assert str(path) in message
    assert "\n" not in message


def test_file_that_cannot_be_read(tmp_path):
    with pytest.raises(MaterialDataError, match="cannot be read"):
        read_tests(tmp_path / "none.csv")
    with pytest.raises(MaterialDataError, match="cannot be read"):
        read_tests(tmp_path)
    (tmp_path / "binary.csv").write_bytes(b"\x89PNG\xff\xfe")
    with pytest.raises(MaterialDataError, match="UTF-8"):
        read_tests(tmp_path / "binary.csv")


def test_readings_by_mode_in_the_order_of_the_stretch(tmp_path):
    path = tmp_path / "tests.csv"
    path.write_text("\ufeff# a comment\n" + GOOD, encoding="utf-8")
    tests = read_tests(path)
    assert list(tests.modes) == ["uniaxial", "planar"]
    assert tests.count == 3  # that at rest is left out
    np.testing.assert_array_equal(tests.modes["uniaxial"].stretch, [1.1, 1.2])
    np.testing.assert_array_equal(tests.modes["uniaxial"].stress, [120.0, 230.0])
    assert tests.modes["uniaxial"].range == (1.0, 1.2)
    assert not tests.has_lateral


def test_columns_in_any_order(tmp_path):
    path = tmp_path / "tests.csv"
    path.write_text("lateral_stretch,stress_kPa,mode,stretch\n1.1,-30,uniaxial,0.8\n")
    data = read_tests(path).modes["uniaxial"]
    assert (data.stretch[0], data.stress[0], data.lateral[0]) == (0.8, -30.0, 1.1)


def test_range_of_stretches():
    tests = material_tests({"uniaxial": ([0.8, 1.2, 1.6], [-90.0, 80.0, 200.0])})
    assert tests.between(0.9, 1.5).count == 1
    with pytest.raises(MaterialDataError, match="between 3 and 4"):
        tests.between(3.0, 4.0)


def test_arrays_are_checked_as_files_are():
    with pytest.raises(MaterialDataError, match="reading 2, column stretch: -1"):
        material_tests({"uniaxial": ([1.2, -1.0], [80.0, 200.0])})
    with pytest.raises(MaterialDataError, match=r"of equal length, got lengths \[.*\]"):
        material_tests({"uniaxial": ([1.2, 1.4], [80.0])})
