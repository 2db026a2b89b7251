"""The page in a browser: what a person sees and does."""

import json
import re
import shutil
import threading
import tomllib

import pytest

import rodimpact as ri
from rodimpact.cli import main
from rodimpact.explore.design import Design
from rodimpact.explore.presets import presets
from rodimpact.explore.server import Server

sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
BROWSER = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
if BROWSER is None:
    pytest.skip("no Chromium is installed", allow_module_level=True)

PRESETS = {preset.key: preset.design for preset in presets()}
LENGTH = "bodies.0.length"
CONTROLS = "button, input, select, canvas"
sync_api.expect.set_options(timeout=20_000)  # ms


@pytest.fixture(scope="module")
def browser():
    with sync_api.sync_playwright() as playwright:
        switches = ["--no-sandbox", "--disable-gpu", "--disable-background-networking"]
        started = playwright.chromium.launch(executable_path=BROWSER, args=switches)
        yield started
        started.close()


@pytest.fixture(scope="module")
def url():
    with pytest.MonkeyPatch.context() as patch, Server(PRESETS["unequal"]) as server:
        patch.setenv("NUMBA_DISABLE_JIT", "1")  # as the command does
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        yield server.url
        server.shutdown()
        thread.join()


@pytest.fixture
def visit(browser, url):
    """Opens addresses; afterwards nothing may have gone wrong or been asked of anybody else."""
    opened, wrong = [], []

    def open_page(address=url, offline=False, **options):
        context = browser.new_context(**options)
        context.set_offline(offline)
        page = context.new_page()
        page.on("console", lambda message: wrong.append(message.text))
        page.on("pageerror", lambda error: wrong.append(str(error)))
        own = (url, "data:", "blob:", "file:")
        page.on("request", lambda r: None if r.url.startswith(own) else wrong.append(r.url))
        page.wrong = wrong
        opened.append(context)
        page.goto(address)
        page.wait_for_selector("html[data-frames]", state="attached")
        return page

    yield open_page
    for context in opened:
        context.close()
    assert wrong == []


def field(page, path):
    return page.locator(f'[id="{path}"]')


def slider(page, path):
    return page.locator(f'[data-slides="{path}"]')


def wait_for_e(page, text):
    sync_api.expect(page.locator("#restitution")).to_have_text(text)


def shown_e(outcome):
    return f"{outcome.restitution:.9g}"


def pair(length):
    steel = ri.materials.steel
    left = ri.Rod(length, area=1e-4, material=steel, velocity=1.0)
    return ri.collide(left, ri.Rod(1.0, area=1e-4, material=steel))


def picture(page, canvas="#diagram"):
    return page.locator(canvas).evaluate("canvas => canvas.toDataURL()")


def test_the_first_picture_shows_the_design(visit):
    page = visit()
    wait_for_e(page, "0.4")
    assert "Saint-Venant" in page.inner_text("#theory")
    assert page.input_value("#preset") == "unequal"
    assert field(page, LENGTH).input_value() == "400"
    assert "impedance Z 3962 kg/s" in page.inner_text("#controls")


def test_dragging_a_slider_moves_e_as_the_api_does(visit):
    page = visit()
    wait_for_e(page, "0.4")
    before, box = picture(page), slider(page, LENGTH).bounding_box()
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


def test_a_number_box_and_the_keys_of_a_slider_do_the_same(visit):
    page = visit()
    field(page, LENGTH).fill("250")
    wait_for_e(page, "0.25")
    assert slider(page, LENGTH).input_value() == "250"
    slider(page, LENGTH).focus()
    page.keyboard.press("ArrowRight")
    wait_for_e(page, "0.251")
    assert field(page, LENGTH).input_value() == "251"


@pytest.mark.parametrize("key", PRESETS)
def test_a_preset_shows_its_collision(visit, key):
    page = visit()
    page.select_option("#preset", key)
    outcome = PRESETS[key].solve().outcome
    wait_for_e(page, "-" if outcome.why_no_restitution() else shown_e(outcome))
    rows = page.locator("#results tr").all_inner_texts()
    last = f"{outcome.velocities_after[-1]:.6g} m/s".replace("-0 ", "0 ")
    if outcome.bodies[-1] == "rod":
        assert any(row.endswith(last) for row in rows)
    assert page.locator("#controls fieldset").count() == 2 * len(outcome.bodies)


def test_material_and_law_can_be_chosen(visit):
    page = visit()
    page.select_option('[id="bodies.1.material"]', "aluminium")
    aluminium = ri.Rod(1.0, area=1e-4, material=ri.materials.aluminium)
    left = PRESETS["unequal"].case.system.bodies[0]
    wait_for_e(page, shown_e(ri.collide(left, aluminium)))
    page.select_option('[id="bodies.1.material"]', "own 1")
    field(page, "materials.own 1.youngs_modulus").fill("50")
    own = ri.Material("own", youngs_modulus=50e9, density=2698.0)
    outcome = ri.collide(left, ri.Rod(1.0, area=1e-4, material=own))
    wait_for_e(page, shown_e(outcome))
    page.select_option('[id="contacts.0.law"]', "spring")
    field(page, "contacts.0.stiffness").fill("10")
    row = ri.System([left, ri.Rod(1.0, area=1e-4, material=own)], contacts=[ri.Spring(1e7)])
    e = Design.of(ri.Case(row)).solve().outcome.restitution
    assert e == pytest.approx(ri.solve(row).outcome.restitution, rel=5e-3)
    wait_for_e(page, f"{e:.5g}")
    sync_api.expect(page.locator("#notes")).to_contain_text("means over cells")
    sync_api.expect(page.locator("#plot-curve")).to_contain_text("solved at 20 ratios")


def test_a_mistake_is_told_beside_its_field_and_mended(visit):
    page = visit()
    field(page, LENGTH).fill("-5")
    problem = page.locator(f'[id="problem:{LENGTH}"]')
    sync_api.expect(problem).to_contain_text("positive")
    assert field(page, LENGTH).get_attribute("aria-invalid") == "true"
    field(page, LENGTH).fill("500")
    wait_for_e(page, "0.5")
    sync_api.expect(problem).to_be_empty()
    page.wrong[:] = [text for text in page.wrong if "422" not in text]  # the browser's own note


def test_a_view_can_be_shared(visit):
    page = visit()
    field(page, LENGTH).fill("300")
    page.check("input[value=stress]")
    page.locator("#time").fill("700")
    wait_for_e(page, "0.3")
    page.wait_for_url(re.compile(r"bodies\.0\.length=0\.3&.*view\.quantity=stress&view\.time=0\.7"))
    address, seen = page.url, (picture(page), picture(page, "#rods"))
    again = visit(address)
    wait_for_e(again, "0.3")
    assert again.is_checked("input[value=stress]")
    assert (picture(again), picture(again, "#rods")) == seen


def test_an_address_that_is_nonsense_is_told(visit, url):
    context = visit().context
    for address in ("#case.bodies=7", "#case.schema=1&case.bodies.0.kind=rod"):
        page = context.new_page()
        page.goto(f"{url}{address}")
        told = page.locator("#message:not(:empty), .problem:not(:empty)").first
        sync_api.expect(told).not_to_be_empty()


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


def rods_at(page, share):
    """Left and right end of every rod in the picture, at a thousandth of the film."""
    page.locator("#time").fill(str(share))
    pieces = page.evaluate("""() => slice(shown.scene, now()).map(({ polygon, low, high }) =>
        [shown.scene.tiling.body[polygon], low, high])""")
    found = {}
    for body, low, high in pieces:
        left, right = found.get(body, (low, high))
        found[body] = (min(left, low), max(right, high))
    return found


def assert_the_film_ends_with_its_rods(page):
    before, last = rods_at(page, 999), rods_at(page, 1000)
    assert last.keys() == before.keys()
    for body, ends in last.items():
        assert ends == pytest.approx(before[body], abs=0.01)


@pytest.mark.parametrize("key", PRESETS)
def test_no_rod_vanishes_at_the_end_of_the_film(visit, key):
    page = visit()
    page.select_option("#preset", key)
    outcome = PRESETS[key].solve().outcome
    wait_for_e(page, "-" if outcome.why_no_restitution() else shown_e(outcome))
    assert_the_film_ends_with_its_rods(page)


def test_pointing_reads_the_value_of_the_solution(visit):
    page = visit()
    wait_for_e(page, "0.4")
    solution = ri.solve(PRESETS["unequal"].case.system)
    box = page.locator("#diagram").bounding_box()
    found = 0
    for across, up in ((0.2, 0.8), (0.5, 0.6), (0.6, 0.3), (0.7, 0.5), (0.35, 0.2)):
        page.mouse.move(box["x"] + across * box["width"], box["y"] + up * box["height"])
        page.wait_for_timeout(60)
        text = page.inner_text("#readout").replace("\u00a0", " ").replace("\u2212", "-")
        read = re.match(
            r"t = (\S+) (µ?)s: Rod (\d), x = (\S+) (m?)m .*velocity (\S+) (m?)m/s, stress (\S+)",
            text,
        )
        if read is None:
            assert "no rod here" in text
            continue
        t = float(read[1]) * (1e-6 if read[2] else 1)
        x = float(read[4]) * (1e-3 if read[5] else 1)
        v = float(read[6]) * (1e-3 if read[7] else 1)
        assert v == pytest.approx(solution.velocity(int(read[3]), x, t).item(), abs=1e-9)
        found += 1
    assert found >= 3


def test_zoom_by_wheel_buttons_and_keys(visit):
    page = visit()
    wait_for_e(page, "0.4")
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
    page.hover("#diagram")
    page.mouse.wheel(0, -400)
    page.mouse.move(0, 0)
    page.wait_for_timeout(60)
    assert picture(page) != whole


def test_files_can_be_taken_away(visit, tmp_path):
    page = visit()
    field(page, LENGTH).fill("350")
    wait_for_e(page, "0.35")
    with page.expect_download() as download:
        page.click("#save-case")
    download.value.save_as(tmp_path / "case.toml")
    assert ri.read_case(tmp_path / "case.toml").system.bodies[0].length == 0.35
    assert tomllib.loads((tmp_path / "case.toml").read_text())["schema"] == 1
    with page.expect_download() as download:
        page.click("#save-svg")
    download.value.save_as(tmp_path / "picture.svg")
    text = (tmp_path / "picture.svg").read_text(encoding="utf-8")
    assert text.startswith("<svg xmlns=")
    (tmp_path / "holder.html").write_text('<html data-frames="1"><img src="picture.svg"></html>')
    holder = visit((tmp_path / "holder.html").as_uri())
    assert holder.evaluate("document.images[0].decode().then(() => true)")


def test_the_theme_follows_the_system_and_the_switch(visit):
    page = visit(color_scheme="dark")
    assert page.get_attribute("html", "data-theme") == "dark"
    page.click("#theme")
    assert page.get_attribute("html", "data-theme") == "light"


@pytest.mark.parametrize("width", [360, 768, 1280, 1920])
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
        seen.add(page.evaluate("document.activeElement.id || document.activeElement.name"))
    assert {"preset", "theme", "quantity", "diagram", "play", "time", LENGTH} <= seen


def test_the_latest_request_wins(visit):
    page = visit()
    for length in range(100, 160):
        field(page, LENGTH).fill(str(length))
    wait_for_e(page, "0.159")


# The page in one file


@pytest.fixture
def exported(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.toml").write_text(ri.write_case(PRESETS["unequal"].case))
    assert main(["export", "case.toml", "-o", "page.html"]) == 0
    return (tmp_path / "page.html").as_uri()


def test_the_exported_page_plays_from_disk_without_a_network(visit, exported):
    page = visit(exported, offline=True)
    wait_for_e(page, "0.4")
    assert not page.locator("#preset").is_visible()
    assert "impedance Z" in page.inner_text("#controls")
    assert page.locator("#plots figure").count() == 5
    page.locator("#time").fill("0")
    start = picture(page, "#rods")
    page.click("#play")
    page.wait_for_timeout(300)
    page.click("#play")
    assert picture(page, "#rods") != start
    page.locator("#time").fill("300")
    page.click("#zoom-in")
    page.hover("#diagram")
    sync_api.expect(page.locator("#readout")).to_contain_text("t =")
    with page.expect_download():
        page.click("#save-svg")
    assert_the_film_ends_with_its_rods(page)


def test_scene_numbers_reach_the_exported_page_unchanged(visit, exported):
    page = visit(exported, offline=True)
    data = json.loads(page.locator("#embedded").text_content())
    assert data["scene"]["restitution"]["value"] == pair(0.4).restitution
