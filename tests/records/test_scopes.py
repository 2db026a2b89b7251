"""Files of scopes and recorders are read without arguments, or the message says which it needs."""

import numpy as np
import pytest

import rodimpact as ri
from rodimpact.storage.reading import FileFormatError

WAVE = np.sin(np.arange(60) / 7.0)
TIMES = np.arange(60) * 1e-6


def rows(*columns, form="{:.9e}"):
    """Lines of comma-separated numbers."""
    lines = []
    for row in zip(*columns, strict=True):
        lines.append(",".join(form.format(cell) for cell in row))
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    "heads",
    [
        "Time,Strain A,Strain B\nTime (s),Signal (V),Signal (V)\n",
        "Time,Strain A,Strain B\nTime,Signal,Signal\ns,V,V\n",
    ],
)
def test_columns_of_one_name_take_those_of_the_line_above(tmp_path, heads):
    """One laboratory's recorder repeats the word Signal below the names of the channels."""
    path = tmp_path / "shot.csv"
    path.write_text(heads + rows(TIMES, WAVE, -WAVE))
    record = ri.read_signals(path)
    assert list(record) == ["Strain A", "Strain B"]
    assert record["Strain B"].unit == "V"
    assert record["Strain B"].values == pytest.approx(-WAVE, abs=1e-8)


def test_columns_of_one_name_without_another_line_are_refused(tmp_path):
    path = tmp_path / "shot.csv"
    path.write_text("Time (s),Signal (V),Signal (V)\n" + rows(TIMES, WAVE, -WAVE))
    with pytest.raises(FileFormatError, match="two columns called 'Signal'"):
        ri.read_signals(path)


def test_values_before_times_without_heads(tmp_path):
    """The column of times is the one that increases; the message names what is left to say."""
    path = tmp_path / "channel.csv"
    path.write_text(rows(WAVE, TIMES))
    with pytest.raises(FileFormatError, match="column '2': has no unit of time"):
        ri.read_signals(path)
    record = ri.read_signals(path, time_unit="s", units="V")
    assert record["1"].values == pytest.approx(WAVE, abs=1e-8)
    assert record["1"].times == pytest.approx(TIMES, abs=1e-12)


def test_a_lecroy_scope_tells_times_and_volts(tmp_path):
    """Public readers of such files skip Segments and the trigger times: parse_lecroy_segmented."""
    head = (
        "LECROYWR64Xi-A,12345,Waveform\nSegments,1,SegmentSize,60\n"
        "Segment,TrigTime,TimeSinceSegment1\n#1,20-Nov-2014 10:11:12,0\nTime,Ampl\n"
    )
    path = tmp_path / "C1.csv"
    path.write_text(head + rows(TIMES, WAVE))
    (signal,) = ri.read_signals(path).values()
    assert signal.unit == "V"
    assert signal.times == pytest.approx(TIMES, abs=1e-12)
    assert signal.values == pytest.approx(WAVE, abs=1e-8)


def test_a_rigol_scope_tells_start_and_increment(tmp_path):
    """Public readers of such files take both from columns 4 and 5 of the second line."""
    text = "X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-1.2e-05,1.0e-06\n"
    for i, value in enumerate(WAVE):
        text += f"{i},{value:.9e},{-value:.9e},,\n"
    path = tmp_path / "NewFile1.csv"
    path.write_text(text)
    record = ri.read_signals(path)
    assert list(record) == ["CH1", "CH2"]
    assert record["CH2"].unit == "V"
    assert record["CH1"].times == pytest.approx(TIMES - 1.2e-5, abs=1e-12)
    assert record["CH2"].values == pytest.approx(-WAVE, abs=1e-8)
    path.write_text(text.replace("-1.2e-05,1.0e-06", "none,none"))
    with pytest.raises(FileFormatError, match="no numbers below Start and Increment"):
        ri.read_signals(path)
