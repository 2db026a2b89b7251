"""Bars of long calls: where they appear, whose they are, and what they leave behind."""

import io
import os
import re
import subprocess
import sys
import threading
import warnings

import numpy as np
import pytest
from systems import rod

import rodimpact as ri
from rodimpact import progress
from rodimpact.methods import kernels
from rodimpact.progress import Progress

PAIR = ri.System([rod(0.4, 1.0), rod(1.0, area=2e-4)])


class Terminal(io.StringIO):
    """A terminal: what has been written to it, and what it shows."""

    def isatty(self):
        """It is a terminal, so that bars appear on it."""
        return True

    def lines(self):
        """Lines on the screen, without blanks at their ends.

        What follows a carriage return covers what was there, and ESC [A moves up a
        line.
        """
        lines = [[]]  # of characters
        row = 0
        column = 0
        for mark in re.findall(r"\x1b\[A|.|\n|\r", self.getvalue()):
            if mark == "\x1b[A":
                row -= 1
            elif mark == "\r":
                column = 0
            elif mark == "\n":
                row += 1
                column = 0
                if row == len(lines):
                    lines.append([])
            else:
                line = lines[row]
                while len(line) <= column:
                    line.append(" ")
                line[column] = mark
                column += 1
        return ["".join(line).rstrip() for line in lines]


def terminal_with_bars_at_once(monkeypatch):
    """A terminal that replaces standard error, and on which progress bars appear and
    are redrawn at once. It is no fixture: pytest sets its own standard error just
    before it calls a test.
    """
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr(progress, "APPEARS_AFTER", 0.0)
    monkeypatch.setattr(progress, "REDRAWN_AFTER", 0.0)
    return terminal


def test_a_bar_tells_the_call_how_much_and_how_fast_and_leaves_an_empty_line(
    monkeypatch,
):
    """After 10 of 50 collisions, the bar has the name of the call, 20 %, 10/50 and a
    rate; afterwards the line is empty.
    """
    terminal = terminal_with_bars_at_once(monkeypatch)
    with Progress(progress=True, name="sweep", unit="collisions") as report:
        report(0, 50)
        report(10, 50)
        (line,) = terminal.lines()
        assert line.startswith("sweep:  20%|")
        assert "10/50" in line
        assert "collisions/s" in line
    assert terminal.lines() == [""]


def test_a_call_of_less_than_two_seconds_shows_nothing(monkeypatch):
    """50 reports within 2 s write nothing to the terminal."""
    terminal = terminal_with_bars_at_once(monkeypatch)
    monkeypatch.setattr(progress, "APPEARS_AFTER", 2.0)
    with Progress(progress=True, name="sweep", unit="collisions") as report:
        for i in range(50):
            report(i, 50)
    assert terminal.getvalue() == ""


def test_two_seconds_count_from_the_start_of_the_call(monkeypatch):
    """The delay of the bar is 2 s: it does not appear 1 s after the start of the call,
    and does 2.1 s after it.
    """
    terminal = terminal_with_bars_at_once(monkeypatch)
    monkeypatch.setattr(progress, "APPEARS_AFTER", 2.0)
    with Progress(progress=True, name="sweep", unit="collisions") as report:
        progress._outermost._began -= 1.0  # as if a second had passed
        report(1, 50)
        assert terminal.getvalue() == ""
        progress._outermost._began -= 1.1
        report(2, 50)
        assert "2/50 [00:02<" in terminal.getvalue()


def test_members_from_a_checkpoint_do_not_count_for_the_time_that_remains(monkeypatch):
    """After 900 that were read, 10 members took 10 s: 90 take 90 s."""
    terminal = terminal_with_bars_at_once(monkeypatch)
    monkeypatch.setattr(progress, "APPEARS_AFTER", 2.0)
    with Progress(progress=True, name="sweep", unit="collisions") as report:
        report(900, 1000)
        progress._outermost._began -= 10.0  # as if 10 s had passed
        report(910, 1000)
        (line,) = terminal.lines()
    remaining = re.search(r"910/1000 \[00:10<(\d\d):(\d\d)", line)
    minutes, seconds = map(int, remaining.groups())
    # A rate that counted the 900 would leave a second; the test itself takes time.
    assert 85 <= 60 * minutes + seconds <= 91


def test_where_nobody_knows_the_total_the_bar_counts(monkeypatch):
    """With None as total, the bar counts the steps, also in thousands."""
    terminal = terminal_with_bars_at_once(monkeypatch)
    with Progress(progress=True, name="formula", unit="steps") as report:
        report(1, total=None)
        assert terminal.lines()[0].startswith("formula: 1 steps [00:00, ")
        report(123_456, total=None)
        assert terminal.lines()[0].startswith("formula: 123k steps [00:00, ")


def test_a_total_that_was_too_low_is_raised_to_what_is_done(monkeypatch):
    """A report of 120 of 100 shows 120/120."""
    terminal = terminal_with_bars_at_once(monkeypatch)
    with Progress(progress=True, name="solve", unit="events") as report:
        report(90, 100)
        report(120, 100)
        assert "120/120" in terminal.lines()[0]


def test_a_finer_mesh_begins_anew(monkeypatch):
    """A report of 10 of 200 after 100 of 100 shows 5 %, without a negative rate."""
    terminal = terminal_with_bars_at_once(monkeypatch)
    with Progress(progress=True, name="solve", unit="steps") as report:
        report(100, 100)
        report(10, 200)
        (line,) = terminal.lines()
        assert line.startswith("solve:   5%|")
        assert "-" not in line  # no negative rate


def test_nothing_appears_where_standard_error_is_no_terminal(monkeypatch):
    """No bar is shown if standard error is a stream in memory, or None."""
    silent = io.StringIO()
    monkeypatch.setattr(progress, "APPEARS_AFTER", 0.0)
    for stderr in (silent, None):
        monkeypatch.setattr(sys, "stderr", stderr)
        with Progress(progress=True, name="sweep", unit="collisions") as report:
            report(1, 50)
    assert silent.getvalue() == ""


def test_nothing_appears_in_worker_processes(monkeypatch):
    """No bar is shown in a process that has a parent process."""
    terminal = terminal_with_bars_at_once(monkeypatch)
    monkeypatch.setattr("multiprocessing.process.parent_process", lambda: object())
    with Progress(progress=True, name="sweep", unit="collisions") as report:
        report(1, 50)
    assert terminal.getvalue() == ""


def test_nothing_appears_in_worker_threads_where_functions_are_called(monkeypatch):
    """In another thread, progress=True shows no bar, and a function given as progress
    is called.
    """
    terminal = terminal_with_bars_at_once(monkeypatch)
    heard = []

    def work(wanted):
        with Progress(wanted, "sweep", "collisions") as report:
            report(1, 50)

    for wanted in (True, lambda *news: heard.append(news)):
        thread = threading.Thread(target=work, args=(wanted,))
        thread.start()
        thread.join()
    assert terminal.getvalue() == ""
    assert heard == [(1, 50)]


def test_only_the_outermost_call_has_a_bar(monkeypatch):
    """A sweep inside a fit: only the bar of the fit appears, and its line is empty
    afterwards.
    """
    terminal = terminal_with_bars_at_once(monkeypatch)
    with Progress(progress=True, name="fit", unit="collisions") as outer:
        outer(1, 10)
        with Progress(progress=True, name="sweep", unit="collisions") as inner:
            inner(5, 7)
        outer(2, 10)
    assert "fit:  20%" in terminal.getvalue()
    assert "sweep" not in terminal.getvalue()
    assert terminal.lines() == [""]


def test_a_call_inside_one_of_its_own_name_reports_to_the_bar_of_that(monkeypatch):
    """A fit runs fits inside."""
    terminal = terminal_with_bars_at_once(monkeypatch)
    with Progress(progress=True, name="fit", unit="collisions") as outer:
        outer(1, 10)
        with Progress(progress=True, name="fit", unit="collisions") as inner:
            inner(3, 10)
        assert "fit:  30%" in terminal.lines()[0]


def test_a_call_after_another_has_a_bar_of_its_own(monkeypatch):
    terminal = terminal_with_bars_at_once(monkeypatch)
    with Progress(progress=True, name="fit", unit="collisions") as first:
        first(1, 10)
    with Progress(progress=True, name="sweep", unit="collisions") as second:
        second(5, 7)
        assert "sweep:  71%" in terminal.lines()[0]  # 5/7


@pytest.mark.parametrize("wanted", [False, lambda done, total: None])
def test_calls_inside_a_silent_call_are_silent(monkeypatch, wanted):
    """No bar is shown for a call inside one whose progress is off or goes to a
    function.
    """
    terminal = terminal_with_bars_at_once(monkeypatch)
    with Progress(wanted, "fit", "collisions") as outer:
        outer(1, 10)
        with Progress(progress=True, name="sweep", unit="collisions") as inner:
            inner(5, 7)
    assert terminal.getvalue() == ""


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
def test_an_error_takes_the_bar_away(monkeypatch, error):
    """An error is raised while a bar is shown: the line of the terminal is empty
    afterwards, warnings are shown as before, and no bar counts as shown.
    """
    terminal = terminal_with_bars_at_once(monkeypatch)
    before = warnings.showwarning

    def work():
        with Progress(progress=True, name="sweep", unit="collisions") as report:
            report(1, 50)
            raise error

    with pytest.raises(error):
        work()
    assert terminal.lines() == [""]
    assert warnings.showwarning is before
    assert progress._outermost is None


def test_warnings_and_messages_stand_above_the_bar(monkeypatch):
    """A warning and a message are written while a bar is shown: each has a line of its
    own above it, and the bar is drawn once.
    """
    terminal = terminal_with_bars_at_once(monkeypatch)

    def show(message, *_):
        sys.stderr.write(f"{message}\n")

    monkeypatch.setattr(warnings, "showwarning", show)
    with (
        warnings.catch_warnings(),
        Progress(progress=True, name="sweep", unit="collisions") as report,
    ):
        warnings.simplefilter("always")
        report(10, 50)
        warnings.warn("the first word", UserWarning, stacklevel=1)
        progress.write_message("the second word")
        *above, first, second, bar = terminal.lines()
        assert first == "the first word"
        assert second == "the second word"
        assert bar.startswith("sweep:  20%|")
        assert "sweep" not in " ".join(above)  # no piece of an older bar is left


def test_warnings_that_are_recorded_stay_recorded(monkeypatch):
    """A warning while a bar is shown, inside `pytest.warns`, is recorded there and not
    written to the terminal.
    """
    terminal = terminal_with_bars_at_once(monkeypatch)

    def work():
        with Progress(progress=True, name="sweep", unit="collisions") as report:
            report(10, 50)
            warnings.warn("the word", UserWarning, stacklevel=1)

    with pytest.warns(UserWarning, match="the word"):
        work()
    assert "the word" not in terminal.getvalue()


def test_compiling_is_told_above_the_bar(monkeypatch):
    """The message on compiling, while a bar is shown, has a line of its own above it."""
    terminal = terminal_with_bars_at_once(monkeypatch)
    kernels._tell.cache_clear()
    with Progress(progress=True, name="sweep", unit="collisions") as report:
        report(10, 50)
        kernels._tell("")
        first, bar = terminal.lines()
    assert first.startswith("compiling once")
    assert bar.startswith("sweep:")


def test_a_bar_of_the_user_stays_above_ours(monkeypatch):
    """A bar of tqdm around a sweep ends at 100 % in the first line; our line is empty."""
    terminal = terminal_with_bars_at_once(monkeypatch)
    from tqdm import tqdm

    for _ in tqdm(range(2), desc="mine", file=sys.stderr):
        with Progress(progress=True, name="sweep", unit="collisions") as report:
            report(1, 50)
    assert terminal.lines()[0].startswith("mine: 100%|")
    assert terminal.lines()[1:] == [""]


def test_a_sweep_shows_a_bar_and_a_solve_inside_does_not(monkeypatch):
    """A sweep shows its own bar only; `solve` called alone shows one."""
    terminal = terminal_with_bars_at_once(monkeypatch)
    lengths = np.array([0.4, 0.5])
    family = ri.System([rod(lengths, 1.0), rod(1.0)])

    ri.sweep(family, workers=1)

    assert "sweep:" in terminal.getvalue()
    assert "solve:" not in terminal.getvalue()
    assert terminal.lines() == [""]
    ri.solve(PAIR, until=0.05)  # alone it has a bar
    assert "solve:" in terminal.getvalue()


IMPORTS = """
import sys, time
import rodimpact as ri
from rodimpact import progress
sys.stderr.isatty = lambda: True
rods = [ri.Rod(x, area=1e-4, material=ri.materials.steel, velocity=v)
        for x, v in ((0.4, 1.0), (1.0, 0.0))]
ri.solve(ri.System(rods))
assert "tqdm" not in sys.modules
progress.APPEARS_AFTER = 0.0
ri.solve(ri.System(rods), until=0.05)
assert "tqdm" in sys.modules
import threading
assert threading.active_count() == 1, threading.enumerate()
"""


@pytest.mark.exhaustive
def test_tqdm_is_imported_when_a_bar_appears_and_leaves_no_thread():
    subprocess.run([sys.executable, "-W", "error", "-c", IMPORTS], check=True)


SILENCED = """
import sys
from rodimpact import progress
sys.stderr.isatty = lambda: True
progress.APPEARS_AFTER = 0.0
with progress.Progress(progress=True, name="sweep", unit="collisions") as report:
    report(1, 50)
    report(2, 50)
"""


def test_the_environment_turns_all_bars_off():
    done = subprocess.run(
        [sys.executable, "-c", SILENCED],
        check=True,
        capture_output=True,
        env={**os.environ, "TQDM_DISABLE": "1"},
    )
    assert done.stderr == b""


NOTEBOOK = """
import sys, types, warnings
shell = types.SimpleNamespace(config={{"IPKernelApp": 1}})
shown = []
if {has_widgets}:
    with warnings.catch_warnings(action="ignore"):
        import IPython.display, ipywidgets
    IPython.get_ipython = lambda: shell
    IPython.display.display = shown.append
else:
    sys.modules["IPython"] = types.SimpleNamespace(get_ipython=lambda: shell)
    sys.modules["IPython.display"] = types.SimpleNamespace(display=shown.append)
    sys.modules["ipywidgets"] = None
sys.modules["ipykernel.zmqshell"] = types.ModuleType("zmqshell")
from rodimpact import progress
progress.APPEARS_AFTER = 0.0
progress.REDRAWN_AFTER = 0.0
assert progress.is_watched()
with progress.Progress(progress=True, name="sweep", unit="collisions") as report:
    report(1, 50)
    report(2, 60)
    bar = progress._outermost._bar
    if {has_widgets}:
        assert shown == [bar.container]
        assert bar.container.children[1].max == 60
print(hasattr(bar, "container"))
"""


@pytest.mark.exhaustive
@pytest.mark.parametrize("has_widgets", [True, False])
def test_a_notebook_has_a_widget_or_without_ipywidgets_a_line(has_widgets):
    """In a simulated notebook, a process shows a widget exactly if ipywidgets is there,
    and no warning of tqdm.
    """
    if has_widgets:
        pytest.importorskip("ipywidgets")
    code = NOTEBOOK.format(has_widgets=has_widgets)
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        check=True,
        capture_output=True,
        text=True,
    )
    assert done.stdout == f"{has_widgets}\n"
    assert "Tqdm" not in done.stderr
