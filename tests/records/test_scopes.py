"""Files of scopes and recorders are read without arguments, or the message says which
it needs.
"""

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
    """A recorder repeats the word Signal below the names of the channels: the names of
    the line above are taken, with the unit and the values.
    """
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


def test_without_heads_the_column_that_increases_is_that_of_times(tmp_path):
    """The message names the unit, which is left to say."""
    path = tmp_path / "channel.csv"
    path.write_text(rows(WAVE, TIMES))
    with pytest.raises(FileFormatError, match="column '2': has no unit of time"):
        ri.read_signals(path)
    record = ri.read_signals(path, time_unit="s", units="V")
    assert record["1"].values == pytest.approx(WAVE, abs=1e-8)
    assert record["1"].times == pytest.approx(TIMES, abs=1e-12)


def test_a_lecroy_scope_tells_times_and_volts(tmp_path):
    """The file of a LeCroy scope is read in s and V; its lines of segments and trigger
    times are skipped, as by the public reader parse_lecroy_segmented.
    """
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
    """A file of a Rigol scope names start and increment of the times in columns 4 and 5
    of its second line, as public readers take them. Times, values and unit of both
    channels are read.
    """
    text = "X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-1.2e-05,1.0e-06\n"
    for i, value in enumerate(WAVE):
        text += f"{i},{value:.9e},{-value:.9e},,\n"
    path = tmp_path / "NewFile1.csv"
    path.write_text(text)

    record = ri.read_signals(path)

    times = TIMES - 1.2e-5  # from Start on
    assert list(record) == ["CH1", "CH2"]
    first, second = record.values()
    assert first.times == pytest.approx(times, abs=1e-12)
    assert second.unit == "V"
    assert second.values == pytest.approx(-WAVE, abs=1e-8)


def test_a_rigol_scope_without_start_and_increment_is_refused(tmp_path):
    text = (
        "X,CH1,Start,Increment,\nSequence,Volt,none,none\n0,1.0,,\n1,2.0,,\n2,3.0,,\n"
    )
    path = tmp_path / "NewFile1.csv"
    path.write_text(text)
    with pytest.raises(FileFormatError, match="no numbers below Start and Increment"):
        ri.read_signals(path)


HEAD_OF_THREE = "t [s],a [V],b [V],c [V]\n"


def lines_with_blank_ends():
    """60 lines of times and three channels; b ends after 40 samples, c after 50."""
    lines = []
    for k in range(60):
        b = f"{-WAVE[k]:.9e}"
        c = f"{WAVE[k]:.9e}"
        if k >= 40:
            b = ""
        if k >= 50:
            c = ""
        lines.append(f"{TIMES[k]:.9e},{WAVE[k]:.9e},{b},{c}")
    return lines


def test_a_channel_may_end_with_blank_cells(tmp_path):
    """A channel of fewer samples: spreadsheets fill its column with blanks."""
    path = tmp_path / "shot.csv"
    path.write_text(HEAD_OF_THREE + "\n".join(lines_with_blank_ends()))

    record = ri.read_signals(path)

    assert [len(signal) for signal in record.values()] == [60, 40, 50]
    assert record["b"].values == pytest.approx(-WAVE[:40], abs=1e-8)
    assert record["b"].times == pytest.approx(TIMES[:40], abs=1e-12)


def test_times_may_not_end_with_blank_cells(tmp_path):
    path = tmp_path / "shot.csv"
    path.write_text("a [V],t [s]\n" + rows(WAVE, TIMES) + "3.0,\n")

    with pytest.raises(FileFormatError, match="line 62, column 't': must be a finite"):
        ri.read_signals(path)


def test_a_channel_may_not_have_blank_cells_before_its_end(tmp_path):
    """A channel with a blank cell and a number after it is refused with line and
    column; cut before this line, the file is read.
    """
    path = tmp_path / "shot.csv"
    lines = lines_with_blank_ends()
    lines[55] = lines[55].replace(",,", ",1.0,")
    path.write_text(HEAD_OF_THREE + "\n".join(lines))
    message = r"line 42, column 'b': .* got ''; correct"

    with pytest.raises(FileFormatError, match=message):
        ri.read_signals(path)
    # The remedy is to cut the record before that line.
    path.write_text(HEAD_OF_THREE + "\n".join(lines[:40]))
    assert len(ri.read_signals(path)["b"]) == 40


@pytest.mark.parametrize("dt", [0.4, 2.4, 3.05])
def test_rounded_times_are_told_once_and_replaced_by_uniform_ones(tmp_path, dt):
    """Times to whole microseconds, at steps of some microseconds or less."""
    times = np.arange(200) * dt  # us
    channels = [f"{k % 7},{k % 5}" for k in range(200)]
    lines = []
    for time, cells in zip(times, channels, strict=True):
        lines.append(f"{time:.0f},{cells}")
    path = tmp_path / "shot.csv"
    path.write_text("t [us],a [V],b [V]\n" + "\n".join(lines))
    message = "the times are rounded, their steps "

    with pytest.warns(ri.RoundedTimes, match=message) as warned:
        record = ri.read_signals(path)

    (warning,) = warned
    assert warning.filename == __file__
    assert record["a"].dt == pytest.approx(dt * 1e-6, rel=1e-3)
    assert record["b"].times == pytest.approx(times * 1e-6, abs=0.5e-6)
    # The remedy is to leave the times out and to give the rate.
    path.write_text("a [V],b [V]\n" + "\n".join(channels))
    by_rate = ri.read_signals(path, rate=1e6 / dt)
    assert by_rate["a"].values.tolist() == record["a"].values.tolist()


def test_missing_and_doubled_samples_are_not_taken_for_rounding(tmp_path):
    """A table whose times leave out a sample, or repeat one, is refused."""
    path = tmp_path / "shot.csv"
    for step, message in [(2.0, "samples are missing"), (0.0, "times must increase")]:
        steps = np.ones(200)
        steps[100] = step
        times = np.cumsum(steps)
        lines = ["t [us],a [V]"]
        for k, time in enumerate(times):
            lines.append(f"{time:.0f},{k % 7}")
        path.write_text("\n".join(lines))
        with pytest.raises(FileFormatError, match=message):
            ri.read_signals(path)


YOKOGAWA = (
    "Header Size,15\nModel Name,DLM3054\nComment,\nBlockNumber,1\nTraceName,CH1,CH2\n"
    "BlockSize,60,60\nVUnit,V,V\nSampleRate,1.0E+06,1.0E+06\n"
    "HResolution,1.0E-06,1.0E-06\nHOffset,-1.2E-05,-1.2E-05\nHUnit,s,s\n"
    "DisplayBlockSize,60,60\nDisplayPointNo.,1,1\nDate,2024/05/03,2024/05/03\n"
    "Time,10:11:12,10:11:12\n"
)


@pytest.mark.parametrize("before", ["", ","])
@pytest.mark.parametrize("gap", ["", "\n"])
def test_a_yokogawa_scope_tells_resolution_and_offset(tmp_path, before, gap):
    """The lines are those of appendix 3, ASCII data file format, of the manual IM
    DLM3054-01EN.

    It gives the time of row k as HResolution (k - 1) + HOffset.
    """
    path = tmp_path / "shot.csv"
    data = ""
    for line in rows(WAVE, -WAVE).splitlines():
        data += f"{before}{line}\n"
    path.write_text(YOKOGAWA + gap + data)

    record = ri.read_signals(path)

    assert list(record) == ["CH1", "CH2"]
    assert record["CH2"].unit == "V"
    assert record["CH1"].times == pytest.approx(TIMES - 1.2e-5, abs=1e-12)
    assert record["CH2"].values == pytest.approx(-WAVE, abs=1e-8)


def test_several_blocks_of_a_yokogawa_scope_are_refused(tmp_path):
    path = tmp_path / "shot.csv"
    head = YOKOGAWA.replace("BlockNumber,1", "BlockNumber,3")
    path.write_text(head + rows(WAVE, -WAVE))

    with pytest.raises(FileFormatError, match=r"has 3 blocks .* save a single"):
        ri.read_signals(path)


def test_a_yokogawa_scope_without_a_resolution_needs_a_rate(tmp_path):
    """A Yokogawa file without a time step is refused; its numbers alone are read with a
    given rate and unit.
    """
    path = tmp_path / "shot.csv"
    data = rows(WAVE, -WAVE)
    head = YOKOGAWA.replace("1.0E-06", "")
    path.write_text(head + data)

    with pytest.raises(FileFormatError, match="no numbers HResolution and HOffset"):
        ri.read_signals(path)
    # The remedy is to leave the head out and to give the rate.
    path.write_text(data)
    record = ri.read_signals(path, rate=1e6, units="V")
    assert list(record) == ["1", "2"]


KEYSIGHT = (
    ",Channel 2\nRevision:,0\nType:,raw\nStart:,0\nPoints:,60\nCount:,1\n"
    "XDispRange:,6e-05\nXDispOrg:,0\nXInc:,1e-06\nXOrg:,0\nXUnits:,Second\n"
    "YDispRange:,2\nYDispOrg:,0\nYInc:,1e-05\nYOrg:,0\nYUnits:,Volt\n"
    "Frame:,DSOS104A:MY0\nDate:,3 MAY 2024\nTime:,10:11:12\nMax Bandwidth:,1e+09\n"
    "Min Bandwidth:,0\nData:\n"
)


@pytest.mark.parametrize("mark", [":,", ":"])
def test_a_keysight_infiniium_scope_tells_its_channel(tmp_path, mark):
    """Names of the lines: CSV and TSV header format, Infiniium Programmer's Reference.

    Public converters of such files expect the name of the channel in the first line and
    pairs of time and volts below.
    """
    path = tmp_path / "CH2.csv"
    text = KEYSIGHT.replace(":,", mark)
    path.write_text(text + rows(TIMES, WAVE))
    (signal,) = ri.read_signals(path).values()
    assert signal.name == "Channel 2"
    assert signal.unit == "V"
    assert signal.times == pytest.approx(TIMES, abs=1e-12)
    assert signal.values == pytest.approx(WAVE, abs=1e-8)


def test_several_channels_of_a_keysight_infiniium_scope_need_a_file_each(tmp_path):
    path = tmp_path / "all.csv"
    text = KEYSIGHT.replace("XOrg:,0", "XOrg:,0,0")
    text = text.replace("Channel 2", "Channel 2,Channel 3")
    path.write_text(text + rows(TIMES, WAVE, TIMES, -WAVE))
    with pytest.raises(FileFormatError, match="save each channel in a file of its own"):
        ri.read_signals(path)


def test_a_keysight_infiniivision_scope_tells_channels_and_units(tmp_path):
    """The two lines of heads that public readers of such files expect: x-axis,1 and
    second,Volt.
    """
    path = tmp_path / "scope_0.csv"
    path.write_text("x-axis,1,2\nsecond,Volt,Volt\n" + rows(TIMES, WAVE, -WAVE))
    record = ri.read_signals(path)
    assert list(record) == ["1", "2"]
    assert record["2"].unit == "V"
    assert record["2"].values == pytest.approx(-WAVE, abs=1e-8)


def catman_heads(name, unit, sensor):
    """The 29 heads of a column: its name, its unit, and what else catman writes."""
    return [name, unit] + ["50000 Hz", sensor] * 13 + ["-"]


def test_catman_tells_names_and_units_two_dozen_lines_above_the_numbers(tmp_path):
    """Public readers of its text skip seven lines and a blank one, and take 29 lines of
    heads.

    The first line of heads has the names, the second the units; cells end at tabs,
    numbers have decimal commas.
    """
    first_lines = [f"line {k}\tof the file" for k in range(7)]
    columns = [
        catman_heads("Time  1 - default sample rate", "s", "36010"),
        catman_heads("Load", "kN", "36011"),
        catman_heads("SG_1 MX840", "\u00b5m/m", "36012"),
    ]
    heads = ["\t".join(cells) for cells in zip(*columns, strict=True)]
    numbers = rows(TIMES, WAVE, 1e3 * WAVE)
    numbers = numbers.replace(",", "\t").replace(".", ",")
    text = "\n".join([*first_lines, "", *heads, "", numbers])
    path = tmp_path / "shot.asc"
    path.write_text(text, encoding="latin-1")

    record = ri.read_signals(path)

    assert list(record) == ["Load", "SG_1 MX840"]
    load, strain = record.values()
    assert load.unit == "N"
    assert load.values == pytest.approx(1e3 * WAVE, abs=1e-5)
    assert load.times == pytest.approx(TIMES, abs=1e-12)
    assert strain.unit == ""
    assert strain.values == pytest.approx(1e-3 * WAVE, abs=1e-11)


def test_labview_files_with_commas_between_cells_are_read(tmp_path):
    """A LabVIEW file with commas as separators is read: names, unit and values of its
    two channels are right.
    """
    text = (
        "LabVIEW Measurement,\nSeparator,Comma\nDecimal_Separator,.\nX_Columns,One\n"
        "***End_of_Header***,\n,\nChannels,2,\nY_Unit_Label,V,V\nX_Dimension,Time,Time\n"
        "X0,0,0\nDelta_X,1E-6,1E-6\n***End_of_Header***,,\nX_Value,a,b,Comment\n"
    )
    path = tmp_path / "shot.lvm"
    path.write_text(text + rows(TIMES, WAVE, -WAVE))
    record = ri.read_signals(path)
    assert list(record) == ["a", "b"]
    assert record["b"].unit == "V"
    assert record["b"].values == pytest.approx(-WAVE, abs=1e-8)
