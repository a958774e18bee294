"""CSV files of relaxation tests: good ones, and one line for each bad one."""

import numpy as np
import pytest

from seal_mdao.calibration.data import MaterialDataError
from seal_mdao.calibration.relaxation_data import read_relaxation, relaxation_tests
from seal_mdao.calibration.relaxation_model import WIDEST, log_weights

HEAD = "time_s,stress_kPa\n"
GOOD = HEAD + "10,90\n1,100\n100,80\n"
WARM = "time_s,force_N,temperature_degC\n"

BAD = {
    "empty": ("", "empty; its first line must name the columns, time_s,stress_kPa"),
    "only a header": (HEAD, "no reading"),
    "no time": ("stress_kPa\n100\n", "line 1: there is no column 'time_s'"),
    "no force": ("time_s\n1\n", "no column 'stress_kPa' or 'force_N' or 'ratio'; the columns"),
    "two forces": ("time_s,force_N,ratio\n1,5,1\n", "stress_kPa, force_N, ratio exclude each other"),
    "unknown column": ("time_s,force_N,stretch\n1,5,1.2\n", "unknown column 'stretch'"),
    "word": (HEAD + "1,much\n", "line 2, column stress_kPa: 'much' is not a number"),
    "NaN time": (HEAD + "nan,100\n", "line 2, column time_s: nan is not a finite number"),
    "negative time": (HEAD + "-1,100\n", "column time_s: -1 is negative; time counts from the start"),
    "long time": (HEAD + "1e13,100\n", "column time_s: 1e+13 s is longer than the limit of"),
    "NaN stress": (HEAD + "1,nan\n", "column stress_kPa: nan is not a number between"),
    "infinite stress": (HEAD + "1,inf\n", "column stress_kPa: inf is not a number between"),
    "cold": (WARM + "1,5,-300\n", "column temperature_degC: -300 is not between -273.15 and 1000"),
    "NaN temperature": (WARM + "1,5,nan\n", "column temperature_degC: nan is not between"),
    "no name": ("time_s,ratio,test\n1,1,\n", "column test: the name of the test is missing"),
    "too few": (HEAD + "1,100\n2,99\n2,98\n", "data: 2 different times are too few"),
    "too few of one": (WARM + "1,9,20\n2,8,20\n3,7,20\n1,5,60\n", "60 °C: 1 different times"),
    "change of sign": (HEAD + "1,-9\n2,-5\n3,1\n4,-2\n", "zero or changes sign at 3 s"),
    "zero": (HEAD + "1,0\n2,0\n3,0\n", "stress_kPa is zero or changes sign at 1 s"),
    "at time zero only": (HEAD + "0,5\n0,5\n", "later than the end of the loading ramp at 0"),
}  # fmt: skip


@pytest.mark.parametrize(("text", "expected"), BAD.values(), ids=BAD)
def test_bad_file_gets_one_line(tmp_path, text, expected):
    path = tmp_path / "relaxation.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(MaterialDataError) as raised:
        read_relaxation(path)
    (line,) = str(raised.value).splitlines()
    assert expected in line
    assert line.startswith(str(path))


def test_readings_in_the_order_of_time(tmp_path):
    path = tmp_path / "relaxation.csv"
    path.write_text("# a comment\n" + GOOD)
    (curve,) = read_relaxation(path).curves
    np.testing.assert_array_equal(curve.time, [1.0, 10.0, 100.0])
    np.testing.assert_array_equal(curve.force, [100.0, 90.0, 80.0])
    assert (curve.temperature, curve.label) == (None, "data")


def test_compression_is_the_magnitude_of_the_force(tmp_path):
    path = tmp_path / "relaxation.csv"
    path.write_text("time_s,force_N\n1,-9\n2,-8\n3,-7\n")
    np.testing.assert_array_equal(read_relaxation(path).curves[0].force, [9.0, 8.0, 7.0])


def test_readings_during_the_loading_are_left_out(tmp_path):
    path = tmp_path / "relaxation.csv"
    path.write_text(HEAD + "0,0\n1,50\n2,100\n3,99\n4,98\n")
    tests = read_relaxation(path, 2.0)
    assert (tests.count, tests.unused, tests.ramp) == (3, 2, 2.0)
    assert tests.curves[0].time[0] == 2.0
    with pytest.raises(ValueError, match="ramp must be a number of at least 0"):
        read_relaxation(path, -1.0)


def test_which_curves_share_their_force(tmp_path):
    """Those of one name; without names, none."""
    path = tmp_path / "relaxation.csv"
    rows = "".join(f"{t},{9 - t},{T}\n" for T in (20, 60) for t in (1, 2, 3))
    path.write_text(WARM + rows)
    tests = read_relaxation(path)
    assert tests.temperatures == (20.0, 60.0)
    assert tests.scales == [0, 1]
    named = "".join(
        f"{t},{9 - t},{T},{name}\n" for name in "ab" for T in (20, 60) for t in (1, 2, 3)
    )
    path.write_text("time_s,force_N,temperature_degC,test\n" + named)
    tests = read_relaxation(path)
    assert tests.scales == [0, 0, 1, 1]
    assert [own.label for own in tests.curves] == ["a, 20 °C", "a, 60 °C", "b, 20 °C", "b, 60 °C"]


def test_arrays_are_checked_as_files_are():
    with pytest.raises(MaterialDataError, match="curve 1, reading 2, column time_s: -1 is neg"):
        relaxation_tests([([1.0, -1.0, 2.0], [3.0, 2.0, 1.0])])
    with pytest.raises(MaterialDataError, match="curve 2 has 1 times but 2 forces"):
        relaxation_tests([([1.0, 2.0, 3.0], [3.0, 2.0, 1.0]), ([1.0], [3.0, 2.0])])
    with pytest.raises(
        MaterialDataError, match="some relaxation curves have a temperature, others do not"
    ):
        relaxation_tests(
            [([1.0, 2.0, 3.0], [3.0, 2.0, 1.0], 20.0), ([1.0, 2.0, 3.0], [3.0, 2.0, 1.0])]
        )


def test_weights_are_intervals_of_log_time():
    """A decade has its weight however many readings are in it; a wide gap is no reading's weight."""
    time = np.unique(np.concatenate([np.geomspace(1.0, 10.0, 11), np.geomspace(10.0, 100.0, 501)]))
    weight = log_weights(time)
    assert weight.sum() == pytest.approx(np.log(100.0), rel=1e-12)
    early = weight[time < 10.0].sum()
    # ten intervals before 10 s, where the last reading stands for half of one
    assert early == pytest.approx(0.95 * np.log(10.0), rel=1e-9)
    np.testing.assert_allclose(log_weights(np.array([1.0, 1e6])), WIDEST)
