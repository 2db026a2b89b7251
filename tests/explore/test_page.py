"""The page in a browser: what a person sees and does.

In Python `page` is a page of Playwright; in scripts it is the state of the page, as
main.js has it.
"""

import itertools
import json
import os
import re
import shutil
import tomllib
from pathlib import Path

import numpy as np
import pytest
from exhaustive import few_of

import rodimpact as ri
from rodimpact.explorer.design import tables_of, with_gauges
from rodimpact.explorer.page_files import read
from rodimpact.explorer.presets import presets

sync_api = pytest.importorskip(
    "playwright.sync_api", reason="playwright is not installed: pip install playwright"
)


def installed_browser():
    """Path of a Chromium of this machine; None if there is none."""
    if os.environ.get("CHROMIUM"):
        return os.environ["CHROMIUM"]
    for name in ("chromium", "chromium-browser", "google-chrome"):
        path = shutil.which(name)
        if path:
            return path
    return None


BROWSER = installed_browser()
PRESETS = {preset.key: preset.case for preset in presets()}
LENGTH = "bodies.0.length"
CONTROLS = "button, input, select, canvas"
DRAWN = "() => !page.isSceneDue && !page.isRedrawDue"
"""Whether a page has solved its design and drawn it."""
TOUR_STEP_SHOWN = "() => !page.isSceneDue && !afterScene"
"""Whether a page has solved the design of a step of its tour, and begun to show it."""
PAINTED = 60  # ms, more than three frames of a screen
sync_api.expect.set_options(timeout=20_000)  # ms


@pytest.fixture(scope="module")
def browser():
    """Chromium, if there is one."""
    with sync_api.sync_playwright() as playwright:
        program = BROWSER or playwright.chromium.executable_path
        if not Path(program).is_file():
            pytest.skip("no Chromium: set CHROMIUM, or run playwright install chromium")
        switches = ["--no-sandbox", "--disable-gpu", "--disable-background-networking"]
        started = playwright.chromium.launch(executable_path=program, args=switches)
        yield started
        started.close()


@pytest.fixture(scope="module")
def url(tmp_path_factory):
    """The page that begins with rods of different length, as a file."""
    path = tmp_path_factory.mktemp("pages") / "page.html"
    ri.explore(PRESETS["unequal"]).save(path)
    return path.as_uri()


@pytest.fixture
def solved(tmp_path):
    """A function that writes a page with this system as its case, and returns the
    address.
    """

    def write(system, **solve):
        path = tmp_path / f"page-{len([*tmp_path.iterdir()])}.html"
        ri.explore(ri.Case(system, solve)).save(path)
        return path.as_uri()

    return write


@pytest.fixture
def visit(browser, url):
    """A function that opens an address, by default the page, without a network and
    returns the page. The test fails afterwards if a page wrote to the console, raised
    an error or asked for anything else.
    """
    contexts = []
    errors = []  # messages of the console, and requests that leave the page
    own_schemes = ("data:", "blob:", "file:")

    def note_request(request):
        if not request.url.startswith(own_schemes):
            errors.append(request.url)

    def open_page(address=url, **options):
        context = browser.new_context(**options)
        contexts.append(context)
        context.set_offline(True)
        page = context.new_page()
        page.on("console", lambda message: errors.append(message.text))
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("request", note_request)
        page.goto(address)
        page.wait_for_selector("html[data-frames]", state="attached")
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert errors == []


def field(page, path):
    """The input of the number with this path."""
    return page.locator(f'[id="{path}"]')


def number_in(page, path):
    """The number in the field with this path, in the unit of the field."""
    return float(field(page, path).input_value())


def slider(page, path):
    """The slider of a number of the case."""
    return page.locator(f'[data-slides="{path}"]')


def text_of(page, selector):
    """Text of an element, its blanks that do not break a line as plain blanks."""
    return page.inner_text(selector).replace("\u00a0", " ")


def wait_for_e(page, text):
    """Wait until the page shows this e."""
    sync_api.expect(page.locator("#restitution")).to_have_text(text)


def shown_e(outcome):
    """e of an outcome, as the page writes it."""
    return f"{outcome.restitution:.6g}"


def steel_rod(length, velocity=0.0):
    """A rod of 1 cm^2."""
    return ri.Rod(length, area=1e-4, material=ri.materials.steel, velocity=velocity)


def unfold(page, part):
    """Open what the form keeps folded of a body, of a contact or of the gauges."""
    page.click(f'[aria-controls="rest:{part}"]')


def open_menu(page):
    """Open the menu of the page."""
    page.click("#menu summary")


def stop_clock(page):
    """Let no time pass for a page or a frame: undo takes back changes without a
    pause.
    """
    page.evaluate("performance.now = () => 0")


def picture(page, canvas="#diagram"):
    """The pixels of a canvas, as the address of a PNG."""
    return page.locator(canvas).evaluate("canvas => canvas.toDataURL()")


def test_dragging_a_slider_moves_e_as_the_api_does(visit):
    """The slider of the length is dragged with the mouse: e is that of `collide`, the
    picture changes, and the chosen example is cleared. Before, e is 0.4.
    """
    page = visit()
    wait_for_e(page, "0.4")
    assert page.inner_text("#meaning") == "speed of parting / speed of approach"
    assert "Saint-Venant" in page.inner_text("#theory")
    assert page.input_value("#preset") == "unequal"
    assert field(page, LENGTH).input_value() == "400"
    unfold(page, "bodies.0")
    assert "impedance Z 3962 kg/s" in page.inner_text("#controls")
    before = picture(page)

    box = slider(page, LENGTH).bounding_box()
    y = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + 0.2 * box["width"], y)
    page.mouse.down()
    for share in (0.22, 0.25, 0.3, 0.34):
        page.mouse.move(box["x"] + share * box["width"], y)
    page.mouse.up()

    length = number_in(page, LENGTH)  # mm
    outcome = ri.collide(steel_rod(length / 1000, 1.0), steel_rod(1.0))
    assert length not in (0.0, 400.0)
    wait_for_e(page, shown_e(outcome))
    assert picture(page) != before
    assert page.input_value("#preset") == ""  # it is no longer that example


def rods_at(page, thousandths):
    """{body: (left, right)} of the rods in the picture, at a thousandth of the film."""
    page.locator("#time").fill(str(thousandths))
    pieces = page.evaluate("""() => {
        const { scene } = page;
        const pieces = cutPolygons(scene, currentTime());
        return pieces.map(({ polygon, low, high }) => [scene.tiling.body[polygon], low, high]);
    }""")
    rods = {}
    for body, low, high in pieces:
        left, right = rods.get(body, (low, high))
        rods[body] = (min(left, low), max(right, high))
    return rods


def assert_the_film_ends_with_its_rods(page):
    """In the last moment of the film all rods are drawn, and have hardly moved."""
    before = rods_at(page, 999)
    last = rods_at(page, 1000)
    assert last.keys() == before.keys()
    for body, ends in last.items():
        assert ends == pytest.approx(before[body], abs=0.01)


@pytest.mark.exhaustive
def test_presets_show_their_collisions_to_the_end(visit):
    """Each preset of the page shows the restitution of its `solve`, or "-", and the
    last velocity; it has a part of the form for each body and contact and for the
    gauges, and its film ends with the rods.
    """
    page = visit()
    for key, preset in PRESETS.items():
        page.select_option("#preset", key)
        page.wait_for_function(DRAWN)
        outcome = ri.solve(preset.system).outcome
        if outcome.why_no_restitution():
            wait_for_e(page, "-")
        else:
            wait_for_e(page, shown_e(outcome))
        *_, last_body = outcome.bodies
        *_, last_velocity = outcome.velocities_after
        if last_body == "rod":
            text = f"{last_velocity:.6g} m/s".replace("-0 ", "0 ")
            rows = page.locator("#results tr").all_inner_texts()
            assert any(row.endswith(text) for row in rows)
        # n bodies, the n - 1 contacts between them, and the gauges have a part each.
        parts = page.locator("#controls fieldset")
        assert parts.count() == 2 * len(outcome.bodies)
        assert_the_film_ends_with_its_rods(page)


def test_curves_of_the_collision_before_are_not_solved_for_the_next(visit):
    """Curves are solved once sliders rest. If another collision is chosen meanwhile,
    those of the one before would be an error, which `visit` finds.
    """
    page = visit()
    page.evaluate("""async () => {
        designChanged(true);
        await new Promise(requestAnimationFrame);
        const frame = requestAnimationFrame;
        // 400 ms are longer than the page waits for sliders to rest.
        window.requestAnimationFrame = (draw) => setTimeout(frame, 400, draw);
        showDesign(embedded.presets.find(({ key }) => key === "chain").design);
    }""")
    page.wait_for_function("() => page.scene.bodies.length > 2")


def test_a_material_of_the_list_or_of_ones_own_can_be_chosen(visit):
    """Rod 2 gets aluminium from the list, then an own material with another modulus: e
    on the page is that of `collide` each time.
    """
    page = visit()
    left = PRESETS["unequal"].system.bodies[0]

    unfold(page, "bodies.1")
    page.select_option('[id="bodies.1.material"]', "aluminium")
    aluminium = ri.Rod(1.0, area=1e-4, material=ri.materials.aluminium)
    wait_for_e(page, shown_e(ri.collide(left, aluminium)))

    # A material of one's own begins with the numbers of the last one.
    page.select_option('[id="bodies.1.material"]', "own 2")
    field(page, "materials.own 2.youngs_modulus").fill("50")  # GPa
    material = ri.Material("own", youngs_modulus=50e9, density=2698.0)
    outcome = ri.collide(left, ri.Rod(1.0, area=1e-4, material=material))
    wait_for_e(page, shown_e(outcome))


def test_a_mistake_is_told_beside_its_field_in_its_unit_and_mended(visit):
    """A length of -5 mm: a message in mm stands beside the field, and e, facts and
    reason are hidden. After 500 mm the message is gone.
    """
    page = visit()
    field(page, LENGTH).fill("-5")
    problem = page.locator(f'[id="problem:{LENGTH}"]')
    sync_api.expect(problem).to_have_text(
        "must be a finite positive number, got \u22125 mm"
    )
    assert field(page, LENGTH).get_attribute("aria-invalid") == "true"
    # Numbers of the collision before are hidden.
    for part in (".restitution", "#facts", "#reason"):
        assert not page.locator(part).is_visible()
    field(page, LENGTH).fill("500")
    wait_for_e(page, "0.5")
    sync_api.expect(problem).to_be_empty()


@pytest.mark.exhaustive
def test_negative_numbers_have_a_minus_sign_and_no_hyphen(visit):
    page = visit()
    field(page, "bodies.0.velocity").fill("-1")
    field(page, "bodies.1.velocity").fill("-3")
    sync_api.expect(page.locator("#results")).to_contain_text("\u22123 m/s")
    assert re.findall(r"[\s(]-\d", page.inner_text("main")) == []


def test_the_address_of_a_view_opens_the_same_view(visit):
    """Design, field, question and time are changed, and go into the address. A second
    page at this address has the same e, question and pictures.
    """
    page = visit()
    field(page, LENGTH).fill("300")
    page.check("input[value=stress]")
    page.uncheck("#displaced")
    open_menu(page)
    page.click("#ask")
    page.locator("#question").fill("How long & why?")
    page.locator("#time").fill("700")
    wait_for_e(page, "0.3")
    page.wait_for_url(
        re.compile(r"bodies\.0\.length=0\.3&.*view\.quantity=stress&view\.time=0\.7")
    )

    again = visit(page.url)

    wait_for_e(again, "0.3")
    assert again.inner_text("#question") == "How long & why?"
    assert again.is_checked("input[value=stress]")
    assert picture(again) == picture(page)
    assert picture(again, "#rods") == picture(page, "#rods")


def test_the_film_plays_until_it_is_paused_or_scrubbed(visit):
    """The button starts the film: the picture changes. Pressed again, it stops the
    time; moving the slider to 900 also stops the film, at 0.9 of it.
    """
    page = visit()
    page.select_option("#pace", "4")  # s, for the whole film
    page.locator("#time").fill("0")  # thousandths of the film
    start = picture(page, "#rods")

    page.click("#play")
    page.wait_for_timeout(400)
    page.click("#play")

    paused_at = float(page.input_value("#time"))
    assert 0 < paused_at < 1000
    assert picture(page, "#rods") != start
    page.wait_for_timeout(200)
    assert float(page.input_value("#time")) == paused_at

    page.click("#play")  # it plays again
    page.locator("#time").fill("900")  # scrubbed
    assert not page.evaluate("page.isPlaying")
    assert page.evaluate("page.fraction") == 0.9


READING = re.compile(
    r"t = (?P<t>\S+) (?P<t_prefix>µ?)s: "
    r"Rod (?P<rod>\d), x = (?P<x>\S+) (?P<x_prefix>m?)m .*"
    r"velocity (?P<v>\S+) (?P<v_prefix>m?)m/s, stress \S+"
)
PREFIXES = {"": 1.0, "m": 1e-3, "µ": 1e-6}


def test_pointing_reads_the_velocity_of_the_solution_or_that_no_rod_is_there(visit):
    """The mouse points at five places of the diagram: the page tells rod, x, t and the
    velocity of the solution there, or that there is no rod. At least three are on a
    rod.
    """
    page = visit()
    solution = ri.solve(PRESETS["unequal"].system)
    box = page.locator("#diagram").bounding_box()
    n_readings = 0
    # Parts of the width and height of the diagram; one or two lie beside the rods.
    for across, down in ((0.3, 0.7), (0.5, 0.6), (0.6, 0.3), (0.7, 0.5), (0.35, 0.2)):
        x_of_mouse = box["x"] + across * box["width"]
        y_of_mouse = box["y"] + down * box["height"]
        page.mouse.move(x_of_mouse, y_of_mouse)
        page.wait_for_timeout(PAINTED)
        text = text_of(page, "#readout").replace("\u2212", "-")
        reading = READING.match(text)
        if reading is None:
            assert "no rod here" in text
            continue
        n_readings += 1
        body = int(reading["rod"]) - 1
        t = float(reading["t"]) * PREFIXES[reading["t_prefix"]]
        x = float(reading["x"]) * PREFIXES[reading["x_prefix"]]
        velocity = float(reading["v"]) * PREFIXES[reading["v_prefix"]]
        expected = solution.velocity(body, x, t).item()
        assert velocity == pytest.approx(expected, abs=1e-9)
    assert n_readings >= 3


def turn_the_wheel_on_the_diagram(page):
    """Zoom in by turning the wheel over the diagram; then move the mouse away and wait
    until it is painted.
    """
    page.hover("#diagram")
    page.mouse.wheel(0, -400)
    # The mouse leaves, since its reading would change the picture.
    page.mouse.move(0, 0)
    page.wait_for_timeout(PAINTED)


def test_buttons_zoom_in_and_show_all(visit):
    """One button changes the picture; the other gives back the first one."""
    page = visit()
    page.mouse.move(0, 0)
    whole = picture(page)

    page.click("#zoom-in")
    page.wait_for_timeout(PAINTED)
    assert picture(page) != whole

    page.click("#zoom-all")
    page.wait_for_timeout(PAINTED)
    assert picture(page) == whole


def test_keys_zoom_move_and_show_all_and_read_values(visit):
    """Keys zoom and move the diagram, "0" shows all of it again, an arrow reads the
    velocity, and Escape gives back the first picture.
    """
    page = visit()
    page.mouse.move(0, 0)
    whole = picture(page)

    page.locator("#diagram").focus()
    page.keyboard.press("+")
    page.keyboard.press("Shift+ArrowRight")
    page.wait_for_timeout(PAINTED)
    assert picture(page) != whole

    page.keyboard.press("0")
    page.keyboard.press("ArrowUp")
    sync_api.expect(page.locator("#readout")).to_contain_text("velocity")
    page.keyboard.press("Escape")
    page.wait_for_timeout(PAINTED)
    assert picture(page) == whole


@pytest.mark.exhaustive
def test_the_wheel_scrolls_the_page_and_zooms_with_control(visit):
    """The wheel leaves the picture as it is, and changes it while Control is pressed."""
    page = visit()
    page.mouse.move(0, 0)
    whole = picture(page)

    turn_the_wheel_on_the_diagram(page)
    assert picture(page) == whole

    page.keyboard.down("Control")
    turn_the_wheel_on_the_diagram(page)
    page.keyboard.up("Control")
    assert picture(page) != whole


def test_a_case_can_be_saved_with_its_gauges(visit, tmp_path):
    """The downloaded case file has the typed length, the gauges of the preset, and the
    schema.
    """
    page = visit()
    field(page, LENGTH).fill("350")
    wait_for_e(page, "0.35")

    open_menu(page)
    with page.expect_download() as download:
        page.click("#save-case")

    path = tmp_path / "case.toml"
    download.value.save_as(path)
    case = ri.read_case(path)
    assert case.system.bodies[0].length == 0.35
    assert case.gauges == PRESETS["unequal"].gauges
    assert tomllib.loads(path.read_text())["schema"] == 1


def test_a_picture_can_be_saved_as_svg_that_a_browser_shows(visit, tmp_path):
    """The downloaded picture is an SVG file, which a browser decodes in another page."""
    page = visit()

    open_menu(page)
    with page.expect_download() as download:
        page.click("#save-svg")

    path = tmp_path / "picture.svg"
    download.value.save_as(path)
    assert path.read_text(encoding="utf-8").startswith("<svg xmlns=")
    holder_path = tmp_path / "holder.html"
    holder_path.write_text('<html data-frames="1"><img src="picture.svg"></html>')
    holder = visit(holder_path.as_uri())
    assert holder.evaluate("document.images[0].decode().then(() => true)")


@pytest.mark.parametrize("width", few_of([360, 1280], [360]))
def test_no_control_lies_outside_the_width_of_the_screen(visit, width):
    """Two presets are shown. All visible controls are within the width of the screen,
    to 1 pixel, and the page does not scroll sideways.
    """
    page = visit(viewport={"width": width, "height": 800})
    for key in ("unequal", "chain"):
        page.select_option("#preset", key)
        page.wait_for_timeout(200)
        outside = page.evaluate(f"""() => [...document.querySelectorAll("{CONTROLS}")]
            .filter((element) => element.getClientRects().length)  // it is shown
            .filter((element) => {{
                const {{ left, right }} = element.getBoundingClientRect();
                return left < -1 || right > innerWidth + 1;
            }})
            .map((element) => element.id)""")
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert outside == []


@pytest.mark.parametrize("width", few_of([961, 1121, 1300, 1366, 1440], [961]))
def test_the_buttons_of_the_picture_end_with_it_whatever_its_colours_show(visit, width):
    """In a window of this width, with colours of velocity or stress, the last button
    ends within the picture.
    """
    page = visit(viewport={"width": width, "height": 900})
    for quantity in ("velocity", "stress"):
        page.check(f"input[value={quantity}]")
        page.wait_for_timeout(200)
        stage = page.locator("#stage").bounding_box()
        button = page.locator("#zoom-all").bounding_box()
        right_edge = button["x"] + button["width"]
        assert right_edge <= stage["x"] + stage["width"] + 1


RECORD_LABELS = """() => {
    window.labels = [];  // of the diagram: text, left and right end, and height
    const { prototype } = CanvasRenderingContext2D;
    const write = prototype.fillText;
    prototype.fillText = function (text, ...rest) {
        if (this.canvas.id === "diagram" && this.textAlign === "center") {
            const { a: scale, e: x, f: y } = this.getTransform();
            const half = (scale * this.measureText(text).width) / 2;
            window.labels.push({ text, left: x - half, right: x + half, y });
        }
        write.call(this, text, ...rest);
    };
}"""


@pytest.mark.exhaustive
def test_forces_on_their_axis_beside_the_picture_do_not_overprint(visit, solved):
    """A peak of 918 N has five ticks, too many for labels of three digits."""
    aluminium = ri.materials.aluminium
    left = ri.Rod(0.3, area=1e-4, material=aluminium, velocity=1.0)
    right = ri.Rod(0.8, area=2e-4, material=aluminium)
    address = solved(ri.System([left, right]))
    page = visit(address, viewport={"width": 1300, "height": 1000})

    page.evaluate(RECORD_LABELS)
    page.locator("#time").fill("300")
    page.wait_for_function("window.labels.some(({ text }) => text === '800')")

    labels = page.evaluate("window.labels")
    # The axis of the force may have been drawn more than once.
    *_, height = [label["y"] for label in labels if label["text"] == "800"]
    row = {}  # labels in the row of the ticks, each once
    for label in labels:
        if label["y"] == height:
            row[label["text"], round(label["left"])] = label
    in_order = sorted(row.values(), key=lambda label: label["left"])
    assert [label["text"] for label in in_order][-3:] == ["0", "400", "800"]
    for label, neighbour in itertools.pairwise(in_order):
        assert label["right"] < neighbour["left"]


def test_every_control_has_a_name(visit):
    """Each control of the page has a label, text or name for screen readers."""
    page = visit()
    unnamed = page.evaluate(f"""() => [...document.querySelectorAll("{CONTROLS}")]
        .filter((element) => !(element.labels && element.labels.length)
                             && !element.ariaLabel
                             && !element.textContent.trim()
                             && !element.getAttribute("aria-labelledby"))
        .map((element) => element.outerHTML)""")
    assert unnamed == []


def test_the_tab_key_reaches_the_controls(visit):
    """Forty presses of the Tab key, with the menu opened on the way, reach preset,
    theme, quantity, diagram, play, time and length.
    """
    page = visit()
    focused = set()
    for _ in range(40):
        page.keyboard.press("Tab")
        focused.add(
            page.evaluate("document.activeElement.id || document.activeElement.name")
        )
        if page.evaluate("document.activeElement.matches('#menu summary')"):
            # What the menu holds takes the focus when it is open.
            page.keyboard.press("Enter")
    expected = {"preset", "theme", "quantity", "diagram", "play", "time", LENGTH}
    assert expected <= focused


HERTZ = ri.System(PRESETS["unequal"].system.bodies, contacts=[ri.Hertz(1e10)])


@pytest.mark.exhaustive
def test_a_spring_keeps_the_faces_apart_and_the_film_begins_before_contact(
    visit, solved
):
    """At eleven times the drawn rods of a Hertz contact do not touch; the film and the
    lines of the centres begin before time 0.
    """
    page = visit(solved(HERTZ))
    for thousandths in range(0, 1001, 100):
        rods = rods_at(page, thousandths)
        _, right_end_of_first = rods[0]
        left_end_of_second, _ = rods[1]
        assert right_end_of_first < left_end_of_second
    page.locator("#time").fill("0")
    assert page.evaluate("currentTime()") < 0
    assert page.evaluate(
        "page.scene.centres.every(({ t }) => t[0] === page.scene.begin)"
    )
    sync_api.expect(page.locator("#sentence")).to_contain_text("Rod 1 moves at 1")


@pytest.mark.exhaustive
def test_a_scene_knows_the_number_of_cells_of_all_its_grids(visit, solved):
    """The sum of rows times columns of all grids of a scene is its `cellCount`."""
    page = visit(solved(HERTZ))
    assert page.evaluate(
        "page.scene.grids.map((grid) => grid.rows * grid.across)"
        ".reduce((a, b) => a + b) === page.scene.cellCount"
    )


def test_a_sentence_follows_the_events(visit):
    """Buttons, a click on the time axis, and a click in the list go to events of the
    collision; a sentence tells the event each time. The third event is at two transits
    of the striker.
    """
    page = visit()
    sentence = page.locator("#sentence")
    assert sentence.get_attribute("aria-live") == "polite"
    page.locator("#time").fill("0")
    for words in (
        "Rod 1 and rod 2 meet",
        "left end of rod 1 and turns back",
        "the force between rod 1 and rod 2 ends; they still touch, without force",
    ):
        page.click("#event-after")
        sync_api.expect(sentence).to_contain_text(words)
    transit_time = 0.4 / ri.materials.steel.wave_speed
    assert page.evaluate("currentTime()") == pytest.approx(2 * transit_time, rel=1e-6)

    page.click("#event-before")
    sync_api.expect(sentence).to_contain_text("turns back")

    # A click on the time axis goes to that time.
    on_time_axis = page.evaluate(
        "({ x: page.frame.x, y: page.frame.up(page.scene.events[1].t) })"
    )
    page.locator("#diagram").click(position=on_time_axis)
    sync_api.expect(sentence).to_contain_text("meet")

    # A click in the list of events goes to the event.
    page.click("#all-events summary")
    page.locator("#events button").last.click()
    sync_api.expect(sentence).to_contain_text("rod 2 has 0.4 m/s on average")
    sync_api.expect(page.locator("#reason")).to_contain_text(
        "touch without force until they part"
    )


PARTS_THAT_TELL = (
    "#restitution",
    "#meaning",
    "#theory",
    "#plot-curve",
    "#remark",
    "#facts",
    "#plots",
    "#notes",
    "#reason",
    "#sentence",
    "#all-events",
    "#readout",
    "#time",
    "#other",
)


def test_before_a_guess_nothing_is_seen_that_tells_e(visit):
    """After "guess first", all parts that tell e are hidden and the page asks one
    question. The diagram stays hidden also after another design and back.
    """
    page = visit()
    whole = picture(page)

    page.click("#guess-first")

    for part in PARTS_THAT_TELL:
        assert not page.locator(part).is_visible(), part
    question = page.locator("#asked")
    sync_api.expect(question).to_contain_text(
        "rod 2 is at rest. How fast do they part, as a share of"
    )
    assert question.inner_text().count("?") == 1
    page.wait_for_timeout(PAINTED)
    hidden = picture(page)
    # Another design and back again: the diagram stays hidden.
    field(page, LENGTH).fill("900")
    wait_for_e(page, "0.9")
    field(page, LENGTH).fill("400")
    wait_for_e(page, "0.4")
    page.wait_for_timeout(PAINTED)
    assert hidden != whole
    assert picture(page) == hidden


def guess(page, number):
    """Answer the question for e by a number."""
    page.click("#guess-first")
    page.locator("#guessed").fill(number)
    page.keyboard.press("Enter")


def test_a_guess_is_judged_and_the_replay_begins(visit):
    """After a guess of 0.7, the page says that it is off by 0.3, gives the reason,
    shows e, and plays the film from its beginning.
    """
    page = visit()
    guess(page, "0.7")
    verdict = page.locator("#verdict")
    sync_api.expect(verdict).to_contain_text("You said 0.7; e is 0.4: off by 0.3.")
    for words in ("Rod 1's wave returns", "The impulse of 314", "so e = 0.4 = l₁/l₂"):
        sync_api.expect(page.locator("#reason")).to_contain_text(words)
    assert page.evaluate("page.isPlaying")
    assert page.evaluate("currentTime() < 0.2 * page.scene.end")  # from the beginning
    assert page.evaluate("document.activeElement.id") == "play"
    assert page.locator("#restitution").is_visible()


@pytest.mark.exhaustive
def test_a_verdict_disappears_when_e_changes(visit):
    """After the guess e = 0.7, the verdict on it is empty as soon as another length
    of the rod changes e.
    """
    page = visit()
    guess(page, "0.7")
    verdict = page.locator("#verdict")
    sync_api.expect(verdict).to_contain_text("You said 0.7")
    field(page, LENGTH).fill("700")
    wait_for_e(page, "0.7")
    assert verdict.inner_text() == ""


def test_the_question_is_about_the_row_that_is_chosen_and_a_chain_has_no_e(visit):
    """The question names rod 2 for two rods, not for a wall; for a chain the page says
    that e belongs to one contact, and shows none.
    """
    page = visit()
    page.click("#guess-first")
    question = page.locator("#asked")
    sync_api.expect(question).to_contain_text("rod 2")
    page.select_option("#preset", "wall")
    sync_api.expect(question).not_to_contain_text("rod 2")
    page.select_option("#preset", "chain")
    sync_api.expect(page.locator("#theory")).to_contain_text(
        "belongs to one contact; this row has 4"
    )
    for part in ("#restitution", "#meaning"):
        assert not page.locator(part).is_visible()


@pytest.mark.parametrize(
    ("width", "height"),
    [(1024, 768), pytest.param(390, 844, marks=pytest.mark.exhaustive)],
)
def test_e_and_its_curve_are_seen_beside_the_picture_while_any_slider_moves(
    visit, width, height
):
    """Each of the 8 sliders is scrolled into view: slider, e, curve and diagram are
    then on the screen together, and nothing covers the slider.
    """
    page = visit(viewport={"width": width, "height": height})
    for part in ("bodies.0", "contacts.0", "bodies.1", "gauges"):
        unfold(page, part)
    sliders = page.locator("#controls input[type=range]")
    assert sliders.count() == 8
    for k in range(sliders.count()):
        sliders.nth(k).scroll_into_view_if_needed()
        moved = sliders.nth(k).bounding_box()
        e = page.locator(".restitution").bounding_box()
        curve = page.locator("#curve").bounding_box()
        diagram = page.locator("#diagram").bounding_box()
        for box in (moved, e, curve, diagram):
            assert box["y"] >= 0
            assert box["y"] + box["height"] <= height + 1
        # Nothing covers the slider.
        id_at_middle = page.evaluate(
            "([x, y]) => document.elementFromPoint(x, y).id",
            [moved["x"] + moved["width"] / 2, moved["y"] + moved["height"] / 2],
        )
        assert id_at_middle.startswith("slider:"), k
    assert curve["y"] >= e["y"]
    assert curve["y"] < diagram["y"] + diagram["height"]


def test_rods_and_masses_share_one_count_from_the_left_without_walls(visit, solved):
    """A wall, a rod and a mass are named "The wall", "Rod 1" and "Mass 2" in form,
    results, plots and sentence, while paths count the wall, too.
    """
    rod = PRESETS["unequal"].system.bodies[1]
    mass = ri.RigidMass(1.0, velocity=-1.0)
    page = visit(solved(ri.System([ri.Wall(), rod, mass])))
    assert page.locator("#controls legend").all_inner_texts()[:5] == [
        "The wall",
        "Contact wall-1",
        "Rod 1",
        "Contact 1-2",
        "Mass 2",
    ]
    # A path counts all bodies from 0, also walls: the rod is bodies.1.
    assert field(page, "bodies.1.length").count() == 1
    sync_api.expect(page.locator("#results")).to_contain_text("velocity of mass 2")
    sync_api.expect(page.locator("#plot-force")).to_contain_text("contact wall-1")
    page.locator("#time").fill("0")
    sentence = sync_api.expect(page.locator("#sentence"))
    sentence.to_contain_text("The wall is at rest, rod 1 is at rest, mass 2 moves")


def test_dashed_lines_have_the_slopes_of_the_velocities_and_marks_the_round_trips(
    visit,
):
    """The lines of both centres have the slopes of the velocities before and after the
    force, and the marks on the time axis are at the round trips of both rods.
    """
    page = visit()
    # First and last slope of the line of each centre, m/s: before and after the force.
    slopes = page.evaluate("""() => page.scene.centres.map(({ t, y }) => [[0, 1], [-2, -1]]
        .map(([i, j]) => (y.at(j) - y.at(i)) / (t.at(j) - t.at(i)))
        .map((slope) => slope / page.scene.row.magnification))""")
    marks = page.evaluate("page.scene.marks.map(({ t, text }) => [t, text])")

    slopes_of_first, slopes_of_second = slopes
    seconds_per_metre = 1 / ri.materials.steel.wave_speed
    assert slopes_of_first == pytest.approx([1.0, 0.0], abs=1e-6)
    assert slopes_of_second == pytest.approx([0.0, 0.4], abs=1e-6)
    assert marks == [
        [pytest.approx(2 * 0.4 * seconds_per_metre), "2l₁/c"],
        [pytest.approx(2 * 1.0 * seconds_per_metre), "2l₂/c"],
    ]


def test_the_picture_is_displaced_lines_up_with_the_rods_and_fills_its_width(visit):
    """In the middle of the film, the struck face is at the same pixel in diagram and
    strip of rods, at the end of its rod, and the row fills 95 % of the width.
    """
    page = visit()
    page.locator("#time").fill("500")
    page.wait_for_function("() => !page.isRedrawDue")
    # Pixels across of the struck face of rod 2, in the diagram and in the strip.
    in_diagram, in_strip = page.evaluate("""() => {
        const face = valueAt(page.scene.contacts[0].faces[1], currentTime());
        return [page.frame.across(face), page.strip.frame.across(face)];
    }""")
    left_end = page.evaluate("page.strip.frame.across(page.strip.ends.get(1)[0])")
    share_of_width = page.evaluate("""() => {
        const [low, high] = page.scene.row.span;
        return (high - low) / (page.view.right - page.view.left);
    }""")
    assert page.is_checked("#displaced")
    assert in_diagram == pytest.approx(left_end)
    assert in_strip == pytest.approx(left_end)
    assert share_of_width > 0.95


@pytest.mark.parametrize(
    ("width", "key"),
    [(1440, "unequal"), pytest.param(390, "chain", marks=pytest.mark.exhaustive)],
)
def test_a_print_is_one_page_on_white_without_controls(visit, width, key):
    """A dark page is printed: the PDF has one page, the theme is light and no control
    is visible. On the screen it is dark again.
    """
    page = visit(viewport={"width": width, "height": 800}, color_scheme="dark")
    page.select_option("#preset", key)
    page.wait_for_function(DRAWN)
    pdf = page.pdf(format="A4", print_background=True)
    assert len(re.findall(rb"/Type\s*/Page\b", pdf)) == 1
    theme = sync_api.expect(page.locator("html"))
    theme.to_have_attribute("data-theme", "dark")
    page.emulate_media(media="print")
    theme.to_have_attribute("data-theme", "light")
    shown = page.evaluate("""() => [...document.querySelectorAll("button, input, select")]
        .filter((element) => element.getClientRects().length)
        .map((element) => element.outerHTML)""")
    assert shown == []
    page.emulate_media(media="screen")
    theme.to_have_attribute("data-theme", "dark")


def test_a_tour_shows_the_box_and_other_examples_in_six_steps(visit):
    """The tour is followed to its end: presets and times shown at its six steps are
    those of the collision of the box, a wall and unequal rods.
    """
    page = visit()
    page.click("#tour-open")
    presets_shown = []
    times_shown = []
    for k in range(6):
        sync_api.expect(page.locator("#tour-text")).to_contain_text(f"{k + 1} of 6")
        page.wait_for_function(TOUR_STEP_SHOWN)
        presets_shown.append(page.input_value("#preset"))
        times_shown.append(page.evaluate("currentTime()"))
        page.click("#tour-next")
    first_time, *later_times = times_shown
    transit_time = 1 / ri.materials.steel.wave_speed  # s, of rods of 1 m
    transits = [time / transit_time for time in later_times]
    assert presets_shown == [*["identical"] * 4, "wall", "unequal"]
    assert first_time < 0
    assert transits == pytest.approx([0.5, 1, 2, 2, 0.8])
    assert not page.locator("#tour").is_visible()


def test_the_space_bar_plays_and_pauses_without_scrolling(visit):
    """On a small screen, the space bar makes the button say "Pause", then "Play" again,
    and the page stays at the top.
    """
    page = visit(viewport={"width": 360, "height": 700})
    page.locator("body").press("Space")
    sync_api.expect(page.locator("#play")).to_have_text("Pause")
    page.locator("body").press("Space")
    sync_api.expect(page.locator("#play")).to_have_text("Play")
    assert page.evaluate("scrollY") == 0


def test_a_finger_reads_values_and_finds_every_control_large_enough(visit):
    """On a touch screen, a tap on the diagram reads the velocity, and no visible
    control is smaller than 24 pixels.
    """
    page = visit(viewport={"width": 360, "height": 700}, has_touch=True)
    box = page.locator("#diagram").bounding_box()
    page.touchscreen.tap(box["x"] + 0.4 * box["width"], box["y"] + 0.5 * box["height"])
    sync_api.expect(page.locator("#readout")).to_contain_text("velocity")
    small = page.evaluate(f"""() => [...document.querySelectorAll("{CONTROLS}, summary")]
        .filter((element) => element.getClientRects().length)
        .filter((element) => {{
            const {{ width, height }} = element.getBoundingClientRect();
            return width < 24 || height < 24;
        }})
        .map((element) => element.outerHTML)""")
    assert small == []


@pytest.mark.exhaustive
def test_two_collisions_are_shown_at_the_same_time_in_the_same_colours(visit):
    """A collision is kept and another one chosen: the text names the kept e, both have
    one scale of colours, and time begins with the earlier one.
    """
    page = visit()

    page.click("#compare")
    page.select_option("#preset", "hopkinson")

    page.wait_for_function("() => !page.isSceneDue && page.scene.bodies.length === 3")
    sync_api.expect(page.locator("#other-text")).to_contain_text("Kept: e = 0.4")
    scale, kept_scale = page.evaluate("[page.scene.scale, page.keptScene.scale]")
    assert scale == kept_scale
    assert scale["velocity"] == 10
    page.locator("#time").fill("0")
    assert page.evaluate(
        "currentTime() === Math.min(page.scene.begin, page.keptScene.begin)"
    )


def test_a_kept_collision_stands_beside_the_other_until_it_is_dropped(visit):
    """A collision is kept and another one chosen: their diagrams are side by side; a
    second press of the button hides the kept one.
    """
    page = visit()

    page.click("#compare")
    page.select_option("#preset", "hopkinson")

    page.wait_for_function("() => !page.isSceneDue && page.scene.bodies.length === 3")
    page.wait_for_function("byId('diagram').width === byId('diagram').clientWidth")
    diagram = page.locator("#diagram").bounding_box()
    other_diagram = page.locator("#other-diagram").bounding_box()
    assert diagram["x"] + diagram["width"] <= other_diagram["x"]
    page.click("#compare")
    assert not page.locator("#other").is_visible()


def bodies_of(page):
    """Kinds of the bodies of the design, from the left."""
    return page.evaluate("design.case.bodies.map((body) => body.kind)")


def test_bodies_and_steps_are_added_removed_moved_and_undone(visit):
    """A wall and a mass are added, a rod is removed, the mass is moved, a step is added
    and removed. The list of bodies follows each change, gauges and contacts too; after
    six undos e is 0.4 again.
    """
    page = visit()
    page.select_option("#add-kind", "wall")
    page.click("[aria-label='Add body']")
    page.select_option("#add-kind", "mass")
    page.click("[aria-label='Add body']")
    assert bodies_of(page) == ["rod", "rod", "mass", "wall"]
    sync_api.expect(page.locator("#results")).to_contain_text(
        "velocity of mass 3 after"
    )
    for part in ("bodies.0", "bodies.1"):
        unfold(page, part)

    page.click("[aria-label='Remove rod 1']")
    assert bodies_of(page) == ["rod", "mass", "wall"]
    # The gauge stays on its rod, and the contact has gone with the rod.
    assert page.evaluate("design.gauges[0].body") == 0
    assert page.evaluate("design.case.contacts.length") == 2

    page.click("[aria-label='Move mass 2 to the left']")
    page.click("[aria-label='+ step of rod 2']")
    areas = page.evaluate("design.case.bodies[1].segments.map(({ area }) => area)")
    assert areas == [1e-4, 2e-4]

    page.click("text=− step")  # noqa: RUF001
    assert page.evaluate("design.case.bodies[1].length") == 1.0

    # Three changes are undone by keys, and the other three by the button.
    for _ in range(3):
        page.keyboard.press("Control+z")
    assert bodies_of(page) == ["rod", "mass", "wall"]
    for _ in range(3):
        page.click("#undo")
    wait_for_e(page, "0.4")
    assert page.locator("#undo").is_disabled()


def drag(page, start, distance):
    """Drag a point of the strip of rods to the right.

    Parameters
    ----------
    page : Page
    start : str
        JavaScript expression of the point, [x, y] in pixels of the strip.
    distance : float
        In pixels.
    """
    page.wait_for_function(DRAWN)
    x, y = page.evaluate(start)
    box = page.locator("#rods").bounding_box()
    page.mouse.move(box["x"] + x, box["y"] + y)
    page.mouse.down()
    for share in (0.3, 0.7, 1):
        page.mouse.move(box["x"] + x + share * distance, box["y"] + y)
    page.mouse.up()


def test_ends_gauges_and_rods_are_dragged_in_the_picture(visit):
    """An end is dragged, and the rod gets longer, with its e; a gauge is dragged along
    its rod; a rod is dragged past the other, and they change places until an undo.
    """
    page = visit()
    right_end = "page.strip.frame.across(page.strip.ends.get({body})[1])"
    right_end_of_first = right_end.format(body=0)
    right_end_of_second = right_end.format(body=1)
    pixels_per_metre = page.evaluate(
        "page.strip.frame.across(1) - page.strip.frame.across(0)"
    )

    # An end is dragged: the rod gets longer.
    drag(page, f"[{right_end_of_second}, page.strip.middle]", 0.2 * pixels_per_metre)
    length = number_in(page, "bodies.1.length")  # mm
    assert length == pytest.approx(1200, abs=2)
    wait_for_e(page, f"{400 / length:.6g}")

    # A gauge is dragged along its rod; it was in the middle.
    drag(page, "page.strip.gauges[0]", 60)
    assert number_in(page, "gauges.0.fraction") > 60  # %

    # A rod is dragged past the other: they change places.
    in_first_rod = f"[{right_end_of_first} - 20, page.strip.middle]"
    drag(page, in_first_rod, 0.9 * pixels_per_metre)
    assert number_in(page, "bodies.1.length") == 400
    page.click("#undo")
    assert number_in(page, LENGTH) == 400


def test_names_never_become_markup(visit, solved):
    """A material whose name holds tags is shown as text, and no element is made of it."""
    alloy = ri.Material(
        "</script><b onclick=1>&amp;</b>", youngs_modulus=200e9, density=7850.0
    )
    rod = ri.Rod(1.0, area=1e-4, material=alloy, velocity=1.0)
    page = visit(solved(ri.System([rod, ri.Wall()])))
    assert alloy.name in page.locator('[id="bodies.0.material"]').inner_text()
    assert page.locator("b").count() == 0


def test_an_address_whose_design_cannot_be_read_or_solved_is_told(visit, url):
    """Three wrong designs in the address, with gravity, of a wrong type and incomplete,
    lead to messages on the page.
    """
    context = visit().context
    for address, words in (
        (
            "#case.schema=1&case.gravity=9.81&case.bodies.0.kind=rod"
            "&case.bodies.0.length=1&case.bodies.0.area=1e-4&case.bodies.0.material=steel",
            "this page cannot solve gravity; Python can, with rodimpact animate",
        ),
        ("#case.bodies=7", "The design cannot be read"),
        ("#case.schema=1&case.bodies.0.kind=rod", "must be a finite positive number"),
    ):
        page = context.new_page()
        page.goto(f"{url}{address}")
        message = page.locator("#message:not(:empty), .problem:not(:empty)").first
        sync_api.expect(message).to_contain_text(words)


def with_first_length(system, length):
    """A system whose first rod has another length."""
    first, *others = system.bodies
    return system.replace(bodies=[first.replace(length=length), *others])


def test_two_rods_with_round_ends_are_solved_for_each_length_of_the_first(
    visit, solved
):
    """For three typed lengths, e on the page is that of `solve` with a Hertz contact."""
    page = visit(solved(HERTZ))
    for mm in (300, 500, 700):
        field(page, LENGTH).fill(f"{mm}")
        outcome = ri.solve(with_first_length(HERTZ, mm / 1000)).outcome
        wait_for_e(page, f"{outcome.restitution:.5g}")


def test_the_curve_of_round_ends_falls_from_e_of_balls_to_the_ratio_of_lengths(
    visit, solved
):
    """The curve of e over the stiffness of a Hertz contact is 1 at the softest contact
    and the ratio of lengths, 0.7, at the stiffest; at the stiffness of the case it is
    that of `solve`.
    """
    system = with_first_length(HERTZ, 0.7)
    page = visit(solved(system))
    for curve in ("curve", "roundness"):
        page.wait_for_function(f"() => page.scene.{curve}.isOutdated === false")
        page.wait_for_function(
            f"() => page.scene.{curve}.values.filter((e) => e !== null).length === 20"
        )

    # `ratios` are decadic logarithms of kappa, the stiffness of the contact.
    curve = page.evaluate("page.scene.roundness")
    ratios = curve["ratios"]
    e = curve["values"]
    e_here = np.interp(curve["here"], ratios, e)
    assert ratios[0] == -2
    assert ratios[-1] == 4
    assert e[0] == pytest.approx(1.0, abs=0.02)
    assert e_here == pytest.approx(ri.solve(system).outcome.restitution, abs=0.02)
    assert e[-1] == pytest.approx(0.7, abs=0.02)
    assert page.locator("#plot-roundness").is_visible()


@pytest.mark.exhaustive
def test_rigid_ends_are_the_end_of_the_slider_of_round_ends(visit, solved):
    """A Hertz contact is made rigid: e is the ratio of lengths, the plot says "rigid
    ends", and the slider of its roundness stands at its end, 4.
    """
    page = visit(solved(with_first_length(HERTZ, 0.7)))

    page.select_option('[id="contacts.0.law"]', "rigid")

    wait_for_e(page, "0.7")
    sync_api.expect(page.locator("#plot-roundness")).to_contain_text("rigid ends")
    assert page.locator("#ends").input_value() == "4"


def round_ends(page, log_kappa):
    """Move the slider of the ends to a decadic logarithm of kappa; None: rigid ends.

    Return the draft of e while the slider moves: {value, error}.
    """
    return page.evaluate(
        """(logKappa) => {
            byId("ends").value = logKappa ?? byId("ends").max;
            byId("ends").dispatchEvent(new Event("input"));
            return sceneOf(design, true).scene.restitution;
        }""",
        log_kappa,
    )


def test_a_slider_rounds_the_ends_and_drafts_of_e_state_their_error(visit):
    """e falls from that of balls to l1/l2."""
    page = visit()
    left, right = PRESETS["unequal"].system.bodies
    restitutions = []
    for log_kappa in (-2, 1, 3):
        draft = round_ends(page, log_kappa)
        stiffness = number_in(page, "contacts.0.stiffness") * 1e9  # N/m^1.5
        # kappa = k (V T)^(1/2) L/(E A), with V = 1 m/s and L = 1 m
        kappa = stiffness * right.transit_time**0.5 / (2e11 * 1e-4)
        assert kappa == pytest.approx(10**log_kappa, rel=0.01)
        rounded = ri.System([left, right], contacts=[ri.Hertz(stiffness)])
        e = ri.solve(rounded).outcome.restitution
        wait_for_e(page, f"{e:.5g}")
        error = 5e-6  # of the digits that are shown, if no other is stated
        if draft["error"]:
            error = float(draft["error"].replace("\u2212", "-"))
        assert draft["value"] == pytest.approx(e, abs=error)
        restitutions.append(e)
    assert restitutions == sorted(restitutions, reverse=True)
    round_ends(page, log_kappa=None)
    wait_for_e(page, "0.4")


@pytest.mark.exhaustive
def test_a_map_of_compliant_contacts_is_made_of_solutions(visit, solved):
    """A map over length and stiffness of a Hertz contact is solved on the page: one of
    its values is e of `solve` to 1e-6.
    """
    page = visit(solved(HERTZ))
    page.click("#map summary")
    page.select_option("#map-y", label="stiffness of contact 1-2")
    sync_api.expect(page.locator("#map-reading")).to_contain_text("% solved")
    page.wait_for_function("() => map.values.length > 5", timeout=120_000)
    # One of its members: mm across, GN/m^1.5 upwards.
    mm, stiffness, e = page.evaluate("[map.xs[30], map.ys[5], map.values[5][30]]")
    row = with_first_length(HERTZ, mm / 1000)
    row = row.replace(contacts=[ri.Hertz(stiffness * 1e9)])
    assert e == pytest.approx(ri.solve(row).outcome.restitution, abs=1e-6)


def test_a_collision_that_takes_too_long_is_told_and_the_page_goes_on(visit, solved):
    """The time for solving is limited, and a rod becomes 1 um long: the page says that
    this takes too long and hides the results. After an undo and another length it shows
    results again.
    """
    left, right = PRESETS["unequal"].system.bodies
    middle = right.replace(length=0.1)
    contacts = [ri.Rigid(), ri.Hertz(1e10)]
    page = visit(solved(ri.System([left, middle, right], contacts=contacts)))
    page.evaluate("Object.assign(TIME_LIMITS, { scene: 0.2, draft: 0.1 })")  # s
    # Waves run many times through a rod of 1 um.
    field(page, "bodies.1.length").fill("0.001")
    message = sync_api.expect(page.locator("#message"))
    message.to_contain_text("This collision takes too long for the page.")
    message.to_contain_text("Make the shortest rod longer")
    assert not page.locator("#results").is_visible()
    # Neither is a design of two rods, while the picture still has three.
    design_of_two_rods = tables_of(with_gauges(ri.Case(with_first_length(HERTZ, 1e-6))))
    page.evaluate("(design) => showDesign(design)", design_of_two_rods)
    page.wait_for_function(DRAWN)
    message.to_contain_text("This collision takes too long for the page.")
    page.click("#undo")
    page.evaluate("TIME_LIMITS.scene = 60")
    field(page, "bodies.1.length").fill("100")
    sync_api.expect(page.locator("#results")).to_be_visible()
    message.to_be_hidden()


@pytest.mark.exhaustive
def test_a_curve_of_other_rods_is_grey_until_it_is_solved(visit, solved):
    """The curve over the stiffness is outdated for a rod of another length, and only
    then; an outdated curve is drawn in grey, another in blue.
    """
    page = visit(solved(HERTZ))
    page.wait_for_function("() => page.scene.roundness.isOutdated === false")
    # The curve was solved for a first rod of 0.4 m.
    same_is_outdated, other_is_outdated = (
        page.evaluate("""() => [0.4, 0.55].map((length) => {
        const other = structuredClone(design);
        other.case.bodies[0].length = length;
        return sceneOf(other).scene.roundness.isOutdated;
    })""")
    )
    assert not same_is_outdated
    assert other_is_outdated
    draw = """drawRestitution("roundness",
        {{ ...page.scene.roundness, low: -2, isOutdated: {} }},
        {{ title: "", name: "", label: "" }}, page.scene, page.theme)"""
    grey, blue = page.evaluate("[page.theme.line, page.theme.series[0]]")
    assert colours_of_curves(lines_drawn(page, draw.format("true"))) == [grey]
    assert colours_of_curves(lines_drawn(page, draw.format("false"))) == [blue]


def colours_of_curves(lines):
    """Colours of the lines of 20 points, which are curves of e."""
    return [colour for colour, points in lines if len(points) == 20]


@pytest.mark.exhaustive
def test_the_legend_names_the_values_that_occur(visit):
    """The legend of the colours has the smallest and largest velocity, or stress in
    compression and tension, that occur, also after the velocities change.
    """
    page = visit()
    legend = sync_api.expect(page.locator(".bar .legend"))
    legend.to_have_text("0 m/s+1 m/s")  # no rod moves to the left
    page.check("input[value=stress]")
    low, high = page.evaluate("page.scene.colourRange.stress")
    assert low == pytest.approx(-high)  # the wave turns back at free ends
    legend.to_have_text("−19.8 MPa, compressed+19.8 MPa")  # noqa: RUF001
    field(page, "bodies.0.velocity").fill("0")
    field(page, "bodies.1.velocity").fill("-2")
    page.check("input[value=velocity]")
    legend.to_have_text("−2 m/s0 m/s")  # noqa: RUF001


@pytest.mark.exhaustive
def test_no_line_ends_before_a_unit_a_value_or_the_number_of_a_body(visit):
    """For three presets, the sentences have no breaking space between a number and its
    unit, before " = ", or between "rod" and its number.
    """
    page = visit()
    for key in ("unequal", "chain", "wall"):
        page.select_option("#preset", key)
        page.wait_for_function(DRAWN)
        for part in ("#reason", "#sentence", "#theory", "#remark", "#notes"):
            # A plain blank may end a line, one that does not break (U+00A0) may not.
            text = page.locator(part).text_content()
            assert re.findall(r"\d (?:%|[nµmkMG]?(?:m|s|N|J|Pa)\b)| = ", text) == []
            assert re.findall(r"(?i)\b(?:rod|mass|contact) \d", text) == []


@pytest.mark.exhaustive
def test_a_quantity_that_is_rounded_up_has_the_next_prefix(visit):
    """`quantity` on the page formats four values with a unit and a number of digits:
    999.97 m/s, for example, is 1 km/s.
    """
    page = visit()
    for value, digits, text in (
        (0.96, 1, "1 m/s"),
        (0.96, 2, "960 mm/s"),
        (999.97, 4, "1 km/s"),
        (-0.9996, 3, "−1 m/s"),  # noqa: RUF001
    ):
        arguments = json.dumps([value, "m/s", digits])
        shown = page.evaluate(f"quantity(...{arguments})")
        assert shown.replace("\u00a0", " ") == text


@pytest.mark.exhaustive
def test_facts_of_the_solver_are_in_the_notes_only(visit):
    """Method, digits and number of solved ratios stand in the notes, and not above
    them.
    """
    page = visit()
    wait_for_e(page, "0.4")
    notes = text_of(page, "#notes")
    top = text_of(page, "#top")
    for fact in ("solved at 80 ratios", 'The method is "fronts".', "to 12 digits"):
        assert fact in notes
        assert fact not in top


@pytest.mark.exhaustive
def test_a_question_is_explained_where_it_is_written(visit):
    """The text field of the question is described, for screen readers, by a text on the
    page.
    """
    page = visit()
    open_menu(page)
    page.click("#ask")
    described = page.locator("#question").get_attribute("aria-describedby")
    assert "for your class" in page.inner_text(f"#{described}")


# The layout


LESSONS = {
    "two rigid rods": PRESETS["unequal"].system,
    "two Hertz rods": HERTZ,
    "rod, rod and wall": ri.System(
        [steel_rod(0.5, 1.0), steel_rod(1.0), ri.Wall()],
        contacts=[ri.Spring(1e8), ri.Spring(1e8)],
    ),
    "chain of five": PRESETS["chain"].system,
}
INPUTS = (
    LENGTH,
    "bodies.0.velocity",
    "contacts.0.law",
    "bodies.1.length",
    "bodies.1.velocity",
)


def show_case(page, case):
    """Let a page show a case, and wait until it is solved in full."""
    page.evaluate("(design) => showDesign(design)", tables_of(with_gauges(case)))
    page.wait_for_function(f"{DRAWN} && !page.isDraft")


def hidden_parts(page, selectors):
    """Those selectors whose first element has no width, is not wholly on the screen, or
    is covered in the middle of its upper edge.
    """
    return page.evaluate(
        """(selectors) => selectors.filter((selector) => {
            const element = document.querySelector(selector);
            const { left, top, right, bottom, width } = element.getBoundingClientRect();
            const isAcross = left >= 0 && right <= innerWidth;
            const isInside = isAcross && top >= 0 && bottom <= innerHeight;
            // The uppermost element just below the middle of the upper edge.
            const upmost = document.elementFromPoint((left + right) / 2, top + 4);
            // It may be a part of the element, or, as for a disabled one, a box around.
            const isOpen =
                upmost && (element.contains(upmost) || upmost.contains(element));
            return !(width > 0 && isInside && isOpen);
        })""",
        list(selectors),
    )


@pytest.mark.parametrize(
    ("width", "height"),
    [pytest.param(1440, 900, marks=pytest.mark.exhaustive), (1024, 768)],
)
def test_inputs_e_and_reason_are_on_the_first_screen(visit, width, height):
    """In a window of this size, each of `LESSONS` shows its inputs, e or velocities,
    and the reason, without scrolling.
    """
    page = visit(viewport={"width": width, "height": height})
    for name, system in LESSONS.items():
        show_case(page, ri.Case(system))
        result = "#after"  # the velocities, where there is no e
        if page.evaluate("page.scene.restitution.value !== null"):
            result = "#restitution"
        inputs = [f"[id='{path}']" for path in INPUTS]
        assert hidden_parts(page, [*inputs, result, "#reason"]) == [], name
        assert page.evaluate("scrollY") == 0


@pytest.mark.parametrize(
    ("width", "height"),
    [pytest.param(1440, 900, marks=pytest.mark.exhaustive), (1024, 768)],
)
def test_the_law_of_a_contact_stands_beside_its_name(visit, width, height):
    """In a window of this size, the law of each of two contacts is to the right of its
    name, on the same line.
    """
    page = visit(viewport={"width": width, "height": height})
    show_case(page, ri.Case(LESSONS["rod, rod and wall"]))
    lines = page.locator(".contact").evaluate_all("""all => all.map((block) => {
        const [name, law] = ["legend", "select"].map((part) =>
            block.querySelector(part).getBoundingClientRect());
        return [name.right, law.left, name.top < law.bottom && law.top < name.bottom];
    })""")
    assert len(lines) == 2
    for name_right, law_left, is_same_line in lines:
        assert name_right <= law_left
        assert is_same_line


@pytest.mark.parametrize(
    ("width", "height"),
    [pytest.param(1440, 900, marks=pytest.mark.exhaustive), (1024, 768)],
)
def test_other_colours_leave_the_pictures_where_they_are(visit, width, height):
    """Colours of stress in place of velocity: the rods stay at their place, and the
    buttons stay within the bar.
    """
    page = visit(viewport={"width": width, "height": height})
    show_case(page, ri.Case(LESSONS["rod, rod and wall"]))
    before = page.locator("#rods").bounding_box()

    page.check("input[value=stress]")

    sync_api.expect(page.locator("#least")).to_contain_text("MPa, compressed")
    assert page.locator("#rods").bounding_box() == before
    # The longer legend does not push the buttons out of the bar.
    bar = page.locator(".bar").bounding_box()
    zoom = page.locator("#zoom-all").bounding_box()
    assert zoom["x"] + zoom["width"] <= bar["x"] + bar["width"] + 1


@pytest.mark.exhaustive
def test_the_sentence_keeps_its_height_in_a_tour(visit):
    """At each step of the tour, the sentence is as high as before it."""
    page = visit(viewport={"width": 1440, "height": 900})
    sentence = page.locator("#sentence")
    before = sentence.bounding_box()["height"]
    page.click("#tour-open")
    for _ in range(5):
        page.click("#tour-next")
        page.wait_for_function(TOUR_STEP_SHOWN)
        page.wait_for_function("() => !page.isRedrawDue")
        assert sentence.bounding_box()["height"] == before


@pytest.mark.parametrize(
    "name", few_of(["two rigid rods", "two Hertz rods"], ["two Hertz rods"])
)
def test_a_phone_shows_inputs_and_e_at_once_and_the_reason_below_them(
    visit, solved, name
):
    """On a screen of 390 x 844, inputs, e and the play button are visible at once, and
    the reason begins less than 60 pixels below the last input.
    """
    page = visit(solved(LESSONS[name]), viewport={"width": 390, "height": 844})
    inputs = [f"[id='{path}']" for path in INPUTS]
    assert hidden_parts(page, [*inputs, "#restitution", "#play"]) == []
    last_input = field(page, "bodies.1.velocity").bounding_box()
    reason = page.locator("#reason").bounding_box()
    assert reason["y"] < last_input["y"] + 60  # pixels


@pytest.mark.exhaustive
def test_tools_stand_in_one_row_on_the_narrowest_phone(visit):
    """At a width of 360 pixels the top edges of all five visible tools are at the same
    height.
    """
    page = visit(viewport={"width": 360, "height": 700})
    tops = page.evaluate("""() => [...document.querySelectorAll(".tools > *")]
        .filter((element) => element.getClientRects().length)
        .map((element) => Math.round(element.getBoundingClientRect().top))""")
    assert len(tops) == 5
    assert len(set(tops)) == 1


def test_the_page_opens_still_at_the_start(visit):
    """The page opens at the start of its film, before contact, and does not play."""
    page = visit()
    assert page.evaluate("currentTime() === page.scene.begin")
    assert not page.evaluate("page.isPlaying")
    assert page.evaluate("page.scene.begin") < 0  # s, before the first contact
    assert page.inner_text("#play") == "Play"


def random_row(rng):
    """A row of rods and masses, maybe beside a wall, in rigid and compliant contact."""
    bodies = []
    for _ in range(rng.integers(1, 4)):
        velocity = float(rng.uniform(-3, 3))
        if rng.random() < 0.75:
            bodies.append(steel_rod(float(rng.uniform(0.1, 1.5)), velocity))
        else:
            bodies.append(ri.RigidMass(float(rng.uniform(0.1, 3)), velocity=velocity))
    # One body at least is a rod.
    bodies.insert(int(rng.integers(0, len(bodies) + 1)), steel_rod(0.5, 2.0))
    if rng.random() < 0.4:
        bodies.append(ri.Wall())
    if rng.random() < 0.2:
        bodies.insert(0, ri.Wall())
    laws = []
    gaps = []
    for left, right in itertools.pairwise(bodies):
        choices = [ri.Rigid(), ri.Spring(1e8), ri.Hertz(1e10)]
        first_choice = 1  # no wave decides a rigid contact of masses
        if isinstance(left, ri.Rod) or isinstance(right, ri.Rod):
            first_choice = 0
        laws.append(choices[rng.integers(first_choice, 3)])
        gaps.append(float(rng.choice([0.0, 2e-4])))
    return ri.System(bodies, contacts=laws, gaps=gaps)


OUTSIDE = """(design) => {
    const { case: tables, gauges } = design;
    const scene = prepareScene(solver.scene_of(tables, gauges, embedded.materials, 1e-4));
    const before = { scene: page.scene, isDisplaced: page.isDisplaced };
    page.scene = scene;
    const outside = [];
    for (const isDisplaced of [true, false]) {
        page.isDisplaced = isDisplaced;
        const view = wholeView(scene);
        for (let k = 0; k <= 20; k += 1) {
            const t = scene.begin + ((scene.end - scene.begin) * k) / 20;
            for (const [i, [low, high]] of endsAt(scene, t, { view, isDisplaced })) {
                const isWall = scene.bodies[i].kind === "wall";
                const left = isWall && i === 0 ? high : low;  // the face of a wall
                const right = isWall && i > 0 ? low : high;
                if (left < view.left || right > view.right) outside.push([i, t]);
            }
        }
    }
    Object.assign(page, before);
    return outside;
}"""
"""Bodies that are not inside the picture of a design, with the times."""


@pytest.mark.exhaustive
def test_all_bodies_of_random_rows_are_inside_the_picture_at_all_times(visit):
    """For 50 random rows, the page names no body outside of the picture at any time."""
    page = visit()
    rng = np.random.default_rng(43)
    for _ in range(50):
        case = with_gauges(ri.Case(random_row(rng), {"max_events": 300}))
        design = tables_of(case)
        assert page.evaluate(OUTSIDE, design) == [], design


@pytest.mark.exhaustive
def test_escape_ends_the_tour_and_gives_all_back(visit):
    """The tour is left with Escape at its second step: length, time of the film and
    focus are as they were before it.
    """
    page = visit()
    field(page, LENGTH).fill("700")
    wait_for_e(page, "0.7")
    page.locator("#time").fill("640")
    page.click("#tour-open")
    sync_api.expect(page.locator("#tour-text")).to_contain_text("1 of 6")
    page.click("#tour-next")
    page.wait_for_function(TOUR_STEP_SHOWN)
    assert page.input_value("#preset") == "identical"

    page.keyboard.press("Escape")

    wait_for_e(page, "0.7")
    page.wait_for_function(f"{TOUR_STEP_SHOWN} && !page.isRedrawDue")
    assert field(page, LENGTH).input_value() == "700"
    assert page.evaluate("page.fraction") == pytest.approx(0.64)
    assert page.evaluate("document.activeElement.id") == "tour-open"
    assert not page.locator("#tour").is_visible()


def test_an_arrow_is_dragged_and_undone(visit):
    """Dragging the tips of the arrows changes the velocities of both rods by the scale
    of the picture; two undos bring both back.
    """
    page = visit()
    page.locator("#time").fill("0")
    stop_clock(page)
    tip_of_first = "[page.strip.arrows[0].tip, page.strip.arrows[0].y]"
    tip_of_second = "[page.strip.arrows[1].tip, page.strip.arrows[1].y]"
    speed_per_pixel = page.evaluate("1 / page.arrowScale")  # m/s

    drag(page, tip_of_first, 40)
    first_velocity = number_in(page, "bodies.0.velocity")
    assert first_velocity == pytest.approx(1 + 40 * speed_per_pixel, abs=0.06)

    drag(page, tip_of_second, -20)
    second_velocity = number_in(page, "bodies.1.velocity")
    assert second_velocity < 0
    sync_api.expect(page.locator("#sentence")).to_contain_text(
        f"rod 2 moves at \u2212{-second_velocity:g}"
    )

    page.click("#undo")
    page.click("#undo")
    assert field(page, "bodies.0.velocity").input_value() == "1"
    assert field(page, "bodies.1.velocity").input_value() == "0"


HANDLES = [
    "Velocity of rod 1",
    "Length of rod 1",
    "Velocity of rod 2",
    "Length of rod 2",
]
"""Names of the handles of two rods, in the order of the Tab key."""


def handle(page, name):
    """A handle of the diagram, by its name."""
    return page.locator("#handles [role=slider]").nth(HANDLES.index(name))


def test_ends_and_arrows_are_moved_by_keys(visit):
    """Arrow and page keys on the handles change length and velocity; e, the value that
    is read aloud, and the focus follow. The handles have the names `HANDLES`.
    """
    page = visit()
    page.locator("#time").fill("0")
    page.wait_for_function("() => !page.isRedrawDue")
    handles = page.locator("#handles [role=slider]")
    assert handles.evaluate_all("all => all.map((one) => one.ariaLabel)") == HANDLES

    length = handle(page, "Length of rod 1")
    length.focus()
    page.keyboard.press("ArrowRight")  # 1 mm more
    page.keyboard.press("PageUp")  # 10 mm more
    assert field(page, LENGTH).input_value() == "411"
    wait_for_e(page, "0.411")
    assert length.get_attribute("aria-valuetext") == "411 mm"
    assert page.evaluate("document.activeElement.ariaLabel") == "Length of rod 1"

    handle(page, "Velocity of rod 2").focus()
    page.keyboard.press("ArrowLeft")
    assert field(page, "bodies.1.velocity").input_value() == "-0.1"


def test_handles_lie_on_ends_and_arrows_while_the_set_up_is_seen(visit):
    """At time 0 the handles of length and velocity of rod 2 lie on its end and on the
    tip of its arrow, to a pixel; later in the film there are none.
    """
    page = visit()
    field(page, "bodies.1.velocity").fill("-0.1")
    page.locator("#time").fill("0")
    page.wait_for_function(DRAWN)
    # Middles of the handles, and what they move, [x, y] in pixels of the strip of rods.
    middles = page.locator("#handles > *").evaluate_all("""all => all.map((one) => {
        const { left, width, top, height } = one.getBoundingClientRect();
        const origin = byId("rods").getBoundingClientRect();
        return [left + width / 2 - origin.left, top + height / 2 - origin.top];
    })""")
    tip = page.evaluate("[page.strip.arrows[1].tip, page.strip.arrows[1].y]")
    end = page.evaluate(
        "[page.strip.frame.across(page.strip.ends.get(1)[1]), page.strip.middle]"
    )
    assert middles[HANDLES.index("Velocity of rod 2")] == pytest.approx(tip, abs=1)
    assert middles[HANDLES.index("Length of rod 2")] == pytest.approx(end, abs=1)

    page.locator("#time").fill("500")
    page.wait_for_function("() => !page.isRedrawDue")
    assert page.locator("#handles [role=slider]").count() == 0


def lines_drawn(page, statement):
    """[[colour, points], ...] of the lines that pens draw in a JavaScript statement."""
    return page.evaluate(f"""() => {{
        const lines = [];
        const {{ line }} = CanvasPen.prototype;
        CanvasPen.prototype.line = function (points, colour, ...rest) {{
            lines.push([colour, points]);
            line.call(this, points, colour, ...rest);
        }};
        {statement};
        CanvasPen.prototype.line = line;
        return lines;
    }}""")


@pytest.mark.exhaustive
def test_the_force_stands_beside_the_diagram_on_its_time_axis(visit):
    """The lines that the page draws are recorded: one line marks the current time in
    diagram and force, and the force begins and ends at the heights of these times and
    fills its width.
    """
    page = visit()
    page.locator("#time").fill("300")
    page.wait_for_function("() => !page.isRedrawDue")
    lines = lines_drawn(page, "draw()")
    frame_left = page.evaluate("page.frame.x")
    force = page.evaluate("({ ...page.frame.force })")
    red, blue = page.evaluate("[page.theme.accent, page.theme.series[0]]")
    lines_of_time = []
    curves_of_force = []
    for colour, points in lines:
        x = points[0][0]
        if colour == red and x == frame_left:
            lines_of_time.append(points)
        if colour == blue and x >= force["x"]:
            curves_of_force.append(points)
    # One line for the current time crosses both.
    _, end_of_line = lines_of_time[0]
    assert end_of_line[0] == force["right"]
    # The force begins and ends at the heights of these times in the diagram.
    force_end = 2 * 0.4 / ri.materials.steel.wave_speed
    heights = page.evaluate("(times) => times.map(page.frame.up)", [0, force_end])
    curve = np.array(curves_of_force[0])  # [point, (x, y)], pixels
    for height in heights:
        assert np.abs(curve[:, 1] - height).min() < 0.01
    peak = np.ptp(curve[:, 0])
    assert peak > 0.8 * (force["right"] - force["x"])


def test_a_chain_is_told_contact_by_contact_and_two_rods_are_not(visit):
    """The preset of a chain shows a table with impulse, peak force and duration of each
    contact, those of `solve`; for two rods this table is hidden.
    """
    page = visit()
    page.select_option("#preset", "chain")
    rows = page.locator("#by-contact tbody tr")
    sync_api.expect(rows).to_have_count(4)
    outcome = ri.solve(PRESETS["chain"].system).outcome
    for k, contact in enumerate(outcome.contacts):
        cells = rows.nth(k).locator("th, td").all_inner_texts()
        assert [text.replace("\u00a0", " ") for text in cells] == [
            f"{k + 1}-{k + 2}",
            f"{1e3 * contact.impulse:.5g} mN s",
            f"{1e-3 * contact.peak_force:.5g} kN",
            f"{1e6 * contact.duration:.5g} µs",
        ]
    assert page.locator("#results tr").count() == 7  # five velocities, two energies
    page.select_option("#preset", "unequal")
    sync_api.expect(page.locator("#by-contact")).to_be_hidden()


@pytest.mark.exhaustive
def test_a_label_without_room_is_left_out_and_the_others_stay(visit, solved):
    """On a small screen, the texts that are drawn name rod 3, and not the short rod 2."""
    short = ri.System([steel_rod(0.05, 1.0), steel_rod(0.05), steel_rod(1.0)])
    page = visit(solved(short), viewport={"width": 390, "height": 844})
    page.locator("#time").fill("0")
    page.wait_for_function("() => !page.isRedrawDue")
    texts = page.evaluate("""() => {
        const texts = [];
        const { text } = CanvasPen.prototype;
        CanvasPen.prototype.text = function (x, y, said, look) { texts.push(said); };
        drawRods(new CanvasPen(byId("rods")), page.scene, page, currentTime(), page.theme);
        CanvasPen.prototype.text = text;
        return texts;
    }""")
    assert "Rod 3, 0\u00a0m/s" in texts
    assert not any(text.startswith("Rod 2,") for text in texts)


def ask_question(page):
    """Type a question above the page, and move the film away from its start."""
    open_menu(page)
    page.click("#ask")
    page.locator("#question").fill("What happens?")
    page.locator("#time").fill("700")


def show_as_printed(page):
    """Let a page look as on paper, and wait until it is drawn."""
    page.emulate_media(media="print")
    page.wait_for_function("() => page.isPrinting && !page.isRedrawDue")


def test_a_lesson_on_paper_has_question_set_up_pictures_and_reason(visit):
    """A printed question shows, from top to bottom, question, set-up in words, rods
    with arrows, diagram and plots, and the reason; plots are as wide as their columns.
    """
    page = visit(viewport={"width": 1280, "height": 800})

    ask_question(page)
    show_as_printed(page)

    # The rods are those of the set-up, with an arrow each, whatever the film shows.
    assert page.evaluate("page.strip.arrows.length") == 2
    tops = []
    for part in ("#question", "#given", "#rods", "#diagram", "#plots"):
        tops.append(page.locator(part).bounding_box()["y"])
    assert tops == sorted(tops)
    beginning = "Rod 1: 400 mm long, 100 mm², steel; 1 m/s. Contact 1-2: ri"
    assert text_of(page, "#given").startswith(beginning)
    assert page.locator("#reason").is_visible()
    assert not page.locator("#lines").is_visible()
    widths = page.locator("#plots canvas").evaluate_all(
        "all => all.map((one) => [one.clientWidth, one.parentElement.clientWidth])"
    )
    assert widths
    for width, width_of_column in widths:
        assert width == width_of_column


@pytest.mark.exhaustive
def test_a_lesson_on_paper_before_a_guess_has_lines_to_write_on_and_no_answer(visit):
    """A question printed before the guess shows more than 8 lines, question, rods and
    diagram, and neither reason, facts, plots, e nor buttons.
    """
    page = visit(viewport={"width": 1280, "height": 800})

    ask_question(page)
    page.click("#guess-first")
    show_as_printed(page)

    assert page.locator("#lines p").count() > 8
    for part in ("#lines", "#question", "#asked", "#rods", "#diagram"):
        assert page.locator(part).is_visible(), part
    for part in ("#reason", "#facts", "#plots", ".restitution", "#notes", "button"):
        assert not page.locator(part).first.is_visible(), part


def test_velocities_shown_are_those_of_the_api(visit):
    """Twelve random rows: the page is final where `solve` is, and shows its velocities
    after, rounded to 6 digits, or 4 for smooth waves. If not final, the name says "at
    the end".
    """
    rng = np.random.default_rng(3)
    page = visit()
    for _ in range(12):
        system = random_row(rng)
        options = {"max_events": 1000}
        show_case(page, ri.Case(system, options))
        outcome = ri.solve(system, **options).outcome
        name, _ = page.evaluate("page.scene.results[0]")
        assert page.evaluate("page.scene.final") == outcome.final
        if not outcome.final:
            assert name.endswith(" at the end")
            continue
        assert name.endswith(" after")
        digits = 4
        if page.evaluate("page.scene.method") == "fronts":
            digits = 6
        shown = page.evaluate("page.scene.velocities.map(({ value }) => Number(value))")
        rounded = []
        for kind, v in zip(outcome.bodies, outcome.velocities_after, strict=True):
            if kind != "wall":
                rounded.append(float(f"{v:.{digits}g}"))
        fastest = np.abs([*outcome.velocities_before, *rounded]).max()
        assert shown == pytest.approx(rounded, rel=1e-12, abs=1e-12 * fastest), system


HOLDER = """<!DOCTYPE html><html data-frames="1"><body><script>
window.sent = [];
const values = { page: PAGE, case: "" };
const model = {
    get: (key) => values[key],
    set: (key, value) => { values[key] = value; },
    save_changes: () => sent.push(values.case),
};
import("data:text/javascript," + encodeURIComponent(WIDGET)).then(({ default: widget }) => {
    window.close_output = widget.render({ model, el: document.body });
});
</script></body></html>"""


def test_a_notebook_is_told_what_the_sliders_say_but_no_mistake(visit, tmp_path):
    """A page stands in a notebook. Of three lengths that are typed, the negative one is
    not sent as a case; the last text sent is the design, and an undo sends an empty
    text.
    """
    # A "<" would end the script in which the page stands.
    html = json.dumps(ri.explore(HERTZ).html).replace("<", "\\u003c")
    widget = json.dumps(read("notebook.js"))
    path = tmp_path / "holder.html"
    path.write_text(
        HOLDER.replace("WIDGET", widget).replace("PAGE", html), encoding="utf-8"
    )
    page = visit(path.as_uri())
    inside = page.frame_locator("iframe")
    sync_api.expect(inside.locator("#results")).to_contain_text("velocity of rod 2")
    stop_clock(page.frames[1])
    length = inside.locator(f'[id="{LENGTH}"]')
    length.fill("700")
    length.fill("-3")
    sync_api.expect(inside.locator(".problem:not(:empty)")).to_have_count(1)
    length.fill("650")
    page.wait_for_function("() => sent.length && sent.at(-1).includes('0.65')")

    texts = page.evaluate("sent")
    for text in texts:
        if text:
            first_body = text.split("[[bodies]]")[1]
            assert "-" not in first_body
    assert ri.parse_case(texts[-1]).system == with_first_length(HERTZ, 0.65)
    # An empty text stands for the design with which the page began.
    inside.locator("#undo").click()
    page.wait_for_function("() => sent.at(-1) === ''")
