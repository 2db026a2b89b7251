"""Each remedy that a refusal of a record names makes that very file readable."""

import pytest

import rodimpact as ri
from rodimpact.storage.reading import FileFormatError

LVM = (
    "LabVIEW Measurement\t\nX_Columns\tNo\n***End_of_Header***\t\nX_Dimension\tTime\n"
    "X0\t\nDelta_X\t1E-6\n***End_of_Header***\t\nX_Value\ta\n\t1\n\t2\n\t4\n"
)
LVM_WITH_TIMES = LVM.replace("\tNo", "\tOne").replace("\n\t", "\n0.\t", 1)
LVM_WITH_TIMES = LVM_WITH_TIMES.replace("\n\t2", "\n1.\t2").replace("\n\t4", "\n2.\t4")
RIGOL = "X,CH1,Start,Increment,\nSequence,Volt,none,none,\n0,1,,\n1,2,,\n2,4,,\n"


@pytest.mark.parametrize(
    ("text", "options", "says", "remedy", "remedy_options"),
    [
        # cells and lines
        (
            "t_s,a\n0,1\n1,2\n2,x\n3,4\n",
            {},
            "correct the line",
            "t_s,a\n0,1\n1,2\n2,3\n3,4\n",
            {},
        ),
        (
            "t_s,a\n0,1\n1,2\n2,x\n3,4\n",
            {},
            "or cut the record before it",
            "t_s,a\n0,1\n1,2\n",
            {},
        ),
        (
            "t_s,a\n0,1\n1,2\n2,3\n3,4,5\n",
            {},
            "3 columns, .* or cut the record before it",
            "t_s,a\n0,1\n1,2\n2,3\n",
            {},
        ),
        (
            "t_s,a\n0,1\n1,2,3\n2,3\n3,4,5\n",
            {},
            "every line needs a number for each column",
            "t_s,a,b\n0,1,2\n1,2,3\n2,3,4\n3,4,5\n",
            {},
        ),
        (
            "t_s|a\n0|1\n1|2\n2|3\n",
            {},
            "in columns separated by tabs, semicolons, commas or blanks",
            "t_s;a\n0;1\n1;2\n2;3\n",
            {},
        ),
        (
            "t,a\n2026-05-03 10:11:12,1\n2026-05-03 10:11:13,2\n",
            {},
            "below the heads write only numbers, .* times in seconds",
            "t_s,a\n0,1\n1,2\n",
            {},
        ),
        (
            "t_s;a\n0;1'234\n1;1'235\n2;1'236\n",
            {},
            "and no separators of thousands",
            "t_s;a\n0;1234\n1;1235\n2;1236\n",
            {},
        ),
        (
            "",
            {},
            "export it as text, with one row for each sample",
            "0;1\n1;2\n",
            {"time_unit": "s"},
        ),
        # decimal sign
        (
            "1,5\n2,5\n",
            {"rate": 1.0},
            'give decimal="." or decimal=","',
            None,
            {"rate": 1.0, "decimal": ","},
        ),
        (
            "1,5\n2,5\n",
            {"rate": 1.0},
            'give decimal="." or',
            None,
            {"rate": 1.0, "decimal": "."},
        ),
        (
            "t_s;a\n0;1,001\n1;1,002\n",
            {},
            'give decimal="," if a decimal sign',
            None,
            {"decimal": ","},
        ),
        (
            "t_s;a\n0;1,001\n1;1,002\n",
            {},
            "otherwise write the numbers without it",
            "t_s;a\n0;1001\n1;1002\n",
            {},
        ),
        # heads
        (
            "t_s,a\n0,#N/A\n1,2\n2,3\n",
            {},
            "mixes .* and numbers; complete",
            "t_s,a\n0,1\n1,2\n2,3\n",
            {},
        ),
        (
            "t_s,a\n0,#N/A\n1,2\n2,3\n",
            {},
            "complete or remove it",
            "t_s,a\n1,2\n2,3\n",
            {},
        ),
        (
            "t_s,a,a\n0,1,2\n1,2,3\n",
            {},
            "two columns called 'a'; rename one",
            "t_s,a,b\n0,1,2\n1,2,3\n",
            {},
        ),
        (
            "t_s,a, left\n0.5,1\n1,2\n",
            {},
            "3 heads .* for 2 columns of numbers; name each column",
            "t_s,a left\n0.5,1\n1,2\n",
            {},
        ),
        # times
        ("t,a\n0,1\n1,2\n", {}, "give time_unit=", None, {"time_unit": "us"}),
        (
            "t_V,a_s\n0,1\n1,2\n",
            {},
            "or give the head of the column of times as time=",
            None,
            {"time": "a"},
        ),
        (
            "c_s,a\n0,1\n1,2\n",
            {},
            "called 'time' .* give the head of one as time=",
            None,
            {"time": "c"},
        ),
        ("a,b\n0,1\n1,2\n", {}, "or give rate=", None, {"rate": 1e6}),
        (
            "t_s,a\n0,1\n1,2\n",
            {"rate": 1.0},
            "has a column of times, 't'; leave rate out",
            None,
            {},
        ),
        (
            "t_s,a\n0,1\n1,2\n1,3\n",
            {},
            "remove the column and give rate",
            "a\n1\n2\n3\n",
            {"rate": 1.0},
        ),
        (
            "t_s,a\n" + "".join(f"{i + 5 * (i > 30)},1\n" for i in range(60)),
            {},
            "samples are missing; cut the record there",
            "t_s,a\n" + "".join(f"{i},1\n" for i in range(31)),
            {},
        ),
        (
            "t_s,a\n" + "".join(f"{i + 5 * (i > 30)},1\n" for i in range(60)),
            {},
            "or fill in the samples",
            "t_s,a\n" + "".join(f"{i},1\n" for i in range(65)),
            {},
        ),
        ("t_s,a\n0,1\n", {}, "a signal needs two", "t_s,a\n0,1\n1,2\n", {}),
        # units
        ("t_s,a [furlong]\n0,1\n1,2\n", {}, "give units=", None, {"units": "m"}),
        ("t [min],a\n0,1\n1,2\n", {}, "give time_unit=", None, {"time_unit": "s"}),
        ("t_s,a [mv]\n0,1\n1,2\n", {}, "'mV' is meant", "t_s,a [mV]\n0,1\n1,2\n", {}),
        # instruments
        (
            LVM,
            {},
            "no numbers X0 and Delta_X; save it with a column of times",
            LVM_WITH_TIMES,
            {},
        ),
        (
            LVM.replace("\tNo", "\tMulti"),
            {},
            "save it with one column for all",
            LVM_WITH_TIMES,
            {},
        ),
        (
            RIGOL,
            {},
            "below Start and Increment; write them there",
            RIGOL.replace("none,none", "0,1e-6"),
            {},
        ),
        (
            RIGOL,
            {},
            "or remove both lines and give rate",
            "".join(RIGOL.splitlines(keepends=True)[2:]),
            {"rate": 1e6},
        ),
    ],
)
def test_the_remedy_makes_the_file_readable(
    tmp_path, text, options, says, remedy, remedy_options
):
    """A file is refused, and read after its remedy: with `remedy` as its text, or
    unchanged if this is None, and with `remedy_options`.
    """
    path = tmp_path / "shot.txt"
    path.write_text(text)
    with pytest.raises(FileFormatError, match=says):
        ri.read_signals(path, **options)

    if remedy is not None:
        path.write_text(remedy)
    signals = ri.read_signals(path, **remedy_options)

    assert signals
    for signal in signals.values():
        assert len(signal) >= 2


@pytest.mark.parametrize("encoding", ["utf-32", "utf-16-le"])
def test_the_remedy_for_a_file_that_is_no_text_is_utf_8(tmp_path, encoding):
    """A file of a record in another encoding is refused with the advice of UTF-8;
    written in UTF-8 it is read.
    """
    path = tmp_path / "shot.txt"
    text = "time_s\ta\n0\t1\n1\t2\n"
    path.write_bytes(text.encode(encoding))
    with pytest.raises(FileFormatError, match="export it as text, in UTF-8"):
        ri.read_signals(path)
    path.write_text(text, encoding="utf-8")
    assert list(ri.read_signals(path)) == ["a"]
