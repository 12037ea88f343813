"""Reports in a real browser: ``python -m pytest -m browser``."""

from __future__ import annotations

import base64
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from tests.comparison.fakes import METHODS, Told, toy_frame
from tests.report.page.test_builder import page as page_of_everything
from tests.validation.records import full_record
from uqfold.problems.criterion import criteria
from uqfold.report import write_report
from uqfold.validation import Finding, Measurement

pytestmark = pytest.mark.browser

Open = Callable[[Path], Any]


@pytest.fixture(scope="module")
def records() -> pd.DataFrame:
    return toy_frame()


@pytest.fixture(scope="module")
def files(records: pd.DataFrame, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("reports")
    cases = [full_record(), full_record(name="other", title="Another case")]
    many = {f"told-{i}": Told(n=50 * 3**i, bias=0.3 * (-0.5) ** i) for i in range(7)}
    eight = toy_frame(criteria([11.0, 12.0, 13.0]), {**many, "broken": METHODS["broken"]})
    broken = Measurement([Finding("largest difference", 3e-5, 2e-6, "s", remark="far off")] * 3)
    failing = [
        full_record(
            name=f"case_{i}", title=f"A case of some length, number {i}", measurement=broken
        )
        for i in range(9)
    ]
    written = {
        "much fails": write_report(failing, folder / "failing.html"),
        "eight methods": write_report(eight, folder / "eight.html"),
        "comparison": write_report(records, folder / "comparison.html"),
        "validation": write_report(cases, folder / "validation.html"),
        "hostile": page_of_everything().write(folder / "hostile.html"),
    }
    return {name: paths[0] for name, paths in written.items()}


@pytest.fixture
def comparison(opened: Open, files: dict[str, Path]) -> Any:
    return opened(files["comparison"])


def js(driver: Any, code: str, *arguments: Any) -> Any:
    return driver.execute_script(code, *arguments)


def complaints(driver: Any) -> list[str]:
    return [f"{entry['level']}: {entry['message']}" for entry in driver.get_log("browser")]


def announced(driver: Any) -> str:
    return str(js(driver, "return document.getElementById('announcement').textContent"))


def emulate(driver: Any, media: str = "", **features: str) -> None:
    wanted = {"prefers_reduced_motion": "reduce", **features}
    given = [{"name": name.replace("_", "-"), "value": value} for name, value in wanted.items()]
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": media, "features": given})


def resize(driver: Any, width: int, height: int) -> None:
    metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)


def seen(driver: Any, selector: str) -> int:
    """How many elements are shown."""
    elements = "[...document.querySelectorAll(arguments[0])]"
    shown = "(one) => one.getClientRects().length"
    return int(js(driver, f"return {elements}.filter({shown}).length", selector))


ANSWERS = "document.querySelector('#all-answers table')"


def column(driver: Any, head: str) -> list[str]:
    """Texts of the shown rows of the table of all answers."""
    return list(
        js(
            driver,
            f"""const table = {ANSWERS};
            const i = [...table.tHead.rows[0].cells].findIndex(
                (cell) => cell.textContent === arguments[0]);
            return [...table.tBodies[0].rows].filter((row) => row.offsetParent)
                .map((row) => row.cells[i].dataset.sort ?? row.cells[i].textContent)""",
            head,
        )
    )


def press_head(driver: Any, head: str) -> str:
    """Press the heading of a column; gives its aria-sort."""
    return str(
        js(
            driver,
            f"""const head = [...{ANSWERS}.tHead.rows[0].cells].find(
                (cell) => cell.textContent === arguments[0]);
            head.querySelector('button').click();
            return head.getAttribute('aria-sort')""",
            head,
        )
    )


def numbers(values: list[str]) -> list[float]:
    return [float(value) for value in values if value]


@pytest.mark.parametrize("name", ["comparison", "eight methods", "validation", "hostile"])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_opens_without_a_complaint(
    name: str, scheme: str, opened: Open, files: dict[str, Path]
) -> None:
    driver = opened(files[name])
    emulate(driver, prefers_color_scheme=scheme)
    driver.refresh()
    assert complaints(driver) == []
    assert js(driver, "return typeof stolen") == "undefined"
    assert js(driver, "return document.querySelectorAll('th button').length") > 0


def test_a_complaint_would_be_seen_and_foreign_code_does_not_run(comparison: Any) -> None:
    js(
        comparison,
        """const script = document.createElement('script');
        script.textContent = 'window.ran = true';
        document.body.append(script);
        const image = '<img src="x" onerror="window.ran = true">';
        document.body.insertAdjacentHTML('beforeend', image)""",
    )
    assert any("Content Security Policy" in said for said in complaints(comparison))
    assert js(comparison, "return typeof window.ran") == "undefined"


def test_tables_sort_both_ways_with_gaps_at_the_end(comparison: Any) -> None:
    assert press_head(comparison, "pf") == "ascending"
    rising = column(comparison, "pf")
    assert numbers(rising) == sorted(numbers(rising))
    assert "sorted by pf, ascending" in announced(comparison)
    assert press_head(comparison, "pf") == "descending"
    falling = column(comparison, "pf")
    assert numbers(falling) == sorted(numbers(falling), reverse=True)
    gaps = falling.count("")
    assert gaps > 0
    assert rising[-gaps:] == falling[-gaps:] == [""] * gaps
    assert press_head(comparison, "method") == "ascending"
    names = column(comparison, "method")
    assert names == sorted(names)
    heads = "return document.querySelectorAll('#all-answers [aria-sort]').length"
    assert js(comparison, heads) == 1


def test_tables_filter_by_words_and_by_choice(comparison: Any, records: pd.DataFrame) -> None:
    search = comparison.find_element("css selector", "#all-answers input[type=search]")
    search.send_keys("failed bro")
    assert set(column(comparison, "method")) == {"broken"}
    assert f"12 of {len(records)} rows" in announced(comparison)
    search.clear()
    search.send_keys(" ")
    chooser = comparison.find_element("css selector", "#all-answers select")
    chooser.send_keys("exact")
    assert set(column(comparison, "method")) == {"exact"}
    assert len(column(comparison, "method")) == 12


def hidden_series(driver: Any, label: str) -> list[bool]:
    return list(
        js(
            driver,
            """return [...document.querySelectorAll('svg [data-gid]')]
                .filter((one) => one.dataset.gid.startsWith(`method=${arguments[0]}`))
                .map((one) => getComputedStyle(one).display === 'none')""",
            label,
        )
    )


def test_a_method_is_switched_off_everywhere_and_on_again(comparison: Any) -> None:
    before = len(column(comparison, "method"))
    switch = comparison.find_element("css selector", ".controls button.key")
    assert switch.text == "exact"
    # by keyboard
    js(comparison, "arguments[0].focus()", switch)
    comparison.switch_to.active_element.send_keys(" ")
    assert all(hidden_series(comparison, "exact"))
    assert not any(hidden_series(comparison, "biased"))
    assert "exact" not in column(comparison, "method")
    pressed = js(
        comparison,
        """return [...document.querySelectorAll('button.key')]
            .filter((one) => one.textContent.trim() === 'exact')
            .map((one) => one.getAttribute('aria-pressed'))""",
    )
    assert pressed == ["false"]
    assert announced(comparison) == "exact hidden"
    switch.click()
    assert not any(hidden_series(comparison, "exact"))
    assert len(column(comparison, "method")) == before


def test_a_criterion_is_switched_off_with_its_points_and_rows(comparison: Any) -> None:
    panels = "#curves svg [data-gid^='method=exact;']"
    before = seen(comparison, panels)
    for button in comparison.find_elements("css selector", ".controls button.key"):
        if button.text == "tau = 3 mm, 1 mission":
            button.click()
    assert seen(comparison, panels) == 0.75 * before > 0
    rows = zip(column(comparison, "tau (mm)"), column(comparison, "missions"), strict=True)
    assert ("3.0", "1") not in set(rows)


def tip(driver: Any) -> str:
    return str(
        js(
            driver,
            """const tip = [...document.querySelectorAll('.tip')].find((one) => !one.hidden);
            return tip ? tip.textContent : ''""",
        )
    )


def test_values_are_read_by_arrow_keys(comparison: Any) -> None:
    plot = comparison.find_element("css selector", "#curves .plot")
    js(comparison, "arguments[0].focus()", plot)
    # the first points are those of the reference
    plot.send_keys("\ue014")
    assert tip(comparison).startswith("the reference\nT = 11 mm, 1 mission\npf = ")
    assert announced(comparison).startswith("the reference, T = 11 mm, 1 mission, pf = ")
    plot.send_keys("\ue014")
    assert "T = 12 mm" in tip(comparison)
    for label in ("exact", "biased"):
        while not tip(comparison).startswith(label):
            before = tip(comparison)
            plot.send_keys("\ue015")
            assert tip(comparison) != before
        assert tip(comparison).startswith(f"{label}\nT = 12 mm, 1 mission\npf = ")
    plot.send_keys("\ue010")
    assert "T = 13 mm" in tip(comparison)
    plot.send_keys("\ue012")
    assert "T = 12 mm" in tip(comparison)
    plot.send_keys("\ue00c")
    assert tip(comparison) == ""


def test_values_are_read_with_the_pointer(comparison: Any) -> None:
    from selenium.webdriver import ActionChains

    point = comparison.find_element(
        "css selector", "#curves [data-gid='method=exact;criterion=1 mission'] use"
    )
    js(comparison, "arguments[0].scrollIntoView({block: 'center', behavior: 'instant'})", point)
    ActionChains(comparison, duration=0).move_to_element(point).perform()
    assert "T = 11 mm, 1 mission" in tip(comparison)
    head = comparison.find_element("css selector", "h1")
    js(comparison, "arguments[0].scrollIntoView({behavior: 'instant'})", head)
    ActionChains(comparison, duration=0).move_to_element(head).perform()
    assert tip(comparison) == ""


def test_everything_can_be_reached_and_seen_by_keyboard(comparison: Any) -> None:
    js(comparison, "document.body.focus()")
    body = comparison.find_element("css selector", "body")
    body.send_keys("\ue004")
    first = comparison.switch_to.active_element
    assert first.get_attribute("class") == "skip"
    assert first.location["y"] >= 0
    for _ in range(60):
        comparison.switch_to.active_element.send_keys("\ue004")
        style = js(
            comparison,
            """const element = document.activeElement;
            if (element === document.body) return 'body';
            const style = getComputedStyle(element);
            return `${style.outlineStyle} ${style.outlineWidth}`""",
        )
        assert style in ("body", "solid 3px")
    reachable = js(
        comparison,
        """return [...document.querySelectorAll('button, a, input, select, summary, .plot')]
            .filter((one) => one.offsetParent && one.tabIndex < 0).length""",
    )
    assert reachable == 0


def test_light_and_dark_are_switched_and_kept(comparison: Any) -> None:
    paper = "return getComputedStyle(document.body).backgroundColor"
    emulate(comparison, prefers_color_scheme="light")
    light = js(comparison, paper)
    emulate(comparison, prefers_color_scheme="dark")
    dark = js(comparison, paper)
    assert light == "rgb(255, 255, 255)"
    assert dark != light
    comparison.find_elements("css selector", "#theme button")[1].click()
    assert js(comparison, paper) == light
    comparison.refresh()
    assert js(comparison, paper) == light
    emulate(comparison, prefers_color_scheme="light")
    comparison.find_elements("css selector", "#theme button")[2].click()
    assert js(comparison, paper) == dark
    comparison.find_elements("css selector", "#theme button")[0].click()
    assert js(comparison, paper) == light


CONTRASTS = """
const canvas = document.createElement('canvas').getContext('2d', {willReadFrequently: true});
const channels = (color) => {
  canvas.clearRect(0, 0, 1, 1); canvas.fillStyle = color; canvas.fillRect(0, 0, 1, 1);
  return [...canvas.getImageData(0, 0, 1, 1).data];
};
const luminance = ([r, g, b]) => [r, g, b].map((value) => value / 255)
  .map((value) => value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4)
  .reduce((sum, value, i) => sum + value * [0.2126, 0.7152, 0.0722][i], 0);
const ground = (element) => {
  for (let one = element; one; one = one.parentElement) {
    const color = channels(getComputedStyle(one).backgroundColor);
    if (color[3] === 255) return color;
  }
  return [255, 255, 255, 255];
};
const poor = new Set();
const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
let texts = 0;
while (walker.nextNode()) {
  const node = walker.currentNode, element = node.parentElement;
  if (!node.data.trim() || !element.getClientRects().length) continue;
  if (element.closest('script, style')) continue;
  const style = getComputedStyle(element);
  const drawn = element.closest('svg') ? style.fill : style.color;
  const [one, other] = [luminance(channels(drawn)), luminance(ground(element))];
  const ratio = (Math.max(one, other) + 0.05) / (Math.min(one, other) + 0.05);
  texts += 1;
  const name = `${element.tagName}.${element.getAttribute('class')}`;
  if (ratio < 4.5) poor.add(`${name} ${ratio.toFixed(2)}`);
}
return [texts, [...poor]];
"""


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("name", ["comparison", "validation"])
def test_every_text_has_enough_contrast(
    name: str, scheme: str, opened: Open, files: dict[str, Path]
) -> None:
    driver = opened(files[name])
    emulate(driver, prefers_color_scheme=scheme)
    texts, poor = js(driver, CONTRASTS)
    assert texts > 100
    assert poor == []
    # the check itself can fail
    grey = "rgb(130, 130, 130)" if scheme == "light" else "rgb(100, 100, 100)"
    js(driver, "document.querySelector('.lead').style.color = arguments[0]", grey)
    assert any(".lead" in one for one in js(driver, CONTRASTS)[1])


MARKS = """
const canvas = document.createElement('canvas').getContext('2d', {willReadFrequently: true});
const luminance = (color) => {
  canvas.fillStyle = color; canvas.fillRect(0, 0, 1, 1);
  return [...canvas.getImageData(0, 0, 1, 1).data].slice(0, 3).map((value) => value / 255)
    .map((value) => value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4)
    .reduce((sum, value, i) => sum + value * [0.2126, 0.7152, 0.0722][i], 0);
};
const paper = luminance(getComputedStyle(document.body).backgroundColor);
return [...document.querySelectorAll('svg [data-gid^=method] use')]
  .map((mark) => luminance(getComputedStyle(mark).stroke))
  .map((one) => (Math.max(one, paper) + 0.05) / (Math.min(one, paper) + 0.05));
"""


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_mark_can_be_told_from_the_paper(
    scheme: str, opened: Open, files: dict[str, Path]
) -> None:
    """WCAG 2.2 asks for a contrast of 3 between what is drawn and its ground."""
    driver = opened(files["eight methods"])
    emulate(driver, prefers_color_scheme=scheme)
    contrasts = js(driver, MARKS)
    assert len(contrasts) > 20
    assert min(contrasts) >= 3.0


AUDIT = """
const done = arguments[arguments.length - 1];
axe.run(document, {resultTypes: ['violations']}).then((found) => done(found.violations.map(
  (one) => `${one.id}: ${one.help}: ${one.nodes[0].html.slice(0, 200)}`)));
"""


@pytest.mark.parametrize("width", [400, 1280])
@pytest.mark.parametrize("name", ["comparison", "validation"])
def test_an_audit_by_others_finds_no_barrier(
    name: str, width: int, opened: Open, files: dict[str, Path]
) -> None:
    axe = pytest.importorskip("axe_core_python.base", reason="pip install -e '.[browser]'")
    driver = opened(files[name])
    resize(driver, width, 800)
    driver.refresh()
    driver.set_script_timeout(120)
    js(driver, axe.AXE_SCRIPT)
    assert driver.execute_async_script(AUDIT) == []
    # the audit can fail
    js(driver, "document.documentElement.removeAttribute('lang')")
    assert any("html-has-lang" in one for one in driver.execute_async_script(AUDIT))


@pytest.mark.parametrize("name", ["comparison", "eight methods", "validation", "much fails"])
def test_the_summary_fits_on_one_screen(name: str, opened: Open, files: dict[str, Path]) -> None:
    driver = opened(files[name])
    resize(driver, 1280, 800)
    bottom = js(driver, "return document.getElementById('summary').getBoundingClientRect().bottom")
    assert bottom <= 800


@pytest.mark.parametrize("name", ["comparison", "eight methods"])
def test_the_table_of_methods_is_whole_at_1200_pixels(
    name: str, opened: Open, files: dict[str, Path]
) -> None:
    """Its last column, the status, was cut off."""
    driver = opened(files[name])
    resize(driver, 1200, 800)
    area = "const area = document.getElementById('methods-in-short');"
    assert js(driver, f"{area} return area.scrollWidth <= area.clientWidth")
    assert js(driver, f"{area} return area.querySelector('td').getBoundingClientRect().right > 0")


@pytest.mark.parametrize("width", [320, 400, 768, 1280, 1920])
@pytest.mark.parametrize("name", ["comparison", "validation", "hostile"])
def test_no_width_makes_the_page_scroll_sideways(
    name: str, width: int, opened: Open, files: dict[str, Path]
) -> None:
    driver = opened(files[name])
    resize(driver, width, 800)
    assert js(driver, "return document.documentElement.scrollWidth") <= width


def test_print_shows_everything_but_the_controls(comparison: Any, tmp_path: Path) -> None:
    emulate(comparison, media="print", prefers_color_scheme="dark")
    assert js(comparison, "return getComputedStyle(document.body).backgroundColor") in (
        "rgb(255, 255, 255)",
        "rgba(0, 0, 0, 0)",
    )
    assert seen(comparison, "#curves svg") == 1
    for hidden in (".theme", ".table-tools", ".controls", "nav"):
        assert seen(comparison, hidden) == 0
    # a heading that holds a box of its own would not be repeated on the next page
    display = "return getComputedStyle(document.querySelector('th button')).display"
    assert js(comparison, display) == "contents"
    pdf = comparison.execute_cdp_cmd("Page.printToPDF", {"preferCSSPageSize": True})
    assert base64.b64decode(pdf["data"]).count(b"/Type /Page") >= 2


@pytest.mark.parametrize("name", ["comparison", "validation"])
def test_without_scripts_everything_is_there(
    name: str, opened: Open, files: dict[str, Path], records: pd.DataFrame
) -> None:
    driver = opened(files[name])
    driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
    driver.refresh()

    def evaluated(code: str) -> Any:
        found = driver.execute_cdp_cmd(
            "Runtime.evaluate", {"expression": code, "returnByValue": True}
        )
        return found["result"]["value"]

    assert evaluated("document.querySelectorAll('button, input, select').length") == 0
    assert evaluated("document.querySelectorAll('[hidden]').length") == 0
    charts = "[...document.querySelectorAll('svg.chart')]"
    assert evaluated(f"{charts}.length") >= 2 - (name == "validation")
    assert evaluated(f"{charts}.every((one) => one.getBoundingClientRect().height > 100)")
    titles = evaluated("document.querySelectorAll('svg use title').length")
    if name == "comparison":
        answers = records["pf"].notna().sum()
        assert titles > 2 * answers
        assert evaluated("document.querySelectorAll('#all-answers tbody tr').length") == len(
            records
        )
    driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})
