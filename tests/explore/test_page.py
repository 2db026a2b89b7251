"""The page in a browser: what a person sees and does."""

import itertools
import json
import os
import re
import shutil
import tomllib
from pathlib import Path

import numpy as np
import pytest

import rodimpact as ri
from rodimpact.explorer.design import tables_of, with_gauges
from rodimpact.explorer.page_files import read
from rodimpact.explorer.presets import presets

sync_api = pytest.importorskip(
    "playwright.sync_api", reason="playwright is not installed: pip install playwright"
)
BROWSER = os.environ.get("CHROMIUM") or next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))),
    None,
)
PRESETS = {preset.key: preset.case for preset in presets()}
LENGTH = "bodies.0.length"
CONTROLS = "button, input, select, canvas"
sync_api.expect.set_options(timeout=20_000)  # ms


@pytest.fixture(scope="module")
def browser():
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
    """Writes the page of a system; its address."""

    def write(system, **solve):
        path = tmp_path / f"page-{len([*tmp_path.iterdir()])}.html"
        ri.explore(ri.Case(system, solve)).save(path)
        return path.as_uri()

    return write


@pytest.fixture
def visit(browser, url):
    """Opens addresses without a network; afterwards nothing may have gone wrong or been
    asked.
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
    return page.locator(f'[id="{path}"]')


def slider(page, path):
    return page.locator(f'[data-slides="{path}"]')


def wait_for_e(page, text):
    sync_api.expect(page.locator("#restitution")).to_have_text(text)


def shown_e(outcome):
    return f"{outcome.restitution:.6g}"


def pair(length):
    steel = ri.materials.steel
    left = ri.Rod(length, area=1e-4, material=steel, velocity=1.0)
    return ri.collide(left, ri.Rod(1.0, area=1e-4, material=steel))


def unfold(page, part):
    """Open what the form keeps folded of a body, of a contact or of the gauges."""
    page.click(f'[aria-controls="rest:{part}"]')


def open_menu(page):
    page.click("#menu summary")


def stop_clock(page):
    """Let no time pass for a page or a frame: undo takes back changes without a
    pause.
    """
    page.evaluate("performance.now = () => 0")


def picture(page, canvas="#diagram"):
    return page.locator(canvas).evaluate("canvas => canvas.toDataURL()")


def test_dragging_a_slider_moves_e_as_the_api_does(visit):
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
    length = float(field(page, LENGTH).input_value())
    assert length not in (0.0, 400.0)
    wait_for_e(page, shown_e(pair(length / 1000)))
    assert picture(page) != before
    assert page.input_value("#preset") == ""


def rods_at(page, thousandths):
    """Left and right end of every rod in the picture, at a thousandth of the film."""
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
    before = rods_at(page, 999)
    last = rods_at(page, 1000)
    assert last.keys() == before.keys()
    for body, ends in last.items():
        assert ends == pytest.approx(before[body], abs=0.01)


def test_presets_show_their_collisions_to_the_end(visit):
    page = visit()
    for key, preset in PRESETS.items():
        page.select_option("#preset", key)
        page.wait_for_function("() => !page.isSceneDue && !page.isRedrawDue")
        outcome = ri.solve(preset.system).outcome
        wait_for_e(page, "-" if outcome.why_no_restitution() else shown_e(outcome))
        last = f"{outcome.velocities_after[-1]:.6g} m/s".replace("-0 ", "0 ")
        if outcome.bodies[-1] == "rod":
            rows = page.locator("#results tr").all_inner_texts()
            assert any(row.endswith(last) for row in rows)
        assert page.locator("#controls fieldset").count() == 2 * len(outcome.bodies)
        assert_the_film_ends_with_its_rods(page)


def test_curves_of_the_collision_before_are_not_solved_for_the_next(visit):
    page = visit()
    page.evaluate("""async () => {
        designChanged(true);
        await new Promise(requestAnimationFrame);
        const frame = requestAnimationFrame;  // slower than the wait for sliders that rest
        window.requestAnimationFrame = (draw) => setTimeout(frame, 400, draw);
        showDesign(embedded.presets.find(({ key }) => key === "chain").design);
    }""")
    page.wait_for_function("() => page.scene.bodies.length > 2")


def test_material_can_be_chosen(visit):
    page = visit()
    unfold(page, "bodies.1")
    page.select_option('[id="bodies.1.material"]', "aluminium")
    aluminium = ri.Rod(1.0, area=1e-4, material=ri.materials.aluminium)
    left = PRESETS["unequal"].system.bodies[0]
    wait_for_e(page, shown_e(ri.collide(left, aluminium)))
    page.select_option('[id="bodies.1.material"]', "own 2")
    field(page, "materials.own 2.youngs_modulus").fill("50")
    material = ri.Material("own", youngs_modulus=50e9, density=2698.0)
    outcome = ri.collide(left, ri.Rod(1.0, area=1e-4, material=material))
    wait_for_e(page, shown_e(outcome))


def test_a_mistake_is_told_beside_its_field_in_its_unit_and_mended(visit):
    page = visit()
    field(page, LENGTH).fill("-5")
    problem = page.locator(f'[id="problem:{LENGTH}"]')
    sync_api.expect(problem).to_have_text(
        "must be a finite positive number, got \u22125 mm"
    )
    assert field(page, LENGTH).get_attribute("aria-invalid") == "true"
    for part in (".restitution", "#facts", "#reason"):  # numbers of another collision
        assert not page.locator(part).is_visible()
    field(page, LENGTH).fill("500")
    wait_for_e(page, "0.5")
    sync_api.expect(problem).to_be_empty()


def test_negative_numbers_have_one_minus_sign(visit):
    page = visit()
    field(page, "bodies.0.velocity").fill("-1")
    field(page, "bodies.1.velocity").fill("-3")
    sync_api.expect(page.locator("#results")).to_contain_text("\u22123 m/s")
    assert re.findall(r"[\s(]-\d", page.inner_text("main")) == []  # no hyphens


def test_a_view_can_be_shared(visit):
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
    pictures = (picture(page), picture(page, "#rods"))
    again = visit(page.url)
    wait_for_e(again, "0.3")
    assert again.inner_text("#question") == "How long & why?"
    assert again.is_checked("input[value=stress]")
    assert (picture(again), picture(again, "#rods")) == pictures


def test_play_pause_and_scrub(visit):
    page = visit(reduced_motion="reduce")
    page.select_option("#pace", "4")
    page.locator("#time").fill("0")
    start = picture(page, "#rods")
    page.click("#play")
    page.wait_for_timeout(400)
    page.click("#play")
    moved = float(page.input_value("#time"))
    assert 0 < moved < 1000
    assert picture(page, "#rods") != start
    page.wait_for_timeout(200)
    assert float(page.input_value("#time")) == moved


READING = re.compile(
    r"t = (\S+) (µ?)s: Rod (\d), x = (\S+) (m?)m .*velocity (\S+) (m?)m/s, stress (\S+)"
)
PREFIXES = {"": 1.0, "m": 1e-3, "µ": 1e-6}


def test_pointing_reads_the_value_of_the_solution(visit):
    page = visit()
    solution = ri.solve(PRESETS["unequal"].system)
    box = page.locator("#diagram").bounding_box()
    n_readings = 0
    for across, up in ((0.3, 0.7), (0.5, 0.6), (0.6, 0.3), (0.7, 0.5), (0.35, 0.2)):
        page.mouse.move(box["x"] + across * box["width"], box["y"] + up * box["height"])
        page.wait_for_timeout(60)
        text = page.inner_text("#readout").replace("\u00a0", " ").replace("\u2212", "-")
        reading = READING.match(text)
        if reading is None:
            assert "no rod here" in text
            continue
        n_readings += 1
        t = float(reading[1]) * PREFIXES[reading[2]]
        x = float(reading[4]) * PREFIXES[reading[5]]
        v = float(reading[6]) * PREFIXES[reading[7]]
        velocity = solution.velocity(int(reading[3]) - 1, x, t).item()
        assert v == pytest.approx(velocity, abs=1e-9)
    assert n_readings >= 3


def turn_the_wheel_on_the_diagram(page):
    page.hover("#diagram")
    page.mouse.wheel(0, -400)
    page.mouse.move(0, 0)
    page.wait_for_timeout(60)


def test_zoom_by_wheel_buttons_and_keys(visit):
    page = visit()
    page.mouse.move(0, 0)
    whole = picture(page)
    page.click("#zoom-in")
    page.wait_for_timeout(60)
    assert picture(page) != whole
    page.click("#zoom-all")
    page.wait_for_timeout(60)
    assert picture(page) == whole
    page.locator("#diagram").focus()
    page.keyboard.press("+")
    page.keyboard.press("Shift+ArrowRight")
    page.wait_for_timeout(60)
    assert picture(page) != whole
    page.keyboard.press("0")
    page.keyboard.press("ArrowUp")
    sync_api.expect(page.locator("#readout")).to_contain_text("velocity")
    page.keyboard.press("Escape")
    page.wait_for_timeout(60)
    assert picture(page) == whole
    turn_the_wheel_on_the_diagram(page)
    assert picture(page) == whole  # the page scrolls
    page.keyboard.down("Control")
    turn_the_wheel_on_the_diagram(page)
    page.keyboard.up("Control")
    assert picture(page) != whole


def test_files_can_be_taken_away(visit, tmp_path):
    page = visit()
    field(page, LENGTH).fill("350")
    wait_for_e(page, "0.35")
    open_menu(page)
    with page.expect_download() as download:
        page.click("#save-case")
    download.value.save_as(tmp_path / "case.toml")
    case = ri.read_case(tmp_path / "case.toml")
    assert case.system.bodies[0].length == 0.35
    assert case.gauges == PRESETS["unequal"].gauges
    assert tomllib.loads((tmp_path / "case.toml").read_text())["schema"] == 1
    open_menu(page)
    with page.expect_download() as download:
        page.click("#save-svg")
    download.value.save_as(tmp_path / "picture.svg")
    text = (tmp_path / "picture.svg").read_text(encoding="utf-8")
    assert text.startswith("<svg xmlns=")
    (tmp_path / "holder.html").write_text(
        '<html data-frames="1"><img src="picture.svg"></html>'
    )
    holder = visit((tmp_path / "holder.html").as_uri())
    assert holder.evaluate("document.images[0].decode().then(() => true)")


@pytest.mark.parametrize("width", [360, 1280])
def test_nothing_sticks_out(visit, width):
    page = visit(viewport={"width": width, "height": 800})
    for key in ("unequal", "chain"):
        page.select_option("#preset", key)
        page.wait_for_timeout(200)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        outside = page.evaluate(f"""() => [...document.querySelectorAll("{CONTROLS}")]
            .filter((e) => e.getClientRects().length).filter((e) => {{
                const r = e.getBoundingClientRect();
                return r.left < -1 || r.right > innerWidth + 1;
            }}).map((e) => e.id)""")
        assert outside == []


def test_every_control_has_a_name_and_takes_the_focus(visit):
    page = visit()
    unnamed = page.evaluate(f"""() => [...document.querySelectorAll("{CONTROLS}")]
        .filter((e) => !(e.labels && e.labels.length) && !e.ariaLabel && !e.textContent.trim()
                       && !e.getAttribute("aria-labelledby"))
        .map((e) => e.outerHTML)""")
    assert unnamed == []
    seen = set()
    for _ in range(40):
        page.keyboard.press("Tab")
        seen.add(
            page.evaluate("document.activeElement.id || document.activeElement.name")
        )
        if page.evaluate("document.activeElement.matches('#menu summary')"):
            page.keyboard.press("Enter")
    assert {"preset", "theme", "quantity", "diagram", "play", "time", LENGTH} <= seen


HERTZ = ri.System(PRESETS["unequal"].system.bodies, contacts=[ri.Hertz(1e10)])


def test_a_spring_keeps_the_faces_apart_and_the_film_begins_before_contact(
    visit, solved
):
    page = visit(solved(HERTZ))
    for share in range(0, 1001, 100):
        ends = rods_at(page, share)
        assert ends[0][1] < ends[1][0]
    page.locator("#time").fill("0")
    assert page.evaluate("currentTime()") < 0
    assert page.evaluate(
        "page.scene.centres.every(({ t }) => t[0] === page.scene.begin)"
    )
    sync_api.expect(page.locator("#sentence")).to_contain_text("Rod 1 moves at 1")
    assert page.evaluate(
        "page.scene.grids.map((g) => g.rows * g.across).reduce((a, b) => a + b)"
        " === page.scene.cellCount"
    )


def test_a_sentence_follows_the_events(visit):
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
    T = 0.4 / ri.materials.steel.wave_speed
    assert page.evaluate("currentTime()") == pytest.approx(2 * T, rel=1e-6)
    page.click("#event-before")
    sync_api.expect(sentence).to_contain_text("turns back")
    spot = page.evaluate(
        "({ x: page.frame.x, y: page.frame.up(page.scene.events[1].t) })"
    )
    page.locator("#diagram").click(position=spot)
    sync_api.expect(sentence).to_contain_text("meet")
    page.click("#all-events summary")
    page.locator("#events button").last.click()
    sync_api.expect(sentence).to_contain_text("rod 2 has 0.4 m/s on average")
    sync_api.expect(page.locator("#reason")).to_contain_text(
        "touch without force until they part"
    )


TELLING = (
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


def test_a_guess_comes_before_e(visit):
    page = visit()
    whole = picture(page)
    page.click("#guess-first")
    assert [where for where in TELLING if page.locator(where).is_visible()] == []
    question = page.locator("#asked")
    sync_api.expect(question).to_contain_text(
        "rod 2 is at rest. How fast do they part, as a share of"
    )
    assert question.inner_text().count("?") == 1
    page.wait_for_timeout(60)
    hidden = picture(page)
    field(page, LENGTH).fill("900")
    wait_for_e(page, "0.9")
    field(page, LENGTH).fill("400")
    wait_for_e(page, "0.4")
    page.wait_for_timeout(60)
    assert hidden != whole
    assert picture(page) == hidden


def guess(page, number):
    page.click("#guess-first")
    page.locator("#guessed").fill(number)
    page.keyboard.press("Enter")


def test_a_guess_is_judged_and_the_replay_begins(visit):
    page = visit()
    guess(page, "0.7")
    verdict = page.locator("#verdict")
    sync_api.expect(verdict).to_contain_text("You said 0.7; e is 0.4: off by 0.3.")
    for words in ("Rod 1's wave returns", "The impulse of 314", "so e = 0.4 = l₁/l₂"):
        sync_api.expect(page.locator("#reason")).to_contain_text(words)
    assert page.evaluate("page.isPlaying")
    assert page.evaluate("currentTime() < 0.2 * page.scene.end")
    assert page.evaluate("document.activeElement.id") == "play"
    assert page.locator("#restitution").is_visible()


def test_a_verdict_goes_with_the_e_that_was_guessed(visit):
    page = visit()
    guess(page, "0.7")
    verdict = page.locator("#verdict")
    sync_api.expect(verdict).to_contain_text("You said 0.7")
    field(page, LENGTH).fill("700")
    wait_for_e(page, "0.7")
    assert verdict.inner_text() == ""


def test_the_question_is_about_the_row_that_is_chosen(visit):
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


@pytest.mark.parametrize(("width", "height"), [(1024, 768), (390, 844)])
def test_e_and_its_curve_are_seen_beside_the_picture_while_any_slider_moves(
    visit, width, height
):
    page = visit(viewport={"width": width, "height": height})
    for part in ("bodies.0", "contacts.0", "bodies.1", "gauges"):
        unfold(page, part)
    sliders = page.locator("#controls input[type=range]")
    assert sliders.count() == 8
    for k in range(sliders.count()):
        sliders.nth(k).scroll_into_view_if_needed()
        boxes = [
            page.locator(w).bounding_box()
            for w in (".restitution", "#curve", "#diagram")
        ]
        slid = sliders.nth(k).bounding_box()
        for box in (*boxes, slid):
            assert box["y"] >= 0
            assert box["y"] + box["height"] <= height + 1
        there = page.evaluate(
            "([x, y]) => document.elementFromPoint(x, y).id",
            [slid["x"] + slid["width"] / 2, slid["y"] + slid["height"] / 2],
        )
        assert there.startswith("slider:"), k  # nothing covers it
    e, curve, diagram = boxes
    assert curve["y"] >= e["y"]
    assert curve["y"] < diagram["y"] + diagram["height"]


def test_rods_and_masses_are_numbered_from_the_left_and_walls_are_not(visit, solved):
    rod = PRESETS["unequal"].system.bodies[1]
    page = visit(solved(ri.System([ri.Wall(), rod, ri.RigidMass(1.0, velocity=-1.0)])))
    assert page.locator("#controls legend").all_inner_texts()[:5] == [
        "The wall",
        "Contact wall-1",
        "Rod 1",
        "Contact 1-2",
        "Mass 2",
    ]
    assert (
        field(page, "bodies.1.length").count() == 1
    )  # a path counts from 0, walls too
    sync_api.expect(page.locator("#results")).to_contain_text("velocity of mass 2")
    sync_api.expect(page.locator("#plot-force")).to_contain_text("contact wall-1")
    page.locator("#time").fill("0")
    sentence = sync_api.expect(page.locator("#sentence"))
    sentence.to_contain_text("The wall is at rest, rod 1 is at rest, mass 2 moves")


def test_the_picture_is_displaced_and_its_dashed_lines_have_the_slopes_of_the_velocities(
    visit,
):
    page = visit()
    assert page.is_checked("#displaced")
    page.locator("#time").fill("500")
    page.wait_for_function("() => !page.isRedrawDue")  # it is drawn
    slopes = page.evaluate("""() => page.scene.centres.map(({ t, y }) => [[0, 1], [-2, -1]]
        .map(([i, j]) => (y.at(j) - y.at(i)) / (t.at(j) - t.at(i)))
        .map((slope) => slope / page.scene.row.magnification))""")
    assert slopes == [
        pytest.approx([1.0, 0.0], abs=1e-6),
        pytest.approx([0.0, 0.4], abs=1e-6),
    ]
    T = 1 / ri.materials.steel.wave_speed
    marks = page.evaluate("page.scene.marks.map(({ t, text }) => [t, text])")
    assert marks == [[pytest.approx(0.8 * T), "2l₁/c"], [pytest.approx(2 * T), "2l₂/c"]]
    above, below = page.evaluate("""() => [page.frame, page.strip.frame].map((frame) =>
        frame.across(valueAt(page.scene.contacts[0].faces[1], currentTime())))""")
    ends = page.evaluate("[page.strip.frame.across(page.strip.ends.get(1)[0])]")
    assert [above, below] == [pytest.approx(ends[0])] * 2  # rods and diagram line up
    assert page.evaluate("""() => {
        const { left, right } = page.frame, { view } = page;
        const [low, high] = page.scene.row.span;
        return (high - low) / (view.right - view.left) > 0.95;
    }""")


@pytest.mark.parametrize(("width", "key"), [(1440, "unequal"), (390, "chain")])
def test_a_print_is_one_page_on_white_without_controls(visit, width, key):
    page = visit(viewport={"width": width, "height": 800}, color_scheme="dark")
    page.select_option("#preset", key)
    page.wait_for_function("() => !page.isSceneDue && !page.isRedrawDue")
    pages = re.findall(
        rb"/Type\s*/Page\b", page.pdf(format="A4", print_background=True)
    )
    assert len(pages) == 1
    theme = sync_api.expect(page.locator("html"))
    theme.to_have_attribute("data-theme", "dark")
    page.emulate_media(media="print")
    theme.to_have_attribute("data-theme", "light")
    shown = page.evaluate("""() => [...document.querySelectorAll("button, input, select")]
        .filter((e) => e.getClientRects().length).map((e) => e.outerHTML)""")
    assert shown == []
    page.emulate_media(media="screen")
    theme.to_have_attribute("data-theme", "dark")


def test_a_tour_of_the_box_in_six_steps(visit):
    page = visit()
    page.click("#tour-open")
    shown = []
    for k in range(6):
        sync_api.expect(page.locator("#tour-text")).to_contain_text(f"{k + 1} of 6")
        page.wait_for_function("() => !page.isSceneDue && !afterScene")
        shown.append((page.input_value("#preset"), page.evaluate("currentTime()")))
        page.click("#tour-next")
    T = 1 / ri.materials.steel.wave_speed
    assert [key for key, _ in shown] == [*["identical"] * 4, "wall", "unequal"]
    assert [t / T for _, t in shown[1:]] == pytest.approx([0.5, 1, 2, 2, 0.8])
    assert shown[0][1] < 0
    assert not page.locator("#tour").is_visible()


def test_keys_and_fingers(visit):
    page = visit(viewport={"width": 360, "height": 700}, has_touch=True)
    page.locator("body").press("Space")
    sync_api.expect(page.locator("#play")).to_have_text("Pause")
    page.locator("body").press("Space")
    assert page.evaluate("scrollY") == 0
    box = page.locator("#diagram").bounding_box()
    page.touchscreen.tap(box["x"] + 0.4 * box["width"], box["y"] + 0.5 * box["height"])
    sync_api.expect(page.locator("#readout")).to_contain_text("velocity")
    small = page.evaluate(f"""() => [...document.querySelectorAll("{CONTROLS}, summary")]
        .filter((e) => e.getClientRects().length).filter((e) => {{
            const {{ width, height }} = e.getBoundingClientRect();
            return width < 24 || height < 24;
        }}).map((e) => e.outerHTML)""")
    assert small == []


def test_two_collisions_are_shown_at_the_same_time_in_the_same_colours(visit):
    page = visit()
    page.click("#compare")
    page.select_option("#preset", "hopkinson")
    page.wait_for_function("() => !page.isSceneDue && page.scene.bodies.length === 3")
    sync_api.expect(page.locator("#other-text")).to_contain_text("Kept: e = 0.4")
    reach = page.evaluate("[page.scene, page.keptScene].map((scene) => scene.scale)")
    assert reach[0] == reach[1]
    assert reach[0]["velocity"] == 10
    page.locator("#time").fill("0")
    assert page.evaluate(
        "currentTime() === Math.min(page.scene.begin, page.keptScene.begin)"
    )
    boxes = [
        page.locator(canvas).bounding_box() for canvas in ("#diagram", "#other-diagram")
    ]
    page.wait_for_function("byId('diagram').width === byId('diagram').clientWidth")
    assert boxes[0]["x"] + boxes[0]["width"] <= boxes[1]["x"]
    page.click("#compare")
    assert not page.locator("#other").is_visible()


def bodies_of(page):
    return page.evaluate("design.case.bodies.map((body) => body.kind)")


def test_bodies_come_go_and_change_places(visit):
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
    assert page.evaluate("[design.gauges[0].body, design.case.contacts.length]") == [
        0,
        2,
    ]
    page.click("[aria-label='Move mass 2 to the left']")
    page.click("[aria-label='+ step of rod 2']")
    assert page.evaluate("design.case.bodies[1].segments.map((s) => s.area)") == [
        1e-4,
        2e-4,
    ]
    page.click("text=− step")  # noqa: RUF001
    assert page.evaluate("design.case.bodies[1].length") == 1.0
    for _ in range(3):
        page.keyboard.press("Control+z")
    assert bodies_of(page) == ["rod", "mass", "wall"]
    for _ in range(3):
        page.click("#undo")
    wait_for_e(page, "0.4")
    assert page.locator("#undo").is_disabled()


def drag(page, start, way):
    """Drag a point of the strip, given by an expression, by so many pixels."""
    page.wait_for_function("() => !page.isSceneDue && !page.isRedrawDue")
    x, y = page.evaluate(start)
    box = page.locator("#rods").bounding_box()
    page.mouse.move(box["x"] + x, box["y"] + y)
    page.mouse.down()
    for share in (0.3, 0.7, 1):
        page.mouse.move(box["x"] + x + share * way, box["y"] + y)
    page.mouse.up()


def test_ends_gauges_and_rods_are_dragged_in_the_picture(visit):
    page = visit()
    across = "page.strip.frame.across(page.strip.ends.get({})[{}])"
    scale = page.evaluate("page.strip.frame.across(1) - page.strip.frame.across(0)")
    drag(page, f"[{across.format(1, 1)}, page.strip.middle]", 0.2 * scale)
    assert float(field(page, "bodies.1.length").input_value()) == pytest.approx(
        1200, abs=2
    )
    wait_for_e(page, f"{400 / float(field(page, 'bodies.1.length').input_value()):.6g}")
    drag(page, "page.strip.gauges[0]", 60)
    assert float(field(page, "gauges.0.fraction").input_value()) > 60
    drag(page, f"[{across.format(0, 1)} - 20, page.strip.middle]", 0.9 * scale)
    assert float(field(page, "bodies.1.length").input_value()) == 400
    page.click("#undo")
    assert float(field(page, LENGTH).input_value()) == 400


def test_names_never_become_markup(visit, solved):
    alloy = ri.Material(
        "</script><b onclick=1>&amp;</b>", youngs_modulus=200e9, density=7850.0
    )
    rod = ri.Rod(1.0, area=1e-4, material=alloy, velocity=1.0)
    page = visit(solved(ri.System([rod, ri.Wall()])))
    assert alloy.name in page.locator('[id="bodies.0.material"]').inner_text()
    assert page.locator("b").count() == 0


def test_an_address_that_cannot_be_solved_is_told(visit, url):
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


def test_compliant_contacts_and_masses_are_solved_while_a_slider_moves(visit, solved):
    page = visit(solved(HERTZ))
    for mm in (300, 500, 700):
        field(page, LENGTH).fill(f"{mm}")
        left = HERTZ.bodies[0].replace(length=mm / 1000)
        outcome = ri.solve(HERTZ.replace(bodies=[left, HERTZ.bodies[1]])).outcome
        wait_for_e(page, f"{outcome.restitution:.5g}")
    page.wait_for_function(
        "() => [page.scene.curve, page.scene.roundness].every((c) => c.isOutdated === "
        "false)"
    )
    count = "page.scene.{}.values.filter((e) => e !== null).length"
    page.wait_for_function(count.format("curve") + " === 20")
    page.wait_for_function(count.format("roundness") + " === 20")
    curve = page.evaluate("page.scene.roundness")  # e falls from that of balls to l1/l2
    assert (curve["ratios"][0], curve["ratios"][-1]) == (-2, 4)
    here = np.interp(curve["here"], curve["ratios"], curve["values"])
    assert [curve["values"][0], here, curve["values"][-1]] == pytest.approx(
        [1.0, outcome.restitution, 0.7], abs=0.02
    )
    assert page.locator("#plot-roundness").is_visible()
    page.select_option('[id="contacts.0.law"]', "rigid")
    wait_for_e(page, "0.7")
    sync_api.expect(page.locator("#plot-roundness")).to_contain_text("rigid ends")
    assert page.locator("#ends").input_value() == "4"


def round_ends(page, kappa):
    """Move the slider of the ends; returns the draft of e while it moves."""
    return page.evaluate(
        """(kappa) => {
            byId("ends").value = kappa ?? byId("ends").max;
            byId("ends").dispatchEvent(new Event("input"));
            return sceneOf(design, true).scene.restitution;
        }""",
        kappa,
    )


def test_a_slider_rounds_the_ends(visit):
    """e falls from that of balls to l1/l2; a draft, while it moves, says how wrong it
    may be.
    """
    page = visit()
    left, right = PRESETS["unequal"].system.bodies
    restitutions = []
    for kappa in (-2, 1, 3):
        draft = round_ends(page, kappa)
        stiffness = float(field(page, "contacts.0.stiffness").input_value()) * 1e9
        # kappa = k (V T)^(1/2) L/(E A), with V = 1 m/s
        ratio = stiffness * right.transit_time**0.5 / (2e11 * 1e-4)
        assert ratio == pytest.approx(10**kappa, rel=0.01)
        pair_of_balls = ri.System([left, right], contacts=[ri.Hertz(stiffness)])
        e = ri.solve(pair_of_balls).outcome.restitution
        wait_for_e(page, f"{e:.5g}")
        error = float(draft["error"].replace("\u2212", "-") or 5e-6)
        assert draft["value"] == pytest.approx(e, abs=error)
        restitutions.append(e)
    assert restitutions == sorted(restitutions, reverse=True)
    round_ends(page, None)
    wait_for_e(page, "0.4")


def test_a_map_of_compliant_contacts_is_made_of_solutions(visit, solved):
    page = visit(solved(HERTZ))
    page.click("#map summary")
    page.select_option("#map-y", label="stiffness of contact 1-2")
    sync_api.expect(page.locator("#map-reading")).to_contain_text("% solved")
    page.wait_for_function("() => map.values.length > 5", timeout=120_000)
    length, stiffness, e = page.evaluate("[map.xs[30], map.ys[5], map.values[5][30]]")
    left = HERTZ.bodies[0].replace(length=length / 1000)
    row = HERTZ.replace(
        bodies=[left, HERTZ.bodies[1]], contacts=[ri.Hertz(stiffness * 1e9)]
    )
    assert e == pytest.approx(ri.solve(row).outcome.restitution, abs=1e-6)


def test_a_collision_that_takes_too_long_is_told_and_the_page_goes_on(visit, solved):
    left, right = PRESETS["unequal"].system.bodies
    middle = right.replace(length=0.1)
    contacts = [ri.Rigid(), ri.Hertz(1e10)]
    page = visit(solved(ri.System([left, middle, right], contacts=contacts)))
    page.evaluate("Object.assign(TIME_LIMITS, { scene: 0.2, draft: 0.1 })")  # s
    field(page, "bodies.1.length").fill("0.001")
    message = sync_api.expect(page.locator("#message"))
    message.to_contain_text("This collision takes too long for the page.")
    message.to_contain_text("Make the shortest rod longer")
    assert not page.locator("#results").is_visible()
    fewer = tables_of(with_gauges(ri.Case(HERTZ)))  # the picture still has three rods
    page.evaluate(
        """(design) => {
        design.case.bodies[0].length = 1e-6;
        showDesign(design);
    }""",
        fewer,
    )
    page.wait_for_function("() => !page.isSceneDue && !page.isRedrawDue")
    message.to_contain_text("This collision takes too long for the page.")
    page.click("#undo")
    page.evaluate("TIME_LIMITS.scene = 60")
    field(page, "bodies.1.length").fill("100")
    sync_api.expect(page.locator("#results")).to_be_visible()
    message.to_be_hidden()


def test_a_curve_of_other_rods_is_grey_until_it_is_solved(visit, solved):
    page = visit(solved(HERTZ))
    page.wait_for_function("() => page.scene.roundness.isOutdated === false")
    outdated = page.evaluate("""() => [0.4, 0.55].map((length) => {
        const other = structuredClone(design);
        other.case.bodies[0].length = length;
        return sceneOf(other).scene.roundness.isOutdated;
    })""")
    assert outdated == [False, True]
    colours = page.evaluate("""() => {
        const seen = [];
        const { line } = CanvasPen.prototype;
        CanvasPen.prototype.line = function (points, stroke, ...rest) {
            if (points.length === 20) seen.push(stroke);
            line.call(this, points, stroke, ...rest);
        };
        for (const outdated of [true, false])
            drawRestitution("roundness", { ...page.scene.roundness, low: -2, isOutdated: outdated },
                            { title: "", name: "", label: "" }, page.scene, page.theme);
        CanvasPen.prototype.line = line;
        return [seen, [page.theme.line, page.theme.series[0]]];
    }""")
    assert colours[0] == colours[1]


def test_the_legend_names_the_values_that_occur(visit):
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


def test_no_line_ends_between_a_number_and_its_unit(visit):
    page = visit()
    for key in ("unequal", "chain", "wall"):
        page.select_option("#preset", key)
        page.wait_for_function("() => !page.isSceneDue && !page.isRedrawDue")
        for part in ("#reason", "#sentence", "#theory", "#remark", "#notes"):
            text = page.locator(part).text_content()
            assert re.findall(r"\d (?:%|[nµmkMG]?(?:m|s|N|J|Pa)\b)| = ", text) == []
            assert re.findall(r"(?i)\b(?:rod|mass|contact) \d", text) == []


def test_a_quantity_that_is_rounded_up_has_the_next_prefix(visit):
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


def test_facts_of_the_solver_are_in_the_notes_only(visit):
    page = visit()
    wait_for_e(page, "0.4")
    notes = page.inner_text("#notes").replace("\u00a0", " ")
    for fact in ("solved at 80 ratios", 'The method is "fronts".', "to 12 digits"):
        assert fact in notes
        assert fact not in page.inner_text("#top").replace("\u00a0", " ")


def test_a_question_is_explained_where_it_is_written(visit):
    page = visit()
    open_menu(page)
    page.click("#ask")
    described = page.locator("#question").get_attribute("aria-describedby")
    assert "for your class" in page.inner_text(f"#{described}")


# The layout


def steel_rod(length, velocity=0.0):
    return ri.Rod(length, area=1e-4, material=ri.materials.steel, velocity=velocity)


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


def begin(page, case):
    """Let a page begin with a case, and wait until it is solved in full."""
    page.evaluate("(design) => showDesign(design)", tables_of(with_gauges(case)))
    page.wait_for_function(
        "() => !page.isSceneDue && !page.isRedrawDue && !page.isDraft"
    )


def hidden_parts(page, selectors):
    """Selectors of elements that are covered, or not whole on the first screen."""
    return page.evaluate(
        """(selectors) => selectors.filter((selector) => {
            const element = document.querySelector(selector);
            const { left, top, right, bottom, width } = element.getBoundingClientRect();
            const inside = left >= 0 && top >= 0 && right <= innerWidth && bottom <= innerHeight;
            const there = document.elementFromPoint((left + right) / 2, top + 4);
            const open = there && (element.contains(there) || there.contains(element));
            return !(width > 0 && inside && open);
        })""",
        list(selectors),
    )


@pytest.mark.parametrize(("width", "height"), [(1440, 900), (1024, 768)])
def test_inputs_e_and_reason_are_on_the_first_screen(visit, width, height):
    page = visit(viewport={"width": width, "height": height})
    for name, system in LESSONS.items():
        begin(page, ri.Case(system))
        has_e = page.evaluate("page.scene.restitution.value !== null")
        result = "#restitution" if has_e else "#after"
        inputs = [f"[id='{path}']" for path in INPUTS]
        assert hidden_parts(page, [*inputs, result, "#reason"]) == [], name
        assert page.evaluate("scrollY") == 0


@pytest.mark.parametrize(("width", "height"), [(1440, 900), (1024, 768)])
def test_the_law_of_a_contact_stands_beside_its_name(visit, width, height):
    page = visit(viewport={"width": width, "height": height})
    begin(page, ri.Case(LESSONS["rod, rod and wall"]))
    lines = page.locator(".contact").evaluate_all("""all => all.map((block) => {
        const [name, law] = ["legend", "select"].map((part) =>
            block.querySelector(part).getBoundingClientRect());
        return [name.right, law.left, name.top < law.bottom && law.top < name.bottom];
    })""")
    assert len(lines) == 2
    for name_right, law_left, is_same_line in lines:
        assert name_right <= law_left
        assert is_same_line


@pytest.mark.parametrize(("width", "height"), [(1440, 900), (1024, 768)])
def test_other_colours_leave_the_pictures_where_they_are(visit, width, height):
    page = visit(viewport={"width": width, "height": height})
    begin(page, ri.Case(LESSONS["rod, rod and wall"]))
    before = page.locator("#rods").bounding_box()
    page.check("input[value=stress]")
    sync_api.expect(page.locator("#least")).to_contain_text("MPa, compressed")
    assert page.locator("#rods").bounding_box() == before
    bar = page.locator(".bar").bounding_box()
    zoom = page.locator("#zoom-all").bounding_box()
    assert zoom["x"] + zoom["width"] <= bar["x"] + bar["width"] + 1


def test_the_sentence_of_a_tour_has_its_reserved_height(visit):
    page = visit(viewport={"width": 1440, "height": 900})
    sentence = page.locator("#sentence")
    before = sentence.bounding_box()["height"]
    page.click("#tour-open")
    for _ in range(5):
        page.click("#tour-next")
        page.wait_for_function("() => !page.isSceneDue && !afterScene")
        page.wait_for_function("() => !page.isRedrawDue")
        assert sentence.bounding_box()["height"] == before


@pytest.mark.parametrize("name", ["two rigid rods", "two Hertz rods"])
def test_a_phone_shows_all_inputs_first_and_the_reason_next(visit, solved, name):
    page = visit(solved(LESSONS[name]), viewport={"width": 390, "height": 844})
    inputs = [f"[id='{path}']" for path in INPUTS]
    assert hidden_parts(page, [*inputs, "#restitution", "#play"]) == []
    last = field(page, "bodies.1.velocity").bounding_box()
    assert page.locator("#reason").bounding_box()["y"] < last["y"] + 60


def test_tools_stand_in_one_row_on_the_narrowest_phone(visit):
    page = visit(viewport={"width": 360, "height": 700})
    tops = page.evaluate("""() => [...document.querySelectorAll(".tools > *")]
        .filter((e) => e.getClientRects().length)
        .map((e) => Math.round(e.getBoundingClientRect().top))""")
    assert len(tops) == 5
    assert len(set(tops)) == 1


def test_the_page_opens_still_at_the_start(visit):
    page = visit()
    assert page.evaluate("[currentTime() === page.scene.begin, page.isPlaying]") == [
        True,
        False,
    ]
    assert page.evaluate("page.scene.begin") < 0
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
    bodies.insert(int(rng.integers(0, len(bodies) + 1)), steel_rod(0.5, 2.0))
    if rng.random() < 0.4:
        bodies.append(ri.Wall())
    if rng.random() < 0.2:
        bodies.insert(0, ri.Wall())
    laws = []
    gaps = []
    for left, right in itertools.pairwise(bodies):
        has_rod = isinstance(left, ri.Rod) or isinstance(right, ri.Rod)
        first_law = 0 if has_rod else 1  # no wave decides a rigid contact of masses
        law = rng.integers(first_law, 3)
        laws.append([ri.Rigid(), ri.Spring(1e8), ri.Hertz(1e10)][law])
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


def test_the_whole_row_is_inside_the_picture(visit):
    page = visit()
    rng = np.random.default_rng(43)
    for _ in range(50):
        case = with_gauges(ri.Case(random_row(rng), {"max_events": 300}))
        design = tables_of(case)
        assert page.evaluate(OUTSIDE, design) == [], design


def test_escape_ends_the_tour_and_gives_all_back(visit):
    page = visit()
    field(page, LENGTH).fill("700")
    wait_for_e(page, "0.7")
    page.locator("#time").fill("640")
    page.click("#tour-open")
    sync_api.expect(page.locator("#tour-text")).to_contain_text("1 of 6")
    page.click("#tour-next")
    page.wait_for_function("() => !page.isSceneDue && !afterScene")
    assert page.input_value("#preset") == "identical"
    page.keyboard.press("Escape")
    wait_for_e(page, "0.7")
    page.wait_for_function("() => !page.isSceneDue && !afterScene && !page.isRedrawDue")
    assert field(page, LENGTH).input_value() == "700"
    assert page.evaluate("page.fraction") == pytest.approx(0.64)
    assert page.evaluate("document.activeElement.id") == "tour-open"
    assert not page.locator("#tour").is_visible()


def test_an_arrow_is_dragged_and_undone(visit):
    page = visit()
    page.locator("#time").fill("0")
    stop_clock(page)
    arrow = "[page.strip.arrows[{}].tip, page.strip.arrows[{}].y]"
    speed = field(page, "bodies.0.velocity")
    per_pixel = page.evaluate("1 / page.arrowScale")
    drag(page, arrow.format(0, 0), 40)
    assert float(speed.input_value()) == pytest.approx(1 + 40 * per_pixel, abs=0.06)
    drag(page, arrow.format(1, 1), -20)
    second = float(field(page, "bodies.1.velocity").input_value())
    assert second < 0
    sync_api.expect(page.locator("#sentence")).to_contain_text(
        f"rod 2 moves at \u2212{-second:g}"
    )
    page.click("#undo")
    page.click("#undo")
    assert speed.input_value() == "1"
    assert field(page, "bodies.1.velocity").input_value() == "0"


def test_ends_and_arrows_are_moved_by_keys(visit):
    page = visit()
    page.locator("#time").fill("0")
    page.wait_for_function("() => !page.isRedrawDue")
    handles = page.locator("#handles [role=slider]")
    assert handles.evaluate_all("all => all.map((one) => one.ariaLabel)") == [
        "Velocity of rod 1",
        "Length of rod 1",
        "Velocity of rod 2",
        "Length of rod 2",
    ]
    handles.nth(1).focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("PageUp")
    assert field(page, LENGTH).input_value() == "411"
    wait_for_e(page, "0.411")
    assert handles.nth(1).get_attribute("aria-valuetext") == "411 mm"
    assert page.evaluate("document.activeElement.ariaLabel") == "Length of rod 1"
    handles.nth(2).focus()
    page.keyboard.press("ArrowLeft")
    assert field(page, "bodies.1.velocity").input_value() == "-0.1"
    page.wait_for_function("() => !page.isSceneDue && !page.isRedrawDue")
    places = page.evaluate("""() => [...document.querySelectorAll("#handles > *")].map((one) => {
        const { left, width, top, height } = one.getBoundingClientRect();
        const origin = byId("rods").getBoundingClientRect();
        return [left + width / 2 - origin.left, top + height / 2 - origin.top];
    })""")
    tip, end = page.evaluate("""[[page.strip.arrows[1].tip, page.strip.arrows[1].y],
        [page.strip.frame.across(page.strip.ends.get(1)[1]), page.strip.middle]]""")
    assert places[2] == pytest.approx(tip, abs=1)
    assert places[3] == pytest.approx(end, abs=1)
    page.locator("#time").fill("500")
    page.wait_for_function("() => !page.isRedrawDue")
    assert handles.count() == 0  # the set-up is no longer seen


def lines_drawn(page, do):
    """Colour and points of each line of pens while some JavaScript runs."""
    return page.evaluate(f"""() => {{
        const lines = [];
        const {{ line }} = CanvasPen.prototype;
        CanvasPen.prototype.line = function (points, colour, ...rest) {{
            lines.push([colour, points]);
            line.call(this, points, colour, ...rest);
        }};
        {do};
        CanvasPen.prototype.line = line;
        return lines;
    }}""")


def test_the_force_stands_beside_the_diagram_on_its_time_axis(visit):
    page = visit()
    page.locator("#time").fill("300")
    page.wait_for_function("() => !page.isRedrawDue")
    lines = lines_drawn(page, "draw()")
    frame_left = page.evaluate("page.frame.x")
    force = page.evaluate("({ ...page.frame.force })")
    red, blue = page.evaluate("[page.theme.accent, page.theme.series[0]]")
    time_lines = []
    force_curves = []
    for colour, points in lines:
        x = points[0][0]
        if colour == red and x == frame_left:
            time_lines.append(points)
        if colour == blue and x >= force["x"]:
            force_curves.append(points)
    assert time_lines[0][1][0] == force["right"]  # one line crosses both
    T = 0.4 / ri.materials.steel.wave_speed
    up = page.evaluate("([start, end]) => [start, end].map(page.frame.up)", [0, 2 * T])
    curve = np.array(force_curves[0])
    for height in up:  # the force begins and ends on the axis of the diagram
        assert np.abs(curve[:, 1] - height).min() < 0.01
    jump = np.ptp(curve[:, 0])
    assert jump > 0.8 * (force["right"] - force["x"])


def test_a_chain_is_told_contact_by_contact(visit):
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


def test_a_label_without_room_leaves_the_others(visit, solved):
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


def test_a_lesson_on_paper(visit):
    page = visit(viewport={"width": 1280, "height": 800})
    open_menu(page)
    page.click("#ask")
    page.locator("#question").fill("What happens?")
    page.locator("#time").fill("700")
    page.emulate_media(media="print")
    page.wait_for_function("() => page.isPrinting && !page.isRedrawDue")
    assert page.evaluate("page.strip.arrows.length") == 2  # the set-up
    tops = [
        page.locator(part).bounding_box()["y"]
        for part in ("#question", "#given", "#rods", "#diagram", "#plots")
    ]
    assert tops == sorted(tops)
    setup = page.inner_text("#given").replace("\u00a0", " ")
    assert setup.startswith(
        "Rod 1: 400 mm long, 100 mm², steel; 1 m/s. Contact 1-2: ri"
    )
    assert page.locator("#reason").is_visible()
    assert not page.locator("#lines").is_visible()
    charts = page.locator("#plots canvas").evaluate_all(
        "all => all.map((one) => [one.clientWidth, one.parentElement.clientWidth])"
    )
    assert all(chart == column for chart, column in charts)
    page.emulate_media(media="screen")
    page.click("#guess-first")
    page.emulate_media(media="print")
    page.wait_for_function("() => page.isPrinting && !page.isRedrawDue")
    assert page.locator("#lines p").count() > 8
    for part in ("#lines", "#question", "#asked", "#rods", "#diagram"):
        assert page.locator(part).is_visible(), part
    for part in ("#reason", "#facts", "#plots", ".restitution", "#notes", "button"):
        assert not page.locator(part).first.is_visible(), part


def test_numbers_shown_are_those_of_the_api(visit):
    rng = np.random.default_rng(3)
    page = visit()
    for _ in range(12):
        system = random_row(rng)
        options = {"max_events": 1000}
        begin(page, ri.Case(system, options))
        outcome = ri.solve(system, **options).outcome
        name, _ = page.evaluate("page.scene.results[0]")
        assert name.endswith(" after" if outcome.final else " at the end")
        assert page.evaluate("page.scene.final") == outcome.final
        if not outcome.final:
            continue
        shown = []
        for velocity in page.evaluate("page.scene.velocities"):
            shown.append(float(velocity["value"]))
        digits = 6 if page.evaluate("page.scene.method") == "fronts" else 4
        rounded = []
        for kind, v in zip(outcome.bodies, outcome.velocities_after, strict=True):
            if kind != "wall":
                rounded.append(float(f"{v:.{digits}g}"))
        fastest = max(map(abs, [*outcome.velocities_before, *rounded]))
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


def test_a_notebook_is_told_what_the_sliders_say(visit, tmp_path):
    html = json.dumps(ri.explore(HERTZ).html).replace("<", "\\u003c")
    widget = json.dumps(read("notebook.js"))
    text = HOLDER.replace("WIDGET", widget).replace("PAGE", html)
    (tmp_path / "holder.html").write_text(text, encoding="utf-8")
    page = visit((tmp_path / "holder.html").as_uri())
    inside = page.frame_locator("iframe")
    sync_api.expect(inside.locator("#results")).to_contain_text("velocity of rod 2")
    stop_clock(page.frames[1])
    length = inside.locator(f'[id="{LENGTH}"]')
    length.fill("700")
    length.fill("-3")  # a mistake is not sent
    sync_api.expect(inside.locator(".problem:not(:empty)")).to_have_count(1)
    length.fill("650")
    page.wait_for_function("() => sent.length && sent.at(-1).includes('0.65')")
    assert all(
        "-" not in text.split("[[bodies]]")[1] for text in page.evaluate("sent") if text
    )
    left, right = HERTZ.bodies
    system = ri.parse_case(page.evaluate("sent.at(-1)")).system
    assert system == HERTZ.replace(bodies=[left.replace(length=0.65), right])
    inside.locator("#undo").click()
    page.wait_for_function("() => sent.at(-1) === ''")
