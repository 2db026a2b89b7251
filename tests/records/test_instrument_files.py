"""Workbooks and TDMS files hold the same record as a text, and wrong ones are
refused.
"""

import struct
import sys

import numpy as np
import pytest

import rodimpact as ri
from rodimpact.storage.reading import FileFormatError

WAVE = np.sin(np.arange(40) / 7.0)
TIMES = np.arange(40) * 1e-6
HEADS = ["Time [us]", "incident [mV]", "transmitted"]


def sheet():
    """Rows of a sheet: a title, heads, then 40 times in us, 40 values in mV and 30
    strains.
    """
    rows = [["Shot 12", None, None], HEADS]
    for k in range(40):
        microseconds = 1e6 * TIMES[k]
        millivolts = 1e3 * WAVE[k]
        transmitted = 2 * WAVE[k]
        if k >= 30:
            transmitted = None
        rows.append([microseconds, millivolts, transmitted])
    return rows


def write_xlsx(path, rows):
    """A workbook with these rows in its first sheet, and a second sheet."""
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for row in rows:
        book.active.append(row)
    book.create_sheet("notes").append(["not read"])
    book.save(path)


# Kinds of records of a worksheet of BIFF2
BOF = 0x0009
NUMBER = 0x0003
LABEL = 0x0004
EOF = 0x000A


def write_xls(path, rows):
    """A worksheet of BIFF2, the first and simplest form of .xls.

    Its records are described in "OpenOffice.org's documentation of the Microsoft Excel
    file format".
    """
    pytest.importorskip("xlrd")

    def record(kind, data):
        return struct.pack("<HH", kind, len(data)) + data

    stream = record(BOF, struct.pack("<HH", 2, 0x0010))
    for i, row in enumerate(rows):
        for j, cell in enumerate(row):
            row_and_column = struct.pack("<HH3x", i, j)
            if isinstance(cell, str):
                text = cell.encode("ascii")
                length = bytes([len(text)])
                stream += record(LABEL, row_and_column + length + text)
            elif cell is not None:
                number = struct.pack("<d", cell)
                stream += record(NUMBER, row_and_column + number)
    stream += record(EOF, b"")
    path.write_bytes(stream)


@pytest.mark.parametrize(
    ("ending", "write"), [("xlsx", write_xlsx), ("xls", write_xls)]
)
def test_the_first_sheet_of_a_workbook_is_a_table(tmp_path, ending, write):
    """Two signals are read from the first sheet of a workbook: names, units, values and
    times are right, also for the shorter one.
    """
    path = tmp_path / f"shot.{ending}"
    write(path, sheet())

    incident, transmitted = ri.read_signals(path).values()

    assert incident.name == "incident"
    assert incident.unit == "V"
    assert transmitted.unit == ""
    np.testing.assert_allclose(incident.values, WAVE, rtol=1e-14)
    np.testing.assert_allclose(incident.times, TIMES, rtol=1e-14, atol=1e-22)
    np.testing.assert_allclose(transmitted.values, 2 * WAVE[:30], rtol=1e-15)


@pytest.mark.parametrize(
    ("ending", "write"), [("xlsx", write_xlsx), ("xls", write_xls)]
)
def test_a_wrong_cell_of_a_workbook_is_named_by_line_and_column(
    tmp_path, ending, write
):
    """A word in a workbook of numbers is refused with its line and column; cut before
    this line, the sheet is read.
    """
    path = tmp_path / f"shot.{ending}"
    rows = sheet()
    rows[20][1] = "high"
    write(path, rows)

    with pytest.raises(FileFormatError, match=r"line 21, column 'incident': .* 'high'"):
        ri.read_signals(path)
    # The remedy is to cut the record before that line: 18 samples below two lines.
    write(path, rows[:20])
    incident = ri.read_signals(path)["incident"]
    assert len(incident) == 18


def test_a_text_that_is_called_xls_is_read_as_text(tmp_path):
    path = tmp_path / "shot.xls"
    path.write_text("time [us]\ta [V]\n0\t1\n1\t2\n2\t4\n")
    assert ri.read_signals(path)["a"].values.tolist() == [1.0, 2.0, 4.0]


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("shot.xlsx", b"PK\x03\x04 no workbook"),
        ("shot.xls", b"\xd0\xcf\x11\xe0 no workbook"),
        ("shot.tdms", b"no such file at all"),
    ],
)
def test_damaged_files_are_refused(tmp_path, name, content):
    """A file with the ending of a workbook or a TDMS file, but other bytes, is refused
    by its name.
    """
    # Each of the three kinds is read by another package.
    for package in ("openpyxl", "xlrd", "nptdms"):
        pytest.importorskip(package)
    path = tmp_path / name
    path.write_bytes(content)
    message = rf"{name}: is no (workbook|TDMS file) that"

    with pytest.raises(FileFormatError, match=message):
        ri.read_signals(path)


@pytest.mark.parametrize(
    ("name", "package", "extra"),
    [
        ("shot.xlsx", "openpyxl", "excel"),
        ("shot.xls", "xlrd", "excel"),
        ("shot.tdms", "nptdms", "tdms"),
    ],
)
def test_a_missing_package_names_its_extra(tmp_path, monkeypatch, name, package, extra):
    """A file of this kind is read without the package for it: ImportError names the
    package and the extra of rodimpact.
    """
    monkeypatch.setitem(sys.modules, package, None)
    path = tmp_path / name
    path.write_bytes(b"\xd0\xcf\x11\xe0")
    with pytest.raises(ImportError, match=rf"{package} .* 'rodimpact\[{extra}\]'"):
        ri.read_signals(path)


def write_tdms(path, *channels):
    """Channels as (group, name, values, properties)."""
    nptdms = pytest.importorskip("nptdms")
    with nptdms.TdmsWriter(path) as file:
        for channel in channels:
            file.write_segment([nptdms.ChannelObject(*channel)])


CLOCK = {"wf_increment": 1e-6, "wf_start_offset": -5e-6}


def test_a_tdms_file_has_times_and_units_in_its_properties(tmp_path):
    """Two channels of one name bear the name of their group, too.

    Names of the properties: the manuals of LabVIEW on waveform channels in TDMS files.
    """
    path = tmp_path / "shot.tdms"
    write_tdms(
        path,
        ("bars", "incident", 1e3 * WAVE, CLOCK | {"unit_string": "mV"}),
        ("bars", "force", WAVE[:30], CLOCK | {"unit_string": "Volts"}),
        ("wall", "force", WAVE, CLOCK),
    )

    record = ri.read_signals(path)

    assert list(record) == ["incident", "bars/force", "wall/force"]
    incident, force, wall_force = record.values()
    assert incident.unit == "V"
    assert force.unit == "V"
    assert wall_force.unit == ""
    np.testing.assert_allclose(incident.values, WAVE, rtol=1e-14)
    np.testing.assert_allclose(incident.times, TIMES - 5e-6, atol=1e-18)
    assert len(force) == 30


def test_a_tdms_file_without_a_clock_may_have_a_column_of_times(tmp_path):
    """A TDMS file with times in us as a channel: the other channel has these times, in
    s.
    """
    path = tmp_path / "shot.tdms"
    times = ("shot", "t", 1e6 * TIMES, {"unit_string": "us"})
    write_tdms(path, times, ("shot", "a", WAVE))
    signal = ri.read_signals(path)["a"]
    np.testing.assert_allclose(signal.times, TIMES, atol=1e-18)


def test_a_tdms_file_without_times_needs_a_rate(tmp_path):
    """A TDMS file without times is refused with the advice of rate=, with which it is
    read in V.
    """
    path = tmp_path / "shot.tdms"
    write_tdms(path, ("shot", "a", WAVE))
    with pytest.raises(FileFormatError, match="or give rate="):
        ri.read_signals(path)
    by_rate = ri.read_signals(path, rate=1e6, units="V")["a"]
    np.testing.assert_allclose(by_rate.times, TIMES, atol=1e-18)
    assert by_rate.unit == "V"


def test_channels_of_a_tdms_file_with_two_clocks_need_two_files(tmp_path):
    """A TDMS file whose channels have two time steps is refused; the slow channel in a
    file of its own is read with its step.
    """
    both = tmp_path / "both.tdms"
    slow_alone = tmp_path / "slow.tdms"
    fast = ("shot", "a", WAVE, CLOCK)
    slow = ("shot", "b", WAVE, {"wf_increment": 2e-6})
    write_tdms(both, fast, slow)
    write_tdms(slow_alone, slow)

    message = r"'b' has the time step 2e-06 s .* different"
    with pytest.raises(FileFormatError, match=message):
        ri.read_signals(both)
    signal = ri.read_signals(slow_alone)["b"]
    assert signal.dt == pytest.approx(2e-6)
