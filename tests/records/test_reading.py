"""Tables as laboratories write them: what is read, and what is refused with a
sentence.
"""

import re
import tracemalloc

import numpy as np
import pytest
from numpy.random import default_rng

import rodimpact as ri
from rodimpact.methods import memory
from rodimpact.storage.reading import FileFormatError

T = [0.0, 1e-6, 2e-6, 3e-6]
BAR = [0.001, -0.0025, 0.25, 1.0]  # V


@pytest.fixture
def read(tmp_path):
    """A function that writes a text, or bytes, to shot.txt, and returns the signals
    that are read from it.
    """
    path = tmp_path / "shot.txt"

    def signals(text, encoding="utf-8", **options):
        """Signals of a file with this text."""
        if isinstance(text, bytes):
            path.write_bytes(text)
        else:
            path.write_bytes(text.encode(encoding))
        return ri.read_signals(path, **options)

    return signals


@pytest.mark.parametrize(
    "text",
    [
        "time_s,bar_V\n0,0.001\n1e-6,-0.0025\n2e-6,0.25\n3e-6,1\n",
        "time [us],bar [mV]\n0,1\n1,-2.5\n2,250\n3,1000\n",
        "t (ms);bar (mV)\r\n0;1\r\n0,001;-2,5\r\n0,002;250\r\n0,003;1000\r\n",
        "t/us\tbar/mV\n0\t1,0\n1\t-2,5\n2\t250\n3\t1000",
        "# shot 12, 3 May\n# time(us)  bar(V)\n\n0 .001\n1 -.0025\n2 .25\n 3  1.\n",
        "Sample rate, 1 "
        "MHz\nTime,bar\n(us),(mV)\n\n0.0,1.0\n1.0,-2.5\n2.0,250.0\n3.0,1000.0\n",
        '"Time, us","bar, mV"\n"0","1"\n"1","-2.5"\n"2","250"\n"3","1e3"\n',
        "TIME in us;bar in V;\n0,0;0,001;\n1,0;-0,0025;\n2,0;0,25;\n3,0;1,0;\n",
        "time_ns,bar_V\n0,0.001\n1000,-0.0025\n2000,0.25\n3000,1\n\n\n",
        "Zeit [µs] ; bar [mV]\n0;1\n1;-2,5\n2;250\n3;1000\n",
        "bar [mV]\tTime (us)\n1\t0\n-2.5\t1\n250\t2\n1000\t3\n",
        "x-axis,bar,,\nsecond,Volt,,\n0,.001,,\n1e-6,-.0025,,\n2e-6,.25,,\n3e-6,1,,\n,,,\n",
        "Separator\tTab\n***End_of_Header***\t\t\ntime (sec)\tbar "
        "(Volts)\tComment\n0\t0.001\t\n1e-6\t-0.0025\t\n2e-6\t0.25\t\n3e-6\t1\t\n",
        'time [us],bar [mV]\n"0","1,0"\n"1","-2,5"\n"2","250"\n"3","1e3"\n',
        '"time [us]","bar [V]"\n0,"0,001"\n1,"-,25e-2"\n2,"0,25"\n3,1\n',
        "  time [us]   bar [mV]\n    0.0    1.0\n    1.0   -2.5\n    2.0  250.0\n    "
        "3.0 1000.0\n",
    ],
    ids=range(16),
)
def test_one_record_is_read_from_tables_of_many_forms(read, text):
    """A table of this form, in four encodings, gives the same name, unit, times and
    values.
    """
    for encoding in ("utf-8", "utf-8-sig", "latin-1", "utf-16"):
        (bar,) = read(text, encoding).values()
        assert bar.name == "bar"
        assert bar.unit == "V"
        np.testing.assert_allclose(bar.times, T, rtol=1e-15, atol=0)
        np.testing.assert_allclose(bar.values, BAR, rtol=1e-15, atol=0)


WITHOUT_HEADS = "0;1\n1;-2.5\n2;250\n3;1000\n"


def test_columns_without_heads_are_numbered_and_take_units_of_arguments(read):
    """A table without heads: the second column is named "2" and has the given unit,
    converted to SI, with a column of times or with a rate.
    """
    with_times = read(WITHOUT_HEADS, time_unit="us", units="mV")
    with_rate = read(WITHOUT_HEADS, rate=1e6, units={"2": "mV"})
    assert with_times == {"2": ri.Signal(BAR, T, unit="V", name="2")}
    assert list(with_rate) == ["1", "2"]
    assert with_rate["2"].unit == "V"


def test_arguments_name_the_column_of_times_and_units_of_columns(read):
    """`read_signals` is given the name of the column of times and units of times and
    one column: this one is converted to SI, the other has no unit.
    """
    text = "clock,a,b\n0,1,2\n1,3,4\n"
    signals = read(text, time="clock", time_unit="ms", units={"b": "kN"})
    b = ri.Signal([2000.0, 4000.0], [0.0, 1e-3], unit="N", name="b")
    assert signals["b"] == b
    assert signals["a"].unit == ""


def test_a_single_column_with_a_rate_is_a_signal_with_the_unit_of_its_head(read):
    strain = read("bar_microstrain\n100\n-200\n", rate=1e6)["bar"]
    volts = read("bar one [mV]\n1\n2\n", rate=1.0)["bar one"]
    assert strain == ri.Signal([1e-4, -2e-4], dt=1e-6, name="bar")
    assert volts.values.tolist() == [0.001, 0.002]
    assert volts.unit == "V"


@pytest.mark.parametrize(
    ("text", "options", "values"),
    [
        # A minus sign in place of a hyphen
        ("time_s;a\n0;\N{MINUS SIGN}1\n1;2\n", {}, [-1.0, 2.0]),
        # A comma before three digits is a decimal sign if an argument says so, or if
        # no number has a 0 before a separator of thousands.
        ("time_s;a\n0;1,001\n1;1,002\n", {"decimal": ","}, [1.001, 1.002]),
        ("time_s;a\n0;1,001\n1;0,002\n", {}, [1.001, 0.002]),
        # Cells in quotes have decimal commas beside cells that commas separate.
        ('time_s,a\n0,1\n1,2\n2,"2,5"\n', {}, [1.0, 2.0, 2.5]),
    ],
)
def test_numbers_are_read_with_the_decimal_sign_that_they_must_have(
    read, text, options, values
):
    """The column "a" of a text has these values, by the decimal sign that an argument
    gives or that follows from the text.
    """
    signal = read(text, **options)["a"]
    assert signal.values.tolist() == values


def test_a_comma_separates_columns_or_is_a_decimal_sign_as_heads_or_arguments_say(read):
    """The text "1,5" is one number with a decimal comma, two columns with a decimal
    point or below two heads, and one number again between quotes.
    """
    text = "1,5\n2,5\n"
    by_decimal_comma = read(text, rate=1.0, decimal=",")
    by_decimal_point = read(text, rate=1.0, decimal=".")
    by_heads = read("a,b\n" + text, rate=1.0)
    quoted = read('0,1\n1,"2,5"\n', time_unit="s", decimal=",")
    assert by_decimal_comma["1"].values.tolist() == [1.5, 2.5]
    assert list(by_decimal_point) == ["1", "2"]
    assert list(by_heads) == ["a", "b"]
    assert quoted["2"].values.tolist() == [1.0, 2.5]


@pytest.mark.parametrize(
    ("text", "options", "said"),
    [
        (
            "time,a\n0,1\n1,2\n",
            {},
            "column 'time': has no unit of time; give time_unit=, one of 's'",
        ),
        ("time [min],a\n0,1\n1,2\n", {}, "column 'time': unknown unit 'min'"),
        (
            "time [V],a\n0,1\n1,2\n",
            {},
            "column 'time': has no unit of time; give time_unit=",
        ),
        ("time_s,a [furlong]\n0,1\n1,2\n", {}, "column 'a': unknown unit 'furlong'"),
        (
            "a,b\n0,1\n1,2\n",
            {},
            "must have one column called 'time' and another one, has 'a', 'b';",
        ),
        (
            "a,b\n0,1\n1,2\n",
            {"time": "c"},
            "must have one column called 'c' and another one, has",
        ),
        (
            "time_s,a\n0,1\n1,2\n",
            {"rate": 1.0},
            "has a column of times, 'time'; leave rate out",
        ),
        (
            "1\n2\n3\n",
            {},
            "has '1'; give the head of one as time=, or give rate=, the sampling",
        ),
        ("time_s,a\n0,1\n", {}, "has one line of numbers; a signal needs two"),
        ("time_s,a,a\n0,1,2\n1,2,3\n", {}, "has two columns called 'a'; rename one"),
        ("time_s,time_us,a\n0,0,1\n1,1,2\n", {}, "has two columns called 'time'"),
        (
            "1,5\n2,5\n",
            {"rate": 1.0},
            "line 1: '1,5' may be two numbers or a decimal comma",
        ),
        (
            "time_s,a\n0,1\n1,2\n2,x\n3,4\n",
            {},
            "line 4, column 'a': must be a finite number, got 'x'",
        ),
        (
            "time_s,a\n0,1\n1,2\n2,\n3,4\n",
            {},
            "line 4, column 'a': must be a finite number, got ''",
        ),
        (
            "time_s,a\n0,1\n1,2\n2,nan\n3,4\n",
            {},
            "line 4, column 'a': must be a finite number",
        ),
        (
            "time_s,a\n0,1\n1,2\n2,3\n3,4,5\n",
            {},
            "line 5: has 3 columns, the lines above have 2",
        ),
        (
            "time_s,a\n0,1\n1,2\n1,3\n",
            {},
            "line 4, column 'time': 1 s comes after 1 s; times must",
        ),
        (
            "time_s,a\n" + "".join(f"{i + 5 * (i > 30)},1\n" for i in range(60)),
            {},
            "line 33, column 'time': 36 s comes after 30 s; samples are missing",
        ),
        ("no numbers here\n", {}, "has no table of numbers"),
        ("", {}, "has no table of numbers"),
        (b"PK\x03\x04\0\0\0", {}, "is not text (it contains the character NUL)"),
        (
            "time_s\ta\n0\t1\n1\t2\n".encode("utf-32"),
            {},
            "is not text (it contains the character NUL)",
        ),
        ("time_s;a\n0;1,001\n1;1,002\n", {}, "such as '1,001': "),
        (
            "time_s;a\n0;1.001\n1;1.002\n",
            {},
            'give decimal="." if a decimal sign, otherwise',
        ),
        ("time_s;a\n" + "0;1,234.5\n" * 4, {}, "line 3 has '1,234.5'; below the heads"),
        (
            "time_s;a\n" + "0;1'234\n" * 4,
            {},
            """line 3 has "1'234"; below the heads write only""",
        ),
        (
            "time,a\n" + "2026-05-03 10:11:12,1\n" * 4,
            {},
            "line 3 has '2026-05-03 10:11:12'; bel",
        ),
        (
            "time_s,a,b\n" + "0,1,ok\n" * 4,
            {},
            "line 3 has 'ok'; below the heads write only numbers",
        ),
        ("time_s,a\n" + "0,0x1\n" * 4, {}, "line 3 has '0x1'; below the heads"),
        (
            "time_s|a\n" + "0|1\n" * 4,
            {},
            "no table of numbers: line 3 has '0|1'; below",
        ),
        (
            "time_s,a, left\n0.5,1\n1,2\n",
            {},
            "has the 3 heads ['time_s', 'a', 'left'] for 2 columns",
        ),
        (
            "time_s,a\n0,#N/A\n1,2\n2,3\n",
            {},
            "begins with a line that mixes ['0', '#N/A'] and numbers",
        ),
        (
            "0,0;-0,\n0,1;1,5\n0,2;2,5\n",
            {},
            "begins with a line that mixes ['0,0', '-0'] and",
        ),
        (
            "time_s\n0\n1\n",
            {"rate": 1.0},
            "has a column of times, 'time'; leave rate out",
        ),
        (
            "time_s,a [mv]\n0,1\n1,2\n",
            {},
            "column 'a': unknown unit 'mv'; perhaps 'mV' is meant",
        ),
        (
            'time_s,a\n0,1\n1,2\n2,"2,5"\n',
            {"decimal": "."},
            "line 3 has 2 numbers, but not all lines",
        ),
        ('time_s,a\n0,"1,001"\n1,"1,002"\n', {}, "such as '1,001': "),
        (
            "time_s,a\n0,1\n1,2,3\n2,3\n3,4,5\nend\n",
            {},
            "line 4 has 2 numbers, but not all",
        ),
        ("time_s,a\n0,1\nx\n0,1\nx\n", {}, "has no table of numbers: line 3 has 'x'"),
        (
            "time_s;a\n0;1,5\n1;2,5\n2;3,5\n3;1.5\n",
            {},
            "line 5, column 'a': must be a finite",
        ),
        pytest.param(
            "note\n" * 30_000 + "0,1\n" * 10,
            {},
            "has no table of numbers",
            marks=pytest.mark.exhaustive,
        ),
    ],
    ids=range(41),
)
def test_a_text_that_is_no_record_is_refused_with_the_line_or_column(
    read, text, options, said
):
    with pytest.raises(FileFormatError, match=f"shot.txt: .*{re.escape(said)}"):
        read(text, **options)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"rate": 1.0, "time": "a"}, "rate: give either rate or a column of times"),
        ({"rate": -1.0}, "rate: must be .*, got -1.0"),
        ({"decimal": ";"}, "decimal: must be one of"),
        ({"units": {"c": "V"}}, "units: there is no channel 'c'; use one of a"),
        ({"units": 3}, "unknown unit 3"),
        ({"units": {"a": 3}}, "unknown unit 3"),
        ({"progress": 3}, "progress: must be True, False or a function"),
    ],
)
def test_wrong_options_are_refused(read, options, said):
    """Each spoils a call that is right with a rate of 1 Hz."""
    arguments = {"rate": 1.0}
    arguments.update(options)
    with pytest.raises(ValueError, match=said):
        read("a\n1\n2\n", **arguments)


def table_of(times, values):
    """Text of a table with columns of times, s, and volts."""
    lines = ["time_us,a_V\n"]
    for time, value in zip(times.tolist(), values.tolist(), strict=True):
        lines.append(f"{time},{value!r}\n")
    return "".join(lines)


SAMPLE_TIMES = np.arange(300)  # us
ROUGH_WAVE = 3 * np.sin(SAMPLE_TIMES / 40) + 0.1 * np.sin(SAMPLE_TIMES**2)
"""A wave of 3 V with some noise, no two samples of which are equal."""


def test_a_channel_at_the_limit_of_its_recorder_is_announced(read):
    """A wave cut at 2 V is read with the warning `ClippedSignal`, which names column,
    value and line.
    """
    limit = 2.0  # V
    text = table_of(SAMPLE_TIMES, np.minimum(ROUGH_WAVE, limit))
    message = "column 'a' stays at 2 for [0-9]+ samples from line"

    with pytest.warns(ri.ClippedSignal, match=message):
        clipped = read(text)["a"]

    assert clipped.values.max() == limit


def test_rounded_values_and_computed_steps_are_not_taken_for_a_limit(read):
    """Warnings are errors in these tests."""
    rounded = ROUGH_WAVE.round(1)
    is_pushed = (SAMPLE_TIMES > 100) & (SAMPLE_TIMES < 200)
    step = np.where(is_pushed, -1.0, 0.0)
    read(table_of(SAMPLE_TIMES, rounded))
    read(table_of(SAMPLE_TIMES, step))


def test_times_that_are_not_uniform_on_purpose_are_no_gap(read):
    """A table whose time steps grow steadily is read with its times, and no gap is
    reported.
    """
    steps = np.arange(1, 20) ** 2  # us; each is larger than the one before
    times = np.cumsum(steps)
    text = table_of(times, np.ones(19))
    signal = read(text)["a"]
    assert signal.times == pytest.approx(1e-6 * times, rel=1e-15)


def peak_of(call):
    """Result of a call, and the largest number of bytes that it took at any one time."""
    tracemalloc.start()
    try:
        result = call()
        _, peak = tracemalloc.get_traced_memory()
        return result, peak
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    ("digits", "wrong_end"),
    [
        pytest.param(2, "", marks=pytest.mark.exhaustive),
        (2, "1x"),
        pytest.param(4, "1,2,3,4", marks=pytest.mark.exhaustive),
        pytest.param(8, "", marks=pytest.mark.exhaustive),
    ],
)
def test_memory_is_bounded_by_four_times_the_file(
    tmp_path, monkeypatch, digits, wrong_end
):
    """Reading takes no more, also where numbers are short, and where the end of the
    last line is wrong.

    Blocks are as small beside this file as usual ones are beside a large file.
    """
    monkeypatch.setattr("rodimpact.records.table.BLOCK_ROWS", 64)
    monkeypatch.setattr("rodimpact.records.text_file.BLOCK", 2000)
    monkeypatch.setattr("rodimpact.records.reading.BLOCK_SAMPLES", 1000)
    path = tmp_path / "shot.csv"
    path.write_text("time_s,a\n0,1\n1,2\n")
    ri.read_signals(path)  # all modules are imported before memory is measured
    rng = default_rng(0)
    numbers = rng.integers(10 ** (digits - 1), 10**digits, 20_000).tolist()
    rows = [f"{i},{number}" for i, number in enumerate(numbers)]
    if wrong_end:
        last = len(rows) - 1
        rows[last] = f"{last},{wrong_end}"
    path.write_text("time_s,a\n" + "\n".join(rows))

    def values_or_message():
        try:
            return ri.read_signals(path)["a"].values
        except FileFormatError as error:
            return str(error)

    answer, peak = peak_of(values_or_message)

    if wrong_end:
        last_line = len(rows) + 1  # with the heads
        assert f"line {last_line}" in answer
    else:
        assert answer.tolist() == numbers
    size = path.stat().st_size
    assert peak < 4 * size


@pytest.mark.exhaustive
def test_a_large_table_takes_up_to_four_times_its_size_and_reports_progress(
    read, tmp_path
):
    """A table of 60,000 rows is read exactly with a peak of memory below four times its
    size, and with more than five rising reports of progress.
    """
    read("time_s,a\n0,1\n1,2\n")  # all modules are imported before memory is measured
    a, b = default_rng(0).normal(size=(2, 60_000)).round(7).tolist()
    lines = ["time_s,a_V,b_V\n"]
    for i in range(60_000):
        lines.append(f"{i}e-7,{a[i]},{b[i]}\n")
    text = "".join(lines)
    path = tmp_path / "shot.csv"
    path.write_text(text)
    reports = []

    def progress(done, total):
        reports.append(done)
        assert done <= total == len(text)

    signals, peak = peak_of(lambda: ri.read_signals(path, progress=progress))

    assert peak < 4 * len(text)
    assert signals["a"].values.tolist() == a
    assert signals["b"].values.tolist() == b
    assert reports == sorted(reports)
    assert len(reports) > 5


def test_a_table_that_takes_half_the_memory_is_refused_before_it_is_read(
    read, monkeypatch
):
    """With an installed memory just below twice the need of a table, reading it raises
    MemoryError with this figure.
    """
    text = "time_s,a\n0,1\n1,2\n"
    needed = 4 * len(text)  # bytes: reading takes up to four times the file
    monkeypatch.setattr(memory, "installed", lambda: 2.0 * needed - 1)
    message = r"shot\.txt: takes up to .* GB of memory, more"

    with pytest.raises(MemoryError, match=message):
        read(text)


def test_blank_lines_and_cells_change_neither_numbers_nor_the_lines_that_are_named(
    read, monkeypatch
):
    """A table with blank lines and empty cells, read in small blocks, has its values; a
    wrong time is reported with the number of its line in the file.
    """
    # Blocks of 50 bytes end in the midst of lines.
    monkeypatch.setattr("rodimpact.records.text_file.BLOCK", 50)
    values = [i * i % 7 for i in range(300)]
    lines = ["time_s,a"]
    for i, value in enumerate(values):
        lines.append(f"{i},{value},,")
        if i % 5 == 0:
            lines.append("")
    last_line = lines.index("299,4,,") + 1
    text = "\n".join([*lines, ",,,", "", ""])
    with_doubled_time = text.replace("\n299,4", "\n298,4")

    signal = read(text)["a"]

    assert signal.values.tolist() == values
    message = f"line {last_line}, column 'time': 298 s comes after"
    with pytest.raises(FileFormatError, match=message):
        read(with_doubled_time)


LVM = "\n".join(
    [
        "LabVIEW Measurement\t",
        "Writer_Version\t2",
        "Separator\tTab",
        "Decimal_Separator\t{sign}",
        "X_Columns\t{columns}",
        "Time_Pref\tAbsolute",
        "Date\t2020/01/02",
        "Time\t12:30:10.5",
        "***End_of_Header***\t",
        "\t",
        "Channels\t2\t",
        "Samples\t4\t4\t",
        "Y_Unit_Label\tmV\tVolts\t",
        "X_Dimension\tTime\tTime\t",
        "X0\t1.0E-3\t1.0E-3\t",
        "Delta_X\t1.0E-6\t1.0E-6\t",
        "***End_of_Header***\t\t",
        "X_Value\tincident\ttransmitted\tComment",
        "",
    ]
)
TIMES = [1e-3, 1.001e-3, 1.002e-3]
INCIDENT = [0.5, 1.5, 2.5]  # mV
TRANSMITTED = [0.0, 1.0, 4.0]  # V
ROWS = [
    f"{t:.6f}\t{a:.6f}\t{b:.6f}"
    for t, a, b in zip(TIMES, INCIDENT, TRANSMITTED, strict=True)
]
ROWS_WITHOUT_TIMES = "\n".join(row[row.find("\t") :] for row in ROWS)
MSO = "\n".join(
    [
        "Model,MSO4034",
        "",
        "Waveform Type,ANALOG",
        "Horizontal Units,s",
        "Sample Interval,1e-06",
        "Record Length,4",
        "Probe Attenuation,1,1",
        "Vertical Units,mV,V",
        ",",
        "Label,,",
        "TIME,incident,transmitted",
        *(row.replace("\t", ",") for row in ROWS),
        "",
    ]
)


@pytest.mark.parametrize(
    "text",
    [
        LVM.format(columns="One", sign=".") + "\n".join(ROWS),
        LVM.format(columns="One", sign=",") + "\n".join(ROWS).replace(".", ","),
        LVM.format(columns="No", sign=".") + ROWS_WITHOUT_TIMES,
        LVM.format(columns="No", sign=",") + ROWS_WITHOUT_TIMES.replace(".", ","),
        MSO,
    ],
)
def test_files_of_labview_and_tektronix_say_units_and_times(tmp_path, text):
    """A file of either kind is read: names, times, units and values of both signals are
    right.
    """
    path = tmp_path / "shot"
    path.write_text(text)

    record = ri.read_signals(path)

    assert list(record) == ["incident", "transmitted"]
    incident, transmitted = record.values()
    volts = 1e-3 * np.array(INCIDENT)
    np.testing.assert_allclose(incident.values, volts, rtol=1e-12)
    np.testing.assert_allclose(transmitted.values, TRANSMITTED, rtol=1e-12)
    for signal in (incident, transmitted):
        np.testing.assert_allclose(signal.times, TIMES, rtol=1e-9)
        assert signal.unit == "V"


def test_entries_of_a_scope_may_stand_beside_its_table(tmp_path):
    """A scope file has its settings in the first two columns and the samples beside
    them: name, unit, times and values of the one signal are read.
    """
    entries = [
        "Record Length,4,",
        "Sample Interval,1e-6,",
        "Source,CH2,",
        "Vertical Units,V,",
        "Horizontal Units,s,",
        ",,",
        ",,",
        ",,",
    ]
    rows = []
    for i, entry in enumerate(entries):
        time = 1e-6 * i
        volts = i * i
        rows.append(f"{entry},{time:015.9f},{volts:9.4f},")
    path = tmp_path / "shot.csv"
    path.write_text("\n".join(rows))

    (signal,) = ri.read_signals(path).values()

    assert signal.name == "CH2"
    assert signal.unit == "V"
    np.testing.assert_allclose(signal.times, 1e-6 * np.arange(8), rtol=1e-12)
    np.testing.assert_allclose(signal.values, np.arange(8) ** 2)


def test_empty_entries_of_labview_are_missing_ones(tmp_path):
    """A LabVIEW file with an empty entry for its columns or its decimal sign is read;
    without the start and step of its times it is refused.
    """
    path = tmp_path / "shot"
    with_times = LVM.format(columns="One", sign=".") + "\n".join(ROWS)
    without_times = LVM.format(columns="No", sign=".") + ROWS_WITHOUT_TIMES
    no_columns = with_times.replace("X_Columns\tOne", "X_Columns\t")
    no_sign = without_times.replace("Decimal_Separator\t.", "Decimal_Separator\t")
    for text in (no_columns, no_sign):
        path.write_text(text)
        record = ri.read_signals(path)
        assert list(record) == ["incident", "transmitted"]

    no_start = without_times.replace("X0\t1.0E-3\t1.0E-3", "X0\t\t")
    path.write_text(no_start)
    with pytest.raises(ri.FileFormatError, match="no numbers X0 and Delta_X"):
        ri.read_signals(path)


def test_an_empty_unit_of_a_channel_of_tektronix_is_none(tmp_path):
    path = tmp_path / "shot"
    text = MSO.replace("Vertical Units,mV,V", "Vertical Units,,V")
    path.write_text(text)
    incident, transmitted = ri.read_signals(path).values()
    assert incident.unit == ""
    assert transmitted.unit == "V"


def test_an_empty_unit_of_time_of_tektronix_is_missing(tmp_path):
    """A Tektronix file without a unit of time is refused with the advice of time_unit."""
    path = tmp_path / "shot"
    text = MSO.replace("Horizontal Units,s", "Horizontal Units,")
    path.write_text(text)
    with pytest.raises(ri.FileFormatError, match="has no unit of time; give time_unit"):
        ri.read_signals(path)


def test_an_empty_source_beside_a_table_names_no_channel(tmp_path):
    """A scope file whose Source is empty has one signal with the default name CH1."""
    entries = [
        "Record Length,4,",
        "Sample Interval,1e-6,",
        "Source,,",
        "Vertical Units,V,",
        "Horizontal Units,s,",
        ",,",
    ]
    rows = [f"{entry},{i}e-6,{i * i}" for i, entry in enumerate(entries)]
    path = tmp_path / "shot.csv"
    path.write_text("\n".join(rows))
    assert list(ri.read_signals(path)) == ["CH1"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (LVM.format(columns="Multi", sign="."), "a column of times for each channel"),
        (
            LVM.format(columns="No", sign=".").replace("Delta_X", "Delta"),
            "no numbers X0 and Delta_X",
        ),
    ],
)
def test_files_of_labview_without_times_are_refused(tmp_path, text, said):
    path = tmp_path / "shot.lvm"
    path.write_text(text + "\n".join(ROWS))
    with pytest.raises(ri.FileFormatError, match=said):
        ri.read_signals(path)
