"""Tables of body signals: which columns are taken, in which units, separators and encodings, and what is left out."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mimics_app.app.cli import main
from mimics_app.contracts.errors import DeviceError, SceneError
from mimics_app.dsp.channel_kinds import check_rate
from mimics_app.inputs.physio.channel_names import columns_of, signal_of
from mimics_app.inputs.physio.recording import FileSource, read_signal_file
from mimics_app.inputs.physio.sources import open_source

ROWS = 300

KNOWN = {
    "ecg": "ecg|ECG|EKG|ECG1|ECG_Raw|ecg_clean|I|II|III|MLII|V1|aVF|EKG V5|Lead II|ECG_LL-RA_24BIT (mV)|ECG [uV]",
    "gsr": "gsr|EDA|eda1|EDA_Raw|SC|SCL|skin conductance|Skin Conductance (uS)|GSR_Skin_Conductance_CAL (uS)|EDA left",
    "emg": "emg|EMG_Raw|EMG2|EMG biceps|EMG Ant Tib|EMG Chin1|emg flexor carpi left (mV)",
    "resp": "resp|RSP|RSP_Clean|respiration|breathing|thorax|Resp nasal|Resp Abdomen|chest belt",
}
OTHERS = (
    "lead_off|ECG_Quality|ecg_rate|quality|skin temperature|skin_temperature|GSR_Skin_Resistance_CAL (kOhms)|GSR (kOhm)"
    "|response|breath rate|RSP_Rate|EMG_Amplitude|emg onset|respiratory quotient|muscle|conductivity of water|EEG|PPG"
    "|chest accelerometer|description|muscle_oxygen|ecg_r_peaks|eda_phasic|spo2|lead time|iv|vi|v7|a1|scale|lead"
)


@pytest.mark.parametrize("signal", KNOWN)
def test_names_that_are_known_are_taken(signal: str) -> None:
    labels = KNOWN[signal].split("|")
    assert {label: signal_of(label) for label in labels} == dict.fromkeys(labels, signal)


@pytest.mark.parametrize("label", OTHERS.split("|"))
def test_other_names_are_not(label: str) -> None:
    assert signal_of(label) == ""


def write(path: Path, head: str, rate: float = 100.0, separator: str = ",", comma: bool = False) -> Path:
    """A table whose column n holds n and the number of the row."""
    count = head.count(separator) + 1
    rows = [
        separator.join([f"{i / rate:.6f}", *(f"{n + i / 1000.0:.4f}" for n in range(1, count))]) for i in range(ROWS)
    ]
    text = "\n".join(rows)
    path.write_bytes((head + "\n" + (text.replace(".", ",") if comma else text)).encode("latin-1"))
    return path


def first_value(path: Path) -> dict[str, float]:
    return {signal.name: float(signal.values[0:1][0]) for signal in read_signal_file(path)}


@pytest.mark.parametrize(
    "head",
    [
        "t_s,lead_off,ecg",
        "t_s,ECG_Quality,ECG_Raw",
        "t_s,skin_temperature,eda",
        "t_s,GSR_Skin_Resistance_CAL (kOhms),GSR_Skin_Conductance_CAL (uS)",
        "t_s,response,resp",
    ],
)
def test_the_true_column_is_taken_and_the_other_is_named(head: str, tmp_path: Path) -> None:
    path = write(tmp_path / "a.csv", head)
    assert list(first_value(path).values()) == [2.0]
    notes = " ".join(FileSource(read_signal_file(path)).notes)
    _, other, taken = head.split(",")
    assert f'from "{taken}"' in notes
    assert f'not read: "{other}"' in notes


@pytest.mark.parametrize("head", ["t_s,skin temperature", "t_s,response,lead_off", "t_s,Leitf\u00e4higkeit"])
def test_a_table_without_a_known_column_is_refused_with_the_list(head: str, tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"EKG.*skin conductance") as caught:
        read_signal_file(write(tmp_path / "a.csv", head))
    assert head.split(",")[1] in str(caught.value)


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize("comma", [False, True])
@pytest.mark.parametrize("before", ["", "sep=;\n", "\ufeff"])
def test_tables_of_spreadsheets(separator: str, comma: bool, before: str, tmp_path: Path) -> None:
    if separator == "," and (comma or before.startswith("sep")):
        pytest.skip("numbers and columns could not be told apart")
    path = write(tmp_path / "a.csv", separator.join(["t_s", "ecg", "Leitf\u00e4higkeit"]), 100.0, separator, comma)
    path.write_bytes(before.encode("utf-8") + path.read_bytes())
    (signal,) = read_signal_file(path)
    assert (signal.name, signal.rate, len(signal.values)) == ("ecg", 100.0, ROWS)
    np.testing.assert_allclose(signal.values[0:ROWS], 1.0 + np.arange(ROWS) / 1000.0, atol=1e-9)


@pytest.mark.parametrize("head", ["t_ms,ecg", "time (ms),ecg", "Time [ms],ecg", "timestamp_ms,ecg"])
def test_milliseconds_are_read_as_such(head: str, tmp_path: Path) -> None:
    (signal,) = read_signal_file(write(tmp_path / "a.csv", head, 100.0 / 1000.0))
    assert signal.rate == 100.0


def test_milliseconds_that_are_not_called_so_are_refused_with_the_file(tmp_path: Path) -> None:
    path = write(tmp_path / "a.csv", "time,ecg", 0.1)
    with pytest.raises(SceneError, match=r"a\.csv: .*0\.1 Hz.*t_ms"):
        open_source(f"file:{path}", 1, check_rate)
    assert main(["physio", str(path)]) == 3


@pytest.mark.parametrize(("head", "factor"), [("t_s,ECG (uV)", 1e-3), ("t_s,EDA [nS]", 1e-3), ("t_s,EMG (V)", 1e3)])
def test_units_in_brackets_are_converted(head: str, factor: float, tmp_path: Path) -> None:
    assert next(iter(first_value(write(tmp_path / "a.csv", head)).values())) == pytest.approx(factor)


@pytest.mark.parametrize("cell", ["#N/A", "-", "NaN", "", "#NV", "n/a", "NULL"])
def test_cells_without_a_value_are_missing(cell: str, tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("t_s,ecg\n" + "".join(f"{i / 100},{cell if i == 7 else i}\n" for i in range(50)))
    (signal,) = read_signal_file(path)
    assert np.flatnonzero(~np.isfinite(signal.values[0:50])).tolist() == [7]


def test_a_cell_that_is_no_number_is_named(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("t_s,ecg\n" + "".join(f"{i / 100},{'low' if i == 7 else i}\n" for i in range(50)))
    with pytest.raises(SceneError, match=r"/ecg: .*\"low\".*leave a cell empty"):
        read_signal_file(path)


@pytest.mark.parametrize(("rate", "digits"), [(1000.0, 2), (2000.0, 3), (1200.0, 3)])
def test_times_that_are_too_coarse_are_refused(rate: float, digits: int, tmp_path: Path) -> None:
    """Nine of ten samples were dropped without a word, and the rate read as a tenth."""
    path = tmp_path / "a.csv"
    path.write_text("t_s,ecg\n" + "".join(f"{int(i / rate * 10**digits) / 10**digits},{i}\n" for i in range(2000)))
    with pytest.raises(SceneError, match="have the time of the row before; state the times with more decimals"):
        read_signal_file(path)


def test_times_in_milliseconds_of_a_faster_rate_drop_nothing(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("t_s,ecg\n" + "".join(f"{round(i / 512.0, 3)},{i}\n" for i in range(5120)))
    (signal,) = read_signal_file(path)
    assert (signal.rate, signal.dropped) == (512.0, 0)
    np.testing.assert_array_equal(signal.values[0:5120], np.arange(5120.0))


def test_rows_that_are_left_out_are_counted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Three rows twice, one without a time."""
    path = tmp_path / "a.csv"
    rows = [f"{i / 200},{i % 7}" for i in range(4000)]
    for place in (3000, 2000, 1000):
        rows.insert(place, rows[place])
    path.write_text("t_s,ecg\n" + "\n".join(rows[:500] + ["nan,3"] + rows[500:]))
    assert main(["physio", str(path), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["signals"]["ecg"]["faults"]["dropped"] == 4
    assert found["signals"]["ecg"]["seconds"] == pytest.approx(20.0, abs=0.01)


def test_a_signal_that_is_too_short_is_not_called_bad(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["physio", str(write(tmp_path / "a.csv", "t_s,ecg", 125.0)), "--check"]) == 6
    assert "too short" in capsys.readouterr().out


def test_columns_of_a_stream_follow_the_same_list() -> None:
    assert columns_of(["lead_off", "ECG2", "Skin Temperature", "EDA", "ecg"]) == {"ecg": 1, "gsr": 3}


def test_a_rate_that_cannot_be_is_refused_before_the_start(tmp_path: Path) -> None:
    path = write(tmp_path / "a.csv", "t_s,eda", 2.0)
    with pytest.raises((DeviceError, SceneError), match="2 Hz"):
        open_source(f"file:{path}", 1, check_rate)
    (signal,) = read_signal_file(write(tmp_path / "b.csv", "t_s,eda", 4.0))
    check_rate(signal.name, signal.rate)
