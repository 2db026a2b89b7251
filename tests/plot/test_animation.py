"""Moving pictures: every frame shows the row and its past, and files are whole or not there."""

import base64
import io
import re
import stat
import sys

import numpy as np
import pytest
from case_texts import UNEQUAL_RODS
from drawing import rod
from exhaustive import few_of
from matplotlib.colors import to_rgb
from PIL import Image

import rodimpact as ri
from rodimpact import plot
from rodimpact.cli import main
from rodimpact.plot.style import LOOKS, ON_LIGHT

ROWS = {
    "unequal": (ri.System([rod(0.4, 1.0), rod()]), {}),
    "chain": (ri.System([rod(0.3, 1.0), *[rod(0.3)] * 4]), {}),
    "walls": (
        ri.System(
            [ri.Wall(1.0), rod(0.3), rod(0.2, area=3e-4), ri.Wall()],
            gaps=[1e-5, 2e-5, 2e-5],
        ),
        {"until": 3e-4},
    ),
    "single": (ri.System([rod(0.5, 1.0)]), {"until": 2e-4}),
    "masses": (
        ri.System(
            [ri.RigidMass(0.1, velocity=2.0), rod(0.4), ri.RigidMass(0.2), rod(0.2)],
            contacts=[ri.Hertz(1e10), ri.Bonded(), ri.Rigid()],
            ends=(ri.Free(), ri.Absorbing()),
        ),
        {"until": 3e-4},
    ),
    "driven": (
        ri.System([rod(0.4)], ends=(ri.Moved(1.0), ri.Fixed())),
        {"until": 2e-4, "method": "characteristics"},
    ),
}


@pytest.fixture(scope="module")
def solved():
    return {name: ri.solve(system, **how) for name, (system, how) in ROWS.items()}


@pytest.fixture(scope="module", autouse=True)
def small():
    with plot.look(width=110):
        yield


@pytest.fixture(scope="module")
def film(solved):
    return plot.animation(solved["unequal"], frames=7, fps=10)


def pixel(film, ax, x, y):
    """Row and column of a point of an Axes in a frame."""
    across, up = ax.transData.transform((x, y))
    return round(film.figure.bbox.height - up), round(across)


def row_of(film):
    """The Axes of the bodies, above the space-time diagram."""
    below, *others = film.figure.axes
    return next(ax for ax in others if below.get_shared_x_axes().joined(ax, below))


def colours(film, field):
    """From SI values to what the frame should show."""
    bar = next(ax for ax in film.figure.axes if ax.get_ylabel().startswith(field))
    norm = bar._colorbar.norm
    factor = {"m/s": 1.0, "MPa": 1e-6}[re.search(r"\((.*)\)", bar.get_ylabel())[1]]
    return lambda value: np.array(ON_LIGHT(norm(value * factor))[:3]) * 255


# Frames -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("field", ["velocity", "stress"])
def test_rods_are_where_they_are_in_the_colour_of_their_state(solved, field):
    solution = solved["unequal"]
    film = plot.animation(solution, field, frames=9, magnification=1.0)
    expected, row = colours(film, field), row_of(film)
    for number in (1, 3, 6):
        picture, t = film.frame(number).astype(float), film.times[number]
        for body, x in ((0, 0.07), (0, 0.29), (1, 0.11), (1, 0.53), (1, 0.87)):
            place = float(solution.position(body, x, t))
            shown = picture[pixel(film, row, place, 0.1)]
            value = float(getattr(solution, field)(body, x, t))
            assert shown == pytest.approx(expected(value), abs=3)


def test_displacements_are_magnified_and_the_factor_is_told(solved):
    solution = solved["unequal"]
    film = plot.animation(solution, frames=3, magnification=1000.0)
    assert (
        "displacements \N{MULTIPLICATION SIGN} 1000" in film.figure.axes[0].get_xlabel()
    )
    texts = [t.get_text() for ax in film.figure.axes for t in ax.texts]
    assert any("thick: compressed" in text for text in texts)
    row, picture = row_of(film), film.frame(2)
    gap = 1000 * float(solution.contacts[0].gap(film.times[2]))
    right = 0.4 + 1000 * float(solution.displacement(0, 0.4, film.times[2]))
    inside = picture[pixel(film, row, right + gap / 2, 0.0)]
    assert tuple(inside) == (255, 255, 255)
    assert tuple(picture[pixel(film, row, right - 0.02, 0.1)]) != (255, 255, 255)


def test_the_future_is_hidden_and_the_past_is_that_of_the_end(film):
    below = film.figure.axes[0]
    last = film.frame(6)
    box = below.get_window_extent()
    left, right = int(box.x0) + 3, int(box.x1) - 3
    for number in (1, 4):
        picture = film.frame(number)
        line, _ = pixel(film, below, 0.0, film.times[number] * 1e6)
        top = int(film.figure.bbox.height - box.y1) + 2
        assert np.all(picture[top : line - 3, left:right] == 255)
        bottom = int(film.figure.bbox.height - box.y0) - 3
        assert np.array_equal(
            picture[line + 4 : bottom, left:right], last[line + 4 : bottom, left:right]
        )
        assert np.ptp(picture[line + 4 : bottom, left:right]) > 200


def test_it_begins_with_the_approach_and_says_what_happens(solved):
    solution = solved["unequal"]
    film = plot.animation(solution, frames=41, fps=20, magnification=2000.0)
    before = film.times[film.times < 0]
    assert 2 <= len(before) <= 8
    assert np.diff(film.times) == pytest.approx(
        [film.times[-1] / (40 - len(before))] * 40
    )
    assert film.times[-1] == solution.t_end
    assert film.clock(0).startswith("t = \N{MINUS SIGN}")
    row = row_of(film)
    picture, t = film.frame(0).astype(float), before[0]
    right = 0.4 + 2000 * t
    expected = colours(film, "velocity")
    assert picture[pixel(film, row, right - 0.02, 0.1)] == pytest.approx(
        expected(1.0), abs=3
    )
    assert tuple(picture[pixel(film, row, (right + 0.4) / 2, 0.1)]) == (255, 255, 255)
    told = []
    for number in (
        0,
        len(before),
        int(np.searchsorted(film.times, 2e-4)),
        len(film) - 1,
    ):
        film.frame(number)
        told += [
            t.get_text()
            for ax in film.figure.axes
            for t in ax.texts
            if "contact" in t.get_text()
            or "force" in t.get_text()
            or "gap" in t.get_text()
        ]
    assert told == [
        "before contact",
        "0 s:\nforce begins",
        "158 µs:\nforce ends",
        "396 µs:\ngap opens",
    ]
    assert film.figure.get_suptitle().startswith(
        "2 rods, closing speed 1 m/s, restitution e = 0.4"
    )


@pytest.mark.parametrize("name", few_of(ROWS, {"masses"}))
def test_every_row_moves(solved, name):
    with plot.look("dark" if name in ("walls", "masses") else "light"):
        film = plot.animation(solved[name], "stress", frames=3)
    frames = list(film.frames())
    assert [frame.shape for frame in frames] == [frames[0].shape] * len(film)
    assert not np.array_equal(frames[0], frames[1])
    assert not np.array_equal(frames[-1], frames[-2])
    paper = np.round(np.array(to_rgb(film.colours.paper)) * 255)
    assert np.array_equal(frames[0][0, 0], paper)
    assert film.colours == LOOKS["dark" if name in ("walls", "masses") else "light"]
    forces = [
        ax for ax in film.figure.axes if ax.get_xlabel().startswith("contact force")
    ]
    assert len(forces) == (name not in ("single", "driven"))


@pytest.mark.parametrize("magnification", [1.0, 300.0, None])
@pytest.mark.parametrize("frames", [2, 3, 5, 20, 61])
def test_a_film_has_as_many_frames_as_asked_for(solved, frames, magnification):
    film = plot.animation(solved["unequal"], frames=frames, magnification=magnification)
    assert len(film) == film.times.size == frames
    assert np.sum(film.times < 0) <= frames / 5
    assert 0.0 in film.times


def test_a_run_with_too_many_regions_is_shown_in_part(solved, monkeypatch):
    monkeypatch.setattr("rodimpact.plot.polygons.READABLE_REGIONS", 8)
    solution = solved["unequal"]
    film = plot.animation(solution, frames=2)
    assert film.times[-1] < solution.t_end
    texts = [t.get_text() for ax in film.figure.axes for t in ax.texts]
    assert any(re.search(r"first \d+ µs of 555 µs", text) for text in texts)


# Files ------------------------------------------------------------------------------------------


def alike(a, b):
    """Whether two pictures hardly differ; a file has 255 colours."""
    return np.abs(a.astype(int) - b.astype(int)).mean() < 1.0


def test_a_gif_shows_every_frame_in_its_time_again_and_again(film, tmp_path):
    plot.save(film, tmp_path / "a.gif")
    plot.save(film, tmp_path / "b.GIF")
    assert (tmp_path / "a.gif").read_bytes() == (tmp_path / "b.GIF").read_bytes()
    with Image.open(tmp_path / "a.gif") as shown:
        assert shown.n_frames == 7
        assert shown.info["loop"] == 0
        for number in range(7):
            shown.seek(number)
            assert shown.info["duration"] == (1600 if number == 6 else 100)
            picture = np.asarray(shown.convert("RGB"))
            assert alike(picture, film.frame(number))
            assert tuple(picture[0, 0]) == (255, 255, 255)


def test_a_notebook_plays_it(film):
    data, words = re.fullmatch(
        r'<img src="data:image/gif;base64,(.*?)" alt="(.*?)".*>', film._repr_html_()
    ).groups()
    with Image.open(io.BytesIO(base64.b64decode(data))) as shown:
        assert shown.n_frames == 7
    assert words.startswith("2 rods, closing speed 1 m/s")


def test_an_interruption_leaves_no_file(film, tmp_path):
    def interrupt(done, total):
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        film.save(tmp_path / "film.gif", progress=interrupt)
    assert list(tmp_path.iterdir()) == []


def stand_in(folder, monkeypatch, program):
    """A program in Python that is found under the name of ffmpeg."""
    path = folder / "ffmpeg"
    path.write_text(f"#!{sys.executable}\nimport sys\n{program}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", str(folder))


def test_an_mp4_is_made_by_ffmpeg_from_the_frames(film, tmp_path, monkeypatch):
    stand_in(
        tmp_path,
        monkeypatch,
        """
data = sys.stdin.buffer.read()
open(sys.argv[-1], "wb").write(" ".join(sys.argv[1:]).encode() + b"|" + data)""",
    )
    film.save(tmp_path / "film.mp4")
    options, _, data = (tmp_path / "film.mp4").read_bytes().partition(b"|")
    height, width, _ = film.frame(0).shape
    assert f"-s {width}x{height} -r 10 ".encode() in options
    assert data == b"".join(frame.tobytes() for frame in film.frames())


def test_what_ffmpeg_complains_of_is_told(film, tmp_path, monkeypatch):
    stand_in(tmp_path, monkeypatch, 'sys.stderr.write("no such codec"); sys.exit(1)')
    with pytest.raises(OSError, match=r"film\.mp4.*ffmpeg failed: no such codec"):
        film.save(tmp_path / "film.mp4")
    assert [path.name for path in tmp_path.iterdir()] == ["ffmpeg"]


# Command line -----------------------------------------------------------------------------------


def test_the_command_makes_the_film(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", str(tmp_path))
    (tmp_path / "case.toml").write_text(UNEQUAL_RODS)
    assert (
        main(
            [
                "animate",
                "case.toml",
                "-o",
                "film.gif",
                "--frames",
                "4",
                "--fps",
                "20",
                "--field",
                "stress",
                "--dark",
                "--until",
                "0.2 ms",
            ]
        )
        == 0
    )
    out, err = capsys.readouterr()
    assert out == "4 frames from 0 s to 200 us, 0.2 s to watch: film.gif\n"
    assert err == ""
    with Image.open("film.gif") as shown:
        assert shown.n_frames == 4
        assert shown.info["duration"] == 50
        dark = np.round(np.array(to_rgb(LOOKS["dark"].paper)) * 255)
        assert np.array_equal(np.asarray(shown.convert("RGB"))[0, 0], dark)
    assert main(["animate", "case.toml", "-o", "film.mp4"]) == 1
    assert (
        "ffmpeg, which makes MP4 files, is not on the path; install it, or write a .gif"
        in (capsys.readouterr().err)
    )
