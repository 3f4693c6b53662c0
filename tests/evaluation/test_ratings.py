"""Human raters: a blind form, its key, and what comes of filled-in forms."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from evaluation.__main__ import main
from evaluation.ratings import (
    FORM_COLUMNS,
    Rating,
    RatingError,
    human_rates,
    make_key,
    read_forms,
    read_key,
    write_form,
    write_page,
)
from evaluation.scores import write_csv
from tests.browser import DOWNLOADED, needs_chromium, use

ALLOWED = ["reach", "touch", "look-at"]
CONDITION = {
    "experiment": "own", "dataset": 1, "variant": "default", "sampler": "published",
    "D": 40, "ROW": 0, "seed": 3,
}  # fmt: skip


def rows() -> list[dict[str, object]]:
    """Three instructions of two methods; the tutor judges that mmlda always reaches."""
    return [
        CONDITION | {"method": method, "trial": trial, "instructed": word, "judged": judged or word}
        for method, judged in (("mmlda", "reach"), ("proposed", None))
        for trial, word in enumerate(ALLOWED, start=1)
    ]


def named(text: str) -> str:
    """A text with the names of the clips of `key`, which hold a digest."""
    digest = make_key(rows(), ALLOWED, np.random.default_rng(1))["clip"][0].split("_")[1]
    return text.replace("clip_0", f"clip_{digest}_0")


@pytest.fixture
def key() -> pd.DataFrame:
    return make_key(rows(), ALLOWED, np.random.default_rng(1))


def fill(key: pd.DataFrame, path: Path, rater: str, words: dict[str, str], delimiter: str = ",") -> Path:
    """Fill in a form as a person does in a spreadsheet."""
    write_form(key, path)
    with path.open(encoding="utf-8") as file:
        form = list(csv.DictReader(file))
    with path.open("w", encoding="utf-8-sig", newline="") as file:
        writer = csv.DictWriter(file, FORM_COLUMNS, delimiter=delimiter)
        writer.writeheader()
        writer.writerows(row | {"rater": rater, "word": words.get(row["clip"], "")} for row in form)
    return path


def test_the_form_is_blind(key: pd.DataFrame, out: Path) -> None:
    write_form(key, out / "form.csv")
    text = (out / "form.csv").read_text()
    assert text.splitlines()[:2] == ["clip,rater,word,allowed", named("clip_001,,,reach touch look-at")]
    assert not any(word in text for word in ("proposed", "mmlda", "own"))
    # Clips of one method do not stand together, and the same seed gives the same order.
    assert list(key["method"]) != sorted(key["method"])
    assert list(key["method"]) != sorted(key["method"], reverse=True)
    assert key.equals(make_key(rows(), ALLOWED, np.random.default_rng(1)))
    assert sorted(zip(key["method"], key["trial"], strict=True)) == sorted((r["method"], r["trial"]) for r in rows())


@pytest.mark.bad_input
def test_a_form_for_an_earlier_key_is_not_counted(key: pd.DataFrame, out: Path) -> None:
    for other in (
        make_key(rows(), ALLOWED, np.random.default_rng(2)),
        make_key(rows(), ALLOWED[:2], np.random.default_rng(1)),
    ):
        form = fill(other, out / "form.csv", "Ann", dict.fromkeys(other["clip"], "reach"))
        with pytest.raises(RatingError, match="is unknown"):
            read_forms([form], key)


def test_human_and_automatic_rates(key: pd.DataFrame, out: Path) -> None:
    instructed = dict(zip(key["clip"], key["instructed"], strict=True))
    method = dict(zip(key["clip"], key["method"], strict=True))
    # Ann sees what was asked for everywhere; Bob sees it of proposed only, and of mmlda rates reach clips alone.
    ann = fill(key, out / "ann.csv", "Ann", instructed)
    words = {c: w if method[c] == "proposed" else "touch" for c, w in instructed.items() if w != "look-at"}
    bob = fill(key, out / "bob.csv", "Bob", words, delimiter=";")
    rates = human_rates(read_forms([ann, bob], key), key).set_index("method")
    assert list(rates.index) == ["proposed", "mmlda"]
    assert list(rates["raters"]) == [2, 2]
    assert list(rates["ratings"]) == [5, 5]
    assert rates["human_WAR"].tolist() == [1.0, (1.0 + 0.5) / 2]
    assert rates["human_WAR_sd"].tolist() == pytest.approx([0.0, np.sqrt(2 * 0.25**2)])
    assert rates["automatic_WAR"].tolist() == pytest.approx([1.0, 1 / 3])
    assert rates["agreement"].tolist() == pytest.approx([1.0, 1 / 5])


def test_one_rater_has_no_spread(key: pd.DataFrame) -> None:
    rates = human_rates([Rating(named("clip_001"), "Ann", "reach")], key)
    assert rates["raters"].tolist() == [1]
    assert rates["human_WAR_sd"].isna().all()


@pytest.mark.bad_input
@pytest.mark.parametrize(
    ("lines", "says"),
    [
        ("clip,rater,word\nclip_007,Ann,reach", "line 2: clip 'clip_007' is unknown (allowed: clip_001 to clip_006)"),
        ("clip,rater,word\n\nclip_001,Ann,push", "line 3: 'push' is not a word to choose (allowed: reach, touch"),
        ("clip,rater,word\nclip_001,,reach", "line 2: the rater is missing"),
        ("clip,rater,word\nclip_001,Ann,reach\nclip_001,Ann,touch", "line 3: Ann has rated clip_001 before, in "),
        ("clip,rater,word\nclip_001,Ann,\n", "no clip is rated"),
        ("clip,word\nclip_001,reach\n", "the columns rater are missing"),
        ("clip,rater,word\nclip_001\n", "no clip is rated"),
        ("", "no form, the columns clip, rater, word are missing"),
        (b"\xff\xfe\x00", "cannot be read"),
        (None, "cannot be read"),
    ],
)  # fmt: skip
def test_forms_that_cannot_be_counted(key: pd.DataFrame, out: Path, lines: str | bytes | None, says: str) -> None:
    path = out / "form.csv"
    if lines is not None:
        path.write_bytes(lines if isinstance(lines, bytes) else named(lines).encode())
    with pytest.raises(RatingError) as caught:
        read_forms([path], key)
    assert named(says) in str(caught.value)
    assert str(path) in str(caught.value)


@pytest.mark.bad_input
def test_all_that_is_wrong_is_said_at_once(key: pd.DataFrame, out: Path) -> None:
    (out / "form.csv").write_text(named("clip,rater,word\nclip_9,Ann,reach\nclip_001,Ann,x\nclip_002,Ann,reach\n"))
    with pytest.raises(RatingError) as caught:
        read_forms([out / "form.csv", out / "form.csv"], key)
    assert len(caught.value.problems) == 5


@pytest.mark.bad_input
def test_a_form_is_no_key(key: pd.DataFrame, out: Path) -> None:
    write_form(key, out / "form.csv")
    with pytest.raises(RatingError, match="no key, the columns experiment"):
        read_key(out / "form.csv")
    with pytest.raises(RatingError, match="cannot be read"):
        read_key(out / "nothing.csv")


def test_the_command(key: pd.DataFrame, out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_csv(key, out / "key.csv")
    form = fill(key, out / "form.csv", "Ann", dict.fromkeys(key["clip"], "reach"))
    arguments = ["ratings", str(form), "--key", str(out / "key.csv")]
    assert main([*arguments, "--out", str(out / "rates.csv")]) == 0
    assert "human_WAR" in capsys.readouterr().out
    assert pd.read_csv(out / "rates.csv")["human_WAR"].tolist() == pytest.approx([1 / 3, 1 / 3])
    form.write_text(named("clip,rater,word\nclip_001,Ann,push\n"))
    assert main(arguments) == 2
    assert "'push' is not a word to choose" in capsys.readouterr().err


def test_the_page_offers_each_clips_words(out: Path) -> None:
    write_page([("clip_001", "clips/clip_001.gif", ["reach", "<b>"])], "Title & more", out / "index.html")
    page = (out / "index.html").read_text()
    assert "<title>Title &amp; more</title>" in page
    assert '<img src="clips/clip_001.gif"' in page
    assert 'name="clip_001" value="reach"' in page
    assert 'value="&lt;b&gt;"' in page
    assert "<b>" not in page
    assert "$" not in page


@needs_chromium
def test_a_browser_saves_the_filled_in_form(key: pd.DataFrame, out: Path) -> None:
    """What a rater does, in a real browser: choose words, forget the name, enter it, save. The file is counted."""
    clips = [(row.clip, f"{row.clip}.gif", row.allowed.split()) for row in key.itertuples()]
    write_page(clips, "Title", out / "index.html")
    chosen = dict(zip(key["clip"], key["instructed"], strict=True))
    unrated, _ = chosen.popitem()
    choose = f"""for (const [clip, word] of Object.entries({json.dumps(chosen)}))
        document.querySelector(`input[name="${{clip}}"][value="${{word}}"]`).click()"""
    save = 'document.getElementById("save").click(), document.getElementById("said").textContent'
    name = 'document.getElementById("rater").value = "Ann \\"A\\", B"'
    _, nameless, _, said, path = use(out / "index.html", [choose, save, name, save, DOWNLOADED], out)
    assert nameless == "Please enter your name."
    assert said == "5 of 6 clips rated."
    assert path.name == "form_Ann__A___B.csv"
    assert list(out.glob("*.csv")) == [path]
    ratings = read_forms([path], key)
    assert {rating.clip: rating.word for rating in ratings} == chosen
    assert {rating.rater for rating in ratings} == {'Ann "A", B'}
    assert unrated in path.read_text()
    assert human_rates(ratings, key)["human_WAR"].tolist() == [1.0, 1.0]
