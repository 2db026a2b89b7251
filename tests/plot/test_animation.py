"""Moving pictures: frames show the row and its past; files are complete or absent."""

import base64
import io
import itertools
import re
import stat
import sys

import numpy as np
import pytest
from case_texts import UNEQUAL_RODS
from drawing import rod, texts_of
from exhaustive import few_of
from matplotlib.colors import to_rgb
from PIL import Image

import rodimpact as ri
from rodimpact import plot
from rodimpact.cli import main
from rodimpact.plot.style import LOOKS, ON_LIGHT

WHITE = (255, 255, 255)


def between_walls():
    """Two rods between a moving wall and one at rest; not solved."""
    bodies = [ri.Wall(1.0), rod(0.3), rod(0.2, area=3e-4), ri.Wall()]
    return ri.System(bodies, gaps=[1e-5, 2e-5, 2e-5])


def with_masses():
    """Two masses and two rods, the last of which has an absorbing end; not solved."""
    striker = ri.RigidMass(0.1, velocity=2.0)
    bodies = [striker, rod(0.4), ri.RigidMass(0.2), rod(0.2)]
    contacts = [ri.Hertz(1e10), ri.Bonded(), ri.Rigid()]
    ends = (ri.Free(), ri.Absorbing())
    return ri.System(bodies, contacts=contacts, ends=ends)


SYSTEMS = {
    "unequal": ri.System([rod(0.4, 1.0), rod()]),
    "chain": ri.System([rod(0.3, 1.0), rod(0.3), rod(0.3), rod(0.3), rod(0.3)]),
    "walls": between_walls(),
    "single": ri.System([rod(0.5, 1.0)]),
    "masses": with_masses(),
    "driven": ri.System([rod(0.4)], ends=(ri.Moved(1.0), ri.Fixed())),
}
OPTIONS = {
    "walls": {"until": 3e-4},
    "single": {"until": 2e-4},
    "masses": {"until": 3e-4},
    "driven": {"until": 2e-4, "method": "characteristics"},
}


@pytest.fixture(scope="module")
def solved():
    """{name: solution} of `SYSTEMS`."""
    solutions = {}
    for name, system in SYSTEMS.items():
        options = OPTIONS.get(name, {})
        solutions[name] = ri.solve(system, **options)
    return solutions


@pytest.fixture(scope="module", autouse=True)
def small():
    """Small figures, which are drawn in less time."""
    with plot.look(width=110):
        yield


@pytest.fixture(scope="module")
def film(solved):
    """An animation of seven frames."""
    return plot.animation(solved["unequal"], frames=7, fps=10)


def pixel(film, ax, x, y):
    """Row and column of the pixel of a frame at the point (x, y) of an Axes."""
    across, up = ax.transData.transform((x, y))
    down = film.figure.bbox.height - up  # rows are counted from the top
    return round(down), round(across)


def colour_at(frame, film, ax, x, y):
    """Colour of a frame at the point (x, y) of an Axes, [red, green, blue] to 255."""
    return frame[pixel(film, ax, x, y)]


def diagram_of(film):
    """The Axes of the space-time diagram."""
    return film.figure.axes[0]


def row_of(film):
    """The Axes of a film in which the bodies move, above the space-time diagram."""
    diagram = diagram_of(film)
    shared = diagram.get_shared_x_axes()
    for ax in film.figure.axes[1:]:
        if shared.joined(ax, diagram):
            return ax
    raise AssertionError("no Axes shares its x axis with the diagram")


def colour_bar_of(film, field):
    """The Axes of the colour bar of a field."""
    for ax in film.figure.axes:
        if ax.get_ylabel().startswith(field):
            return ax
    raise AssertionError(f"no Axes is labelled {field}")


def colour_of(film, field, value):
    """Colour that a frame should show for a value in SI units, [red, green, blue] to
    255.
    """
    colour_bar = colour_bar_of(film, field)
    label = colour_bar.get_ylabel()
    (unit,) = re.findall(r"\((.*)\)", label)
    factor = {"m/s": 1.0, "MPa": 1e-6}[unit]
    norm = colour_bar._colorbar.norm
    red, green, blue, _ = ON_LIGHT(norm(value * factor))
    return np.array([red, green, blue]) * 255


def texts_on(film):
    """All texts inside the Axes of a film, as strings."""
    texts = []
    for ax in film.figure.axes:
        texts += texts_of(ax.texts)
    return texts


# Frames


POINTS = [(0, 0.07), (0, 0.29), (1, 0.11), (1, 0.53), (1, 0.87)]  # body, x in m


@pytest.mark.parametrize("field", few_of(["velocity", "stress"], ["stress"]))
def test_rods_have_their_places_and_the_colour_of_their_state(solved, field):
    """In three frames of a film, the pixel at the position of each of `POINTS` has the
    colour of the velocity or stress of the solution there.
    """
    solution = solved["unequal"]
    field_at = getattr(solution, field)
    film = plot.animation(solution, field, frames=9, magnification=1.0)
    row = row_of(film)

    for number in (1, 3, 6):
        frame = film.frame(number).astype(float)
        t = film.times[number]
        for body, x in POINTS:
            x_drawn = float(solution.position(body, x, t))
            colour = colour_at(frame, film, row, x_drawn, 0.1)
            value = float(field_at(body, x, t))
            expected = colour_of(film, field, value)
            assert colour == pytest.approx(expected, abs=3)


@pytest.fixture(scope="module")
def magnified_film(solved):
    """A film of three frames whose displacements are drawn a thousandfold."""
    return plot.animation(solved["unequal"], frames=3, magnification=1000.0)


@pytest.mark.exhaustive
def test_the_factor_of_displacements_is_named(magnified_film):
    label = diagram_of(magnified_film).get_xlabel()
    texts = "\n".join(texts_on(magnified_film))

    assert "displacements \N{MULTIPLICATION SIGN} 1000" in label
    assert "thick: compressed" in texts


def test_displacements_are_magnified(solved, magnified_film):
    """In the last frame of a film, magnified 1000 times, the middle of the drawn gap is
    white, and the rod beside it has a colour.
    """
    solution = solved["unequal"]
    t = magnified_film.times[2]
    gap = float(solution.contacts[0].gap(t))
    displacement = float(solution.displacement(0, 0.4, t))
    drawn_gap = 1000 * gap
    right_end = 0.4 + 1000 * displacement  # as drawn

    frame = magnified_film.frame(2)

    row = row_of(magnified_film)
    middle_of_gap = right_end + drawn_gap / 2
    in_gap = colour_at(frame, magnified_film, row, middle_of_gap, 0.0)
    in_rod = colour_at(frame, magnified_film, row, right_end - 0.02, 0.1)
    assert tuple(in_gap) == WHITE
    assert tuple(in_rod) != WHITE


@pytest.mark.exhaustive
@pytest.mark.parametrize("number", [1, 4])
def test_the_future_is_hidden_and_the_past_is_that_of_the_end(film, number):
    """The space-time diagram of a frame is white above the present time; below it all
    pixels are those of the last frame.
    """
    diagram = diagram_of(film)
    box = diagram.get_window_extent()
    height = film.figure.bbox.height
    # A few pixels at the frame of the diagram are left out on every side.
    columns = slice(int(box.x0) + 3, int(box.x1) - 3)
    top = int(height - box.y1) + 2
    bottom = int(height - box.y0) - 3
    time = film.times[number] * 1e6  # us
    now, _ = pixel(film, diagram, 0.0, time)

    frame = film.frame(number)
    last = film.frame(6)

    # Rows of a frame count from the top, and time runs upwards.
    rows_of_future = slice(top, now - 3)
    rows_of_past = slice(now + 4, bottom)
    future = frame[rows_of_future, columns]
    assert np.all(future == 255)  # white
    past = frame[rows_of_past, columns]
    past_in_last_frame = last[rows_of_past, columns]
    assert np.array_equal(past, past_in_last_frame)
    assert np.ptp(past) > 200  # it is not blank


@pytest.fixture(scope="module")
def film_with_approach(solved):
    """A film of 41 frames whose displacements are drawn so large, 2000 times, that rods
    are seen to approach.
    """
    return plot.animation(solved["unequal"], frames=41, fps=20, magnification=2000.0)


@pytest.mark.exhaustive
def test_a_film_begins_with_the_approach_in_frames_at_equal_steps(
    solved, film_with_approach
):
    """Two to eight frames are before contact, and all 41 are at equal steps of time."""
    times = film_with_approach.times

    n_before_contact = np.count_nonzero(times < 0)
    assert 2 <= n_before_contact <= 8
    end = times[-1]
    assert end == solved["unequal"].t_end
    interval = end / (40 - n_before_contact)
    assert np.diff(times) == pytest.approx([interval] * 40)
    clock_of_first_frame = film_with_approach.clock(0)
    assert clock_of_first_frame.startswith("t = \N{MINUS SIGN}")


def test_rods_are_apart_in_the_approach(film_with_approach):
    """In the first frame, before contact, the colour of the velocity is inside the
    moving rod, and white in the gap between the rods.
    """
    frame = film_with_approach.frame(0).astype(float)

    row = row_of(film_with_approach)
    contact = 0.4
    right_end = contact + 2000 * film_with_approach.times[0]  # it moves at 1 m/s
    middle_of_gap = (right_end + contact) / 2
    in_rod = colour_at(frame, film_with_approach, row, right_end - 0.02, 0.1)
    in_gap = colour_at(frame, film_with_approach, row, middle_of_gap, 0.1)
    expected = colour_of(film_with_approach, "velocity", 1.0)
    assert in_rod == pytest.approx(expected, abs=3)
    assert tuple(in_gap) == WHITE


@pytest.mark.exhaustive
def test_a_rod_that_comes_from_the_right_is_inside_before_it_touches():
    """A striker comes from the right, magnified 2000 times: the limits of the film hold
    its first position.
    """
    target = ri.Rod(0.4, area=1e-4, material=ri.materials.steel)
    striker = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=-1.0)
    solution = ri.solve(ri.System([target, striker]))

    film = plot.animation(solution, frames=60, magnification=2000.0)

    way = -2000 * film.times[0]  # drawn, of the striker until it touches at t = 0
    assert way > 0.05
    left, right = diagram_of(film).get_xlim()
    assert left < 0.0
    assert right > 0.8 + way


@pytest.mark.parametrize(
    ("time", "event"),
    [
        (-1.0, "before contact"),
        (0.0, "0 s:\nforce begins"),
        (2e-4, "158 µs:\nforce ends"),
        (5.5e-4, "396 µs:\ngap opens"),
    ],
)
def test_frames_name_the_last_event(film_with_approach, time, event):
    """The first frame at or after `time`, s, shows one text of an event, `event`."""
    number = int(np.searchsorted(film_with_approach.times, time))

    film_with_approach.frame(number)

    events = [text for text in texts_on(film_with_approach) if is_event(text)]
    assert events == [event]


def is_event(text):
    """Whether a text of a film names an event of the contact."""
    return "contact" in text or "force" in text or "gap" in text


def test_a_film_names_the_result(film_with_approach):
    title = film_with_approach.figure.get_suptitle()

    assert title.startswith("2 rods, closing speed 1 m/s, restitution e = 0.4")


def forces_of(film):
    """The axes of a film that show contact forces, as a list."""
    axes = []
    for ax in film.figure.axes:
        if ax.get_xlabel().startswith("contact force"):
            axes.append(ax)
    return axes


MODES = dict.fromkeys(SYSTEMS, "light") | {"walls": "dark", "masses": "dark"}


@pytest.mark.exhaustive
@pytest.mark.parametrize("name", SYSTEMS)
def test_every_row_moves_on_the_paper_of_its_look_beside_its_forces(solved, name):
    """Frames differ, their corner has the colour of the paper, and forces are drawn if
    there is a contact.
    """
    mode = MODES[name]
    with plot.look(mode):
        film = plot.animation(solved[name], "stress", frames=3)

    frames = list(film.frames())

    first, second, third = frames
    assert first.shape == second.shape == third.shape
    assert not np.array_equal(first, second)
    assert not np.array_equal(second, third)
    assert film.colours == LOOKS[mode]
    corner = first[0, 0]
    assert np.array_equal(corner, paper_of(mode))
    has_contacts = name not in ("single", "driven")
    n_axes_of_forces = len(forces_of(film))
    assert n_axes_of_forces == int(has_contacts)


def paper_of(mode):
    """Colour of the paper of a look, [red, green, blue] to 255."""
    red_green_blue = np.array(to_rgb(LOOKS[mode].paper))
    return np.round(red_green_blue * 255)


LENGTHS = list(itertools.product([2, 3, 5, 20, 61], [1.0, 300.0, None]))
"""Numbers of frames, and magnifications."""


@pytest.mark.exhaustive
@pytest.mark.parametrize("case", LENGTHS)
def test_a_film_has_as_many_frames_as_asked_for_few_of_them_before_contact(
    solved, case
):
    """A film has the number of frames asked for, at most a fifth of them before
    contact, and one at time 0.
    """
    frames, magnification = case

    film = plot.animation(solved["unequal"], frames=frames, magnification=magnification)

    before_contact = np.count_nonzero(film.times < 0)
    assert len(film) == frames
    assert film.times.size == frames
    assert before_contact <= frames / 5
    assert 0.0 in film.times


@pytest.mark.exhaustive
def test_a_run_with_too_many_regions_is_shown_in_part(solved, monkeypatch):
    """With a small limit on regions, a film ends before the run and says how much it
    shows.
    """
    monkeypatch.setattr("rodimpact.plot.polygons.READABLE_REGIONS", 8)
    solution = solved["unequal"]

    film = plot.animation(solution, frames=2)

    texts = "\n".join(texts_on(film))
    assert film.times[-1] < solution.t_end
    assert re.search(r"first \d+ µs of 555 µs", texts)


# Files


def assert_alike(a, b):
    """The pixels of two pictures hardly differ: a GIF has 255 colours only."""
    difference = np.abs(a.astype(int) - b.astype(int))
    assert difference.mean() < 1.0


@pytest.fixture(scope="module")
def saved_gif(film, tmp_path_factory):
    """The path of `film`, saved as a GIF."""
    path = tmp_path_factory.mktemp("film") / "a.gif"
    plot.save(film, path)
    return path


@pytest.mark.exhaustive
def test_a_gif_is_the_same_every_time(film, saved_gif, tmp_path):
    path = tmp_path / "b.GIF"

    plot.save(film, path)

    assert path.read_bytes() == saved_gif.read_bytes()


def test_a_gif_shows_every_frame_in_its_time_again_and_again(film, saved_gif):
    """Seven frames of 100 ms, of which the last one is held, are repeated for ever."""
    durations = []
    with Image.open(saved_gif) as gif:
        assert gif.n_frames == 7
        assert gif.info["loop"] == 0
        for number in range(7):
            gif.seek(number)
            durations.append(gif.info["duration"])
            picture = np.asarray(gif.convert("RGB"))
            assert_alike(picture, film.frame(number))
            assert tuple(picture[0, 0]) == WHITE
    assert durations == [100, 100, 100, 100, 100, 100, 1600]


@pytest.mark.parametrize("name", ["a.png", "a"])
def test_save_names_the_formats_of_an_animation(film, tmp_path, name):
    """A wrong suffix or none is refused, with those that can be saved."""
    with pytest.raises(ValueError, match=r"\.gif, \.mp4"):
        plot.save(film, tmp_path / name)


@pytest.mark.exhaustive
def test_a_notebook_plays_it(film):
    """The HTML of a film holds a GIF of all its frames and a description."""
    image = r'<img src="data:image/gif;base64,(.*?)" alt="(.*?)".*>'

    data, description = re.fullmatch(image, film._repr_html_()).groups()

    file = io.BytesIO(base64.b64decode(data))
    with Image.open(file) as gif:
        assert gif.n_frames == 7
    assert description.startswith("2 rods, closing speed 1 m/s")


def test_an_interruption_leaves_no_file(film, tmp_path):
    """Saving a film is interrupted at its third frame: no file is left."""

    def interrupt(done, total):
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        film.save(tmp_path / "film.gif", progress=interrupt)

    assert list(tmp_path.iterdir()) == []


def install_ffmpeg(folder, monkeypatch, program):
    """Put a program in Python on the path under the name of ffmpeg."""
    path = folder / "ffmpeg"
    path.write_text(f"#!{sys.executable}\nimport sys\n{program}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", str(folder))


RECORDING_FFMPEG = """
data = sys.stdin.buffer.read()
options = " ".join(sys.argv[1:]).encode()
open(sys.argv[-1], "wb").write(options + b"|" + data)
"""


@pytest.mark.exhaustive
def test_an_mp4_is_made_by_ffmpeg_from_the_frames(film, tmp_path, monkeypatch):
    """A program in its place records its options and its input, which are all frames."""
    install_ffmpeg(tmp_path, monkeypatch, RECORDING_FFMPEG)

    path = tmp_path / "film.mp4"

    film.save(path)

    options, _, data = path.read_bytes().partition(b"|")
    height, width, _ = film.frame(0).shape
    frames = [frame.tobytes() for frame in film.frames()]
    assert f"-s {width}x{height} -r 10 ".encode() in options
    assert data == b"".join(frames)


def test_an_error_of_ffmpeg_is_passed_on(film, tmp_path, monkeypatch):
    """ffmpeg fails: OSError has its message, and no film is left."""
    failing = 'sys.stderr.write("no such codec"); sys.exit(1)'
    install_ffmpeg(tmp_path, monkeypatch, failing)

    with pytest.raises(OSError, match=r"film\.mp4.*ffmpeg failed: no such codec"):
        film.save(tmp_path / "film.mp4")

    files = [path.name for path in tmp_path.iterdir()]
    assert files == ["ffmpeg"]


# Command line


@pytest.fixture
def case(tmp_path, monkeypatch):
    """A case file in the current folder, and no ffmpeg on the path."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", str(tmp_path))
    path = tmp_path / "case.toml"
    path.write_text(UNEQUAL_RODS)
    return path.name


def test_the_command_makes_the_film(case, capsys):
    """`animate` writes a GIF with the frames, the duration and the dark paper that its
    options ask for, and says so in one line.
    """
    options = ["--frames", "4", "--fps", "20", "--field", "stress", "--dark"]

    status = main(["animate", case, "-o", "film.gif", *options, "--until", "0.2 ms"])

    out, err = capsys.readouterr()
    assert status == 0
    assert out == "4 frames from 0 s to 200 us, 0.2 s to watch: film.gif\n"
    assert err == ""
    with Image.open("film.gif") as gif:
        assert gif.n_frames == 4
        assert gif.info["duration"] == 50  # ms, at 20 frames a second
        pixels = np.asarray(gif.convert("RGB"))
        corner = pixels[0, 0]
        assert np.array_equal(corner, paper_of("dark"))


def test_the_command_says_that_ffmpeg_is_missing(case, capsys):
    status = main(["animate", case, "-o", "film.mp4"])

    missing = "ffmpeg, which makes MP4 files, is not on the path"
    remedy = "install it, or write a .gif"
    assert status == 1
    _, error = capsys.readouterr()
    assert f"{missing}; {remedy}" in error
