"""The report page: what it says, that it is one file, and that a browser shows it."""

import base64
import io
import re
import shutil
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from neol.base.errors import UserError
from neol.study.campaign.grid import cells
from neol.study.claims.answers import answers
from neol.study.claims.ledger import write_ledger
from neol.study.claims.questions import load_claims, load_questions
from neol.study.outcomes.campaign_runs import Campaign
from neol.study.outcomes.effects import effect_sizes, selection_bias
from neol.study.outcomes.outcomes import gather
from neol.study.output.sidecar import write_sidecar
from neol.study.report.page import page
from neol.study.report.showcase import Showcase, Shown, best_champion
from neol.study.tables import agreement, paper_tables
from neol.study.workflow.exhibits import exhibits
from tests.helpers.made_up import configuration, write_campaign

CHROMIUM = (
    shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
)
QUIET = [
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--no-first-run",
]  # fmt: skip
SECTIONS = (
    "short", "claims", "tables", "figures", "beyond", "champions", "failed", "assumptions", "cost",
    "records",
)  # fmt: skip


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Campaign:
    """CartPole alone; BCM's second seed does best."""
    results = tmp_path_factory.mktemp("results")
    budget = configuration()
    bcm = next(cell for cell in cells(budget) if cell.method == "bcm")
    write_campaign(results, budget, {bcm: [8.0, 9.0, 7.0]}, otherwise=7.0)
    return Campaign(budget, results)


@pytest.fixture(scope="module")
def figures(campaign: Campaign, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The campaign's tables and claims, and a grey picture for each figure."""
    folder = tmp_path_factory.mktemp("figures")
    sources = campaign.sources(cells(campaign.configuration))
    for number in range(1, 9):
        getattr(paper_tables, f"table{number}")(campaign).write(folder)
    for number in (1, 2, 7, 8):
        getattr(agreement, f"numbers{number}")(campaign).write(folder)
    for each in exhibits(campaign.configuration.budget, "figures", "beyond"):
        picture = folder / f"{each.name}.png"
        Image.new("L", (900, 300), 128).save(picture)
        write_sidecar([picture], campaign.configuration, sources)
    outcomes = gather(campaign)
    write_ledger(folder, answers(load_questions(), outcomes), load_claims(), campaign)
    for name, table in {
        "beyond_effects": effect_sizes(outcomes, campaign.configuration.budget),
        "beyond_selection": selection_bias(outcomes),
    }.items():
        table.to_csv(folder / f"{name}.csv", index=False)
        both = [folder / f"{name}.png", folder / f"{name}.csv"]
        write_sidecar(both, campaign.configuration, sources)
    return folder


@pytest.fixture(scope="module")
def champions(campaign: Campaign, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One that was filmed and one that was not."""
    path = tmp_path_factory.mktemp("champions") / "champions.json"
    record = campaign.sources(cells(campaign.configuration))[0].path
    filmed = Shown(
        task="cartpole", record=record, seed=1, title="CartPole: <BCM>, seed 1",
        nodes=2, connections=8, fitness=9.0, held_out=8.0, episode_return=8.0, not_filmed=None,
        network=picture("png"), film=picture("gif"),
    )  # fmt: skip
    reason = {"task": "hopper", "episode_return": None, "not_filmed": "no EGL", "film": None}
    unfilmed = filmed.model_copy(update=reason)
    showcase = Showcase(champions=(filmed, unfilmed))
    path.write_text(showcase.model_dump_json())
    return path


def picture(kind: str) -> bytes:
    buffer = io.BytesIO()
    Image.new("L", (600, 200), 200).save(buffer, format=kind)
    return buffer.getvalue()


@pytest.fixture(scope="module")
def text(campaign: Campaign, figures: Path, champions: Path) -> str:
    return page(campaign, figures, champions)


class Outline(HTMLParser):
    """What a test asks of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.ids: Counter[str] = Counter()
        self.links: list[str] = []
        self.sources: list[str] = []
        self.alternatives: list[str | None] = []
        self.levels: list[int] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        given = dict(attributes)
        if "id" in given:
            self.ids[given["id"] or ""] += 1
        if tag == "a":
            self.links.append(given["href"] or "")
        if tag == "img":
            self.sources.append(given["src"] or "")
            self.alternatives.append(given["alt"])
        if re.fullmatch(r"h[1-6]", tag):
            self.levels.append(int(tag[1]))


def test_every_section_is_there_and_every_link_resolves(text: str) -> None:
    outline = Outline(text)
    assert set(SECTIONS) <= outline.ids.keys()
    links = {link.removeprefix("#") for link in outline.links if link.startswith("#")}
    assert len(links) > 20
    assert links <= outline.ids.keys()
    full_size = {link for link in outline.links if not link.startswith("#")}
    assert {"figure2.png", "beyond_effects.png"} <= full_size
    assert max(outline.ids.values()) == 1


def test_it_is_one_file(text: str) -> None:
    outline = Outline(text)
    assert all(source.startswith("data:image/") for source in outline.sources)
    content = base64.b64encode(picture("gif")).decode()
    assert f"data:image/gif;base64,{content}" in outline.sources
    assert not re.search(r"(?:src|href)\s*=(?!\"#|\"data:|\"[a-z]+_?[a-z0-9]*\.png\")", text)
    assert "url(" not in text
    assert "@import" not in text


def test_pictures_have_words_and_headings_are_in_order(text: str) -> None:
    outline = Outline(text)
    assert all(outline.alternatives)
    assert outline.levels[0] == 1
    assert all(
        after - before <= 1
        for before, after in zip(outline.levels, outline.levels[1:], strict=False)
    )


def test_it_names_its_budget_and_marks_it_as_reduced(text: str) -> None:
    assert "Budget smoke" in text
    assert "Reduced budget: not the paper&#39;s." in text


def test_a_question_has_its_answer_its_parts_and_its_quotes(text: str) -> None:
    question = text.split('id="claim-cartpole-ceiling"')[1].split("</details>")[0]
    assert '<span class="verdict not-asked-here">not asked here</span>' in question
    assert "The budget lacks the paper&#39;s cells." in question
    assert question.count('<tr><th scope="row">CartPole: ') == 5
    assert "<q>In the simpler CartPole task, all methods rapidly converge" in question


def test_foreign_text_is_escaped_and_an_unfilmed_champion_says_why(text: str) -> None:
    assert "CartPole: &lt;BCM&gt;, seed 1" in text
    assert "Not filmed: no EGL" in text


def test_every_record_is_listed_once_with_its_digest(text: str, campaign: Campaign) -> None:
    sources = campaign.sources(cells(campaign.configuration))
    for source in sources:
        assert text.count(f'<tr id="{source.path}">') == 1
        assert source.sha256[:12] in text


def test_a_missing_picture_is_said(campaign: Campaign, figures: Path, tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"champions\.json: cannot be read .*make report"):
        page(campaign, figures, tmp_path / "champions.json")


@pytest.mark.parametrize("name", ["table1.csv", "figure2.png", "claims.csv"])
def test_a_file_that_changed_is_refused(
    name: str, campaign: Campaign, figures: Path, champions: Path, tmp_path: Path
) -> None:
    altered = shutil.copytree(figures, tmp_path / "figures")
    with (altered / name).open("ab") as file:
        file.write(b"\n")
    with pytest.raises(UserError, match=rf"{name}: changed since \w+\.json was written"):
        page(campaign, altered, champions)


def test_a_table_of_other_records_is_refused(
    campaign: Campaign, figures: Path, champions: Path, tmp_path: Path
) -> None:
    altered = shutil.copytree(figures, tmp_path / "figures")
    table = paper_tables.table1(campaign)
    replace(table, frame=table.frame.assign(mean=8.5)).write(altered)
    with pytest.raises(UserError, match=r"table1\.csv: not what the records say now; `snakemake"):
        page(campaign, altered, champions)


def test_lines_beneath_are_marked(text: str) -> None:
    assert '<tr class="beneath"><th scope="row">' in text
    assert text.count("<thead>") == text.count("<table>")


def test_the_best_champion_is_best_in_fresh_episodes(campaign: Campaign) -> None:
    best = best_champion(campaign, "cartpole")
    assert best is not None
    cell, seed = best
    assert (cell.method, seed) == ("bcm", 1)
    assert best_champion(campaign, "hopper") is None


@pytest.fixture(scope="module")
def browser() -> Iterator[object]:
    playwright = pytest.importorskip("playwright.sync_api")
    if CHROMIUM is None:
        pytest.skip("no Chromium on this machine: apt install chromium")
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=CHROMIUM, args=QUIET)
        yield browser
        browser.close()


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [375, 1200])
def test_in_a_browser(browser, text: str, tmp_path: Path, width: int, scheme: str) -> None:
    """No complaint, no request, nothing wider than the screen; a link into a fold opens it."""
    path = tmp_path / "report.html"
    path.write_text(text, encoding="utf-8")
    opened = browser.new_page(viewport={"width": width, "height": 800}, color_scheme=scheme)
    said: list[str] = []
    asked: list[str] = []
    opened.on("console", lambda message: said.append(message.text))
    opened.on("pageerror", lambda error: said.append(str(error)))
    opened.on("request", lambda request: asked.append(request.url))
    opened.goto(path.as_uri())
    assert said == []
    assert [url for url in asked if not url.startswith(("data:", path.as_uri()))] == []
    for fold in opened.locator("details").all():
        fold.evaluate("fold => fold.open = true")
    assert opened.evaluate("document.documentElement.scrollWidth") <= width
    assert all(opened.locator("img").evaluate_all("all => all.map(each => each.naturalWidth > 0)"))
    for section in SECTIONS:
        assert opened.locator(f"#{section}").is_visible()
    opened.reload()
    fold = opened.locator("#records details")
    assert fold.get_attribute("open") is None
    opened.evaluate("location.hash = document.querySelector('#records tr[id]').id")
    opened.wait_for_function("document.querySelector('#records details').open")
    opened.close()


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_stands_out(browser, text: str, tmp_path: Path, scheme: str) -> None:
    """Contrast of text to its background is at least 4.5 (WCAG 2, level AA)."""
    path = tmp_path / "report.html"
    path.write_text(text, encoding="utf-8")
    opened = browser.new_page(color_scheme=scheme)
    opened.goto(path.as_uri())
    style = opened.evaluate(
        """() => {
            const style = getComputedStyle(document.documentElement);
            const names = [...style].filter((name) => name.startsWith("--"));
            const value = (name) => style.getPropertyValue(name).trim();
            return Object.fromEntries(names.map((name) => [name, value(name)]));
        }"""
    )
    for name in ("text", "soft", "link", "reproduced", "not-reproduced", "open"):
        for behind in ("page", "card"):
            assert contrast(style[f"--{name}"], style[f"--{behind}"]) >= 4.5, (name, behind)
    opened.close()


def contrast(one: str, other: str) -> float:
    """The ratio of two colours' relative luminances, as WCAG 2 has it."""
    brighter, darker = sorted((luminance(one), luminance(other)), reverse=True)
    return (brighter + 0.05) / (darker + 0.05)


def luminance(colour: str) -> float:
    channels = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
    linear = np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


def test_contrast_of_black_on_white() -> None:
    assert contrast("#000000", "#ffffff") == pytest.approx(21)
