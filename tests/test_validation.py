"""Every case of validation/ within its bounds, and the pages that its tables make."""

import re
from fractions import Fraction

import pytest
from exhaustive import few_of
from validation_cases import FOLDER, validation_module

table = validation_module("table")
program = validation_module("__main__")
CASES = table.cases()
LONG = (
    "agreement",
    "damping",
    "design",
    "formulas",
    "gradients",
    "grid_against_fronts",
    "grid_on_known_ground",
    "hertz_ends",
    "horns",
    "joints",
    "lateral_inertia",
    "length_effects",
    "measured_pulses",
    "mindlin_herrmann",
    "problems",
    "rational_proof",
    "rods_as_rigid_bodies",
    "saint_venant",
    "specimen",
)
VERDICT = re.compile(
    r"^\| \[.+\]\(\S+/(?P<case>\w+)\.md\) \|.*\| (?P<numbers>\d+) \|.*\| pass \|$",
    re.MULTILINE,
)
"""A line of the table of verdicts: a case that passes, with how many numbers."""
QUICK = [case for case in CASES if case not in LONG]


def lines_of_page(path):
    """Lines of the table of a page, cut into cells, with the names of its columns."""
    lines = []
    for line in path.read_text("utf-8").splitlines():
        if line.startswith("| "):
            cells = line.strip("|").split("|")
            lines.append(tuple(cell.strip() for cell in cells))
    return lines


@pytest.fixture(scope="module")
def written():
    """Lines of the written tables, cut into cells, by the name of the case."""
    tables = {}
    for path in sorted(table.PAGES.glob("*.md")):
        columns, separator, *lines = lines_of_page(path)
        assert columns == table.COLUMNS
        assert separator == ("---",) * len(table.COLUMNS)
        tables[path.stem] = lines
    return tables


def test_every_case_is_found_and_written(written):
    assert {"box_10_4", "saint_venant", "rational_proof", "rows"} <= set(CASES)
    assert list(written) == CASES


def test_the_verdicts_list_every_case_with_the_number_of_its_numbers(written):
    """The README of the validation lists each case, in order, with its number of rows,
    in at most 1000 words.
    """
    text = (FOLDER / "README.md").read_text(encoding="utf-8")

    numbers = {}
    for verdict in VERDICT.finditer(text):
        numbers[verdict["case"]] = int(verdict["numbers"])

    assert numbers == {case: len(lines) for case, lines in written.items()}
    assert list(numbers) == list(written)
    assert len(text.split()) <= 1000


def test_the_verdicts_tell_what_fails_and_a_page_has_its_title():
    row = table.Row("case", "quantity", "source", 1.0, 1.2, 1e-1)
    assert "| 200% | fail |" in table.verdicts({"rows": [row]})
    assert table.page("rows", [row]).startswith(f"# {table.title('rows')}\n")


def assert_written(row, line):
    """A computed row equals the written one, as far as its bound and the rounding of
    the page allow.
    """
    case, quantity, source, expected, got, bound = line
    assert (case, quantity, source) == (row.case, row.quantity, row.source)
    assert float(bound) == pytest.approx(row.bound, rel=0.05)  # two digits are shown
    rounding = 0
    if row.decimal_places is not None:
        rounding = Fraction(10) ** -row.decimal_places / 2
    # What was got when the page was written, and now, lies within the bound of what is
    # expected: both differ by twice the bound at most.
    exact_bound = Fraction(row.bound)
    expected_difference = abs(Fraction(expected) - Fraction(row.expected))
    assert expected_difference <= exact_bound + rounding
    difference = abs(Fraction(got) - Fraction(row.got))
    assert difference <= 2 * exact_bound + rounding


@pytest.mark.parametrize("case", few_of(CASES, QUICK))
def test_every_number_of_a_case_is_within_its_bound_and_as_written(case, written):
    rows = table.run(case)

    assert rows
    for row, line in zip(rows, written[case], strict=True):
        assert row.holds, row
        assert_written(row, line)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty folder to which the program writes, with two cases of one number each.

    The number of "good" is within its bound, that of "bad" is not.
    """
    numbers = {"bad": 2.0, "good": 1.0}

    def run(case):
        return [table.Row(case, "quantity", "source", 1.0, numbers[case], 0.1)]

    monkeypatch.setattr(program, "cases", lambda: list(numbers))
    monkeypatch.setattr(program, "run", run)
    monkeypatch.setattr(program, "FOLDER", tmp_path)
    monkeypatch.setattr(program, "PAGES", tmp_path)
    monkeypatch.setattr(program, "verdicts", lambda rows_by_case: "verdicts")
    monkeypatch.setattr(program, "page", lambda case, rows: f"page of {case}")
    return tmp_path


def test_some_cases_are_run_alone_with_a_line_each_and_write_no_page(folder, capsys):
    program.main(["good"])

    printed = capsys.readouterr()
    assert printed.out.startswith("1 numbers within their bounds; pages are written")
    assert re.fullmatch(r"good: 1 numbers, pass, \d+\.\d s\n", printed.err)
    assert list(folder.iterdir()) == []


@pytest.mark.parametrize("arguments", [[], ["bad"]])
def test_a_broken_bound_is_told_and_no_page_is_written(folder, capsys, arguments):
    with pytest.raises(SystemExit, match=r"1 of \d numbers break their bounds"):
        program.main(arguments)

    error = capsys.readouterr().err
    assert "bad: quantity: expected 1.0, got 2.0, 1 apart, more than 0.1\n" in error
    assert "bad: 1 numbers, fail, " in error
    assert list(folder.iterdir()) == []


def test_all_cases_write_the_pages(folder, monkeypatch):
    monkeypatch.setattr(program, "cases", lambda: ["good"])

    program.main([])

    texts = {path.name: path.read_text("utf-8") for path in folder.iterdir()}
    assert texts == {"README.md": "verdicts", "good.md": "page of good"}


@pytest.mark.parametrize(
    ("argument", "status", "words"),
    [
        ("--help", 0, "cases: bad, good"),
        ("goood", 2, "there is no case 'goood'; perhaps 'good' is meant"),
    ],
)
def test_help_and_an_unknown_case_run_nothing(folder, capsys, argument, status, words):
    """With --help or an unknown name, the program prints, stops with a status, runs no
    case and writes no page.
    """
    with pytest.raises(SystemExit) as stop:
        program.main([argument])

    assert stop.value.code == status
    printed = capsys.readouterr()
    assert words in printed.out + printed.err
    assert "pass" not in printed.err
    assert list(folder.iterdir()) == []


def test_a_row_holds_within_its_bound_only():
    """A `Row` holds if its number differs by less than its bound, but not with a larger
    difference or NaN.
    """
    good = table.Row("case", "quantity", "source", 1.0, 1.0 + 1e-13, 1e-12)
    assert good.holds
    assert not good._replace(got=1.1).holds
    assert not good._replace(got=float("nan")).holds


def test_a_row_has_the_source_of_its_case_a_detail_of_it_or_its_own():
    case = table.Case("case", "book")
    assert case.row("quantity", 1.0, 1.0, 0.1).source == "book"
    assert case.row("quantity", 1.0, 1.0, 0.1, detail="2 L/c").source == "book: 2 L/c"
    assert case.row("quantity", 1.0, 1.0, 0.1, source="by hand").source == "by hand"


@pytest.mark.parametrize(
    ("expected", "got", "bound", "shown"),
    [
        (
            1 / 3,
            1 / 3 + 1e-16,
            1e-13,
            ("0.3333333333333", "0.3333333333333", "1.0e-13"),
        ),
        (0.0, -8e-16, 2e-15, ("0", "0", "2.0e-15")),
        (19000.0, 19000.0 + 4e-12, 1.9e-11, ("19000", "19000", "1.9e-11")),
        (2.0, 1.99929280504747, 2e-2, ("2", "1.9993", "2.0e-02")),
        (5000.0, 5047.54465125069, 100.0, ("5000", "5048", "1.0e+02")),
        (Fraction(1, 3), Fraction(1, 3), 0.0, ("1/3", "1/3", "0.0e+00")),
        (3.0, 3.0, 0.0, ("3", "3", "0.0e+00")),
    ],
)
def test_no_digit_is_shown_that_round_off_decides(expected, got, bound, shown):
    row = table.Row("case", "quantity", "source", expected, got, bound)
    assert row.cells()[3:] == shown
