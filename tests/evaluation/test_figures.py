"""Figures: what is drawn, and that it is drawn the same again."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from matplotlib.patches import Ellipse, Rectangle
from PIL import Image

from evaluation.figures.categories import category_crops, typical_first
from evaluation.figures.drawing import PAGE_WIDTH, coarse, picture, save_figure
from evaluation.figures.fit import position_categories, word_distributions
from evaluation.figures.generation import MOST, generated_actions, generation, in_words, shown_of
from evaluation.figures.source import Source, by_log_joint, title
from model import Fit, save
from tests.synthetic import WORDS


def test_the_heat_map_holds_theta_of_the_categories_in_use(proposed: Fit) -> None:
    axes = word_distributions(proposed, WORDS, "title").axes[0]
    shown = np.asarray(axes.images[0].get_array())
    used = sum(len(np.unique(z)) for z in proposed.state.z)
    assert shown.shape == (used, len(proposed.trials.vocabulary))
    assert np.allclose(shown.sum(axis=1), 1.0)
    words = [label.get_text() for label in axes.get_xticklabels()]
    assert words == [word for own in WORDS.values() for word in own if word in proposed.trials.vocabulary]
    first_color = [label.get_text() for label in axes.get_yticklabels()].index("c1")
    k, w = np.unique(proposed.state.z[3])[0], proposed.trials.vocabulary.index("red")
    assert shown[first_color, words.index("red")] == np.exp(proposed.state.log_words[3][k, w])


def test_a_box_surrounds_each_channels_own_words(proposed: Fit) -> None:
    figure = word_distributions(proposed, WORDS, "title")
    boxes = [patch for patch in figure.axes[0].patches if isinstance(patch, Rectangle)]
    assert len(boxes) == 4
    heights = [box.get_height() for box in boxes]
    assert heights == [len(np.unique(z)) for z in proposed.state.z]


def test_ellipses_are_the_gaussians(proposed: Fit) -> None:
    """A point on the ellipse is at two standard deviations (Mahalanobis distance 2)."""
    figure = position_categories(proposed, "title")
    ellipses = [patch for patch in figure.axes[0].patches if isinstance(patch, Ellipse) and patch.get_fill()]
    used = np.unique(proposed.state.z[1])
    assert len(ellipses) == len(used)
    for ellipse, k in zip(ellipses, used, strict=True):
        outline = ellipse.get_patch_transform().transform(np.array([[1.0, 0.0], [0.0, 1.0], [0.6, 0.8]]))
        white = np.linalg.solve(proposed.state.factor[1][k], (outline[:, ::-1] - proposed.state.mean[1][k]).T)
        assert np.allclose(np.linalg.norm(white, axis=0), 2.0)


def test_left_is_left(proposed: Fit) -> None:
    axes = position_categories(proposed, "title").axes[0]
    left, right = axes.get_xlim()
    assert left > right


def test_the_same_figure_gives_the_same_bytes(proposed: Fit, out: Path) -> None:
    for name in ("a.png", "b.png", "a.pdf", "b.pdf"):
        save_figure(word_distributions(proposed, WORDS, "title"), out / name)
    assert (out / "a.png").read_bytes() == (out / "b.png").read_bytes()
    assert (out / "a.pdf").read_bytes() == (out / "b.pdf").read_bytes()


def test_a_figure_is_written_in_all_forms_at_once(proposed: Fit, out: Path) -> None:
    save_figure(word_distributions(proposed, WORDS, "title"), out / "a.png", out / "a.pdf")
    assert (out / "a.png").read_bytes().startswith(b"\x89PNG")
    assert (out / "a.pdf").read_bytes().startswith(b"%PDF")
    assert sorted(path.name for path in out.iterdir()) == ["a.pdf", "a.png"]


def test_colors_of_a_picture_stay(out: Path) -> None:
    """A palette for the whole picture would lose a color that few pixels have."""
    image = np.random.default_rng(1).integers(150, 200, (300, 400, 3)).astype(np.uint8)
    image[100:110, 100:110] = (250, 220, 40)
    save_figure(picture(image), out / "a.png")
    with Image.open(out / "a.png") as written:
        assert written.width == pytest.approx(PAGE_WIDTH * 180)
        scale = written.width / 400
        shown = np.asarray(written.convert("RGB"))[round(105 * scale), round(105 * scale)]
    assert np.abs(shown.astype(int) - (250, 220, 40)).max() <= 4
    assert np.abs(coarse(image).astype(int) - image).max() <= 2
    assert coarse(np.array([[[0, 255, 128]]], dtype=np.uint8)).tolist() == [[[0, 255, 130]]]


def test_typical_objects_come_first(proposed: Fit) -> None:
    ordered = typical_first(proposed, "object")
    z, features = proposed.state.z[2], proposed.trials.channels[2].features
    assert list(ordered) == sorted(set(z.tolist()))  # no category that is not in use
    for k, own in ordered.items():
        assert sorted(own.tolist()) == np.flatnonzero(z == k).tolist()
        covariance = proposed.state.factor[2][k] @ proposed.state.factor[2][k].T
        away = features[own] - proposed.state.mean[2][k]
        distances = [float(d @ np.linalg.inv(covariance) @ d) for d in away]
        assert distances == sorted(distances)


@pytest.mark.parametrize(("c", "channel"), [(2, "object"), (3, "color")])
def test_each_category_has_a_row_of_its_crops(proposed: Fit, c: int, channel: str) -> None:
    count = len(proposed.state.z[c])
    crops = np.empty((count, 64, 64, 3), dtype=np.uint8)
    crops[...] = (np.arange(count) * 255 // 63 % 256)[:, None, None, None]
    axes = category_crops(proposed, channel, crops, "title").axes[0]
    labels = [label.get_text() for label in axes.get_yticklabels()]
    used = np.unique(proposed.state.z[c])
    likely = [proposed.trials.vocabulary[int(proposed.state.log_words[c][k].argmax())] for k in used]
    assert labels == [f"{channel[0]}{i + 1} “{word}”" for i, word in enumerate(likely)]
    sheet = np.asarray(axes.images[0].get_array())
    ordered = typical_first(proposed, channel)
    for tick, k in zip(axes.get_yticks(), used, strict=True):
        assert sheet[int(tick), 32].tolist() == coarse(crops[ordered[k][0]])[32, 32].tolist()


def test_crops_of_other_objects_are_refused(proposed: Fit) -> None:
    with pytest.raises(ValueError, match="3 crops of"):
        category_crops(proposed, "object", np.zeros((3, 64, 64, 3), dtype=np.uint8), "title")


def test_the_most_probable_fit_is_shown(proposed: Fit, out: Path) -> None:
    paths = []
    for i, last in enumerate((-5.0, -3.0, -4.0, -3.0)):
        trace = proposed.trace_log_joint.copy()
        trace[-1] = last
        paths.append(out / f"{i}.npz")
        save(replace(proposed, trace_log_joint=trace), paths[-1])
    assert [place for place, _ in by_log_joint(paths)] == [1, 3, 2, 0]
    names = {"experiment": "own", "variant": "few", "method": "mmlda", "sampler": "mixing", "D": 20, "ROW": 9}
    shown = title(names, proposed, 1, 4)
    assert "own, (C) mMLDA, D = 20, ROW 9 %, K = 10," in shown
    assert "variant few, sampler mixing, seed 2 of 4" in shown


def test_actions_are_told_right_from_wrong() -> None:
    assert in_words("touch", "touch", 1.0)[0] == "touch: right word, right object"
    assert in_words("touch", "reach", 0.0)[0] == "reach: not touch, wrong object"
    assert in_words("touch", "touch", 0.5)[0] == "touch: right word, object chosen among equals"
    right = in_words("touch", "touch", 1.0)[1]
    assert right not in (in_words("touch", "reach", 1.0)[1], in_words("touch", "touch", 0.0)[1])


def test_only_the_first_generated_actions_are_read_and_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is beyond the limit is not opened either, and the title says how many there are."""
    count = MOST + 30
    columns = {"instruction": "touch cup", "action": "touch", "judged": "touch", "object_right": 1.0}
    answers = pd.DataFrame({"trial": range(1, count + 1)}).assign(**columns)
    picture, opened = np.zeros((3, 4, 3), dtype=np.uint8), list[Path]()
    seen = SimpleNamespace(image_before=picture, image_after=picture)
    module = "evaluation.figures.generation."
    monkeypatch.setattr(module + "read_answers", lambda path: answers)
    monkeypatch.setattr(module + "read_log", opened.append)
    monkeypatch.setattr(module + "observation", lambda log: seen)
    monkeypatch.setattr(Source, "most_probable", lambda self: (0, None, "own"))
    figure = generation(Source({}, {"answers": [Path("answers")], "logs": [Path("logs")]}, {}))
    assert len(opened) == len([axes for axes in figure.axes if axes.images]) == MOST
    assert figure.get_suptitle().endswith(f"own; the first {MOST} of {count} instructions")
    assert shown_of(12, 12) == ""


def test_each_generated_action_has_its_pictures() -> None:
    answered = pd.DataFrame(
        {
            "trial": [1, 2, 3, 4],
            "instruction": ["touch cup"] * 4,
            "action": ["touch"] * 4,
            "judged": ["touch", "reach", "touch", "touch"],
            "object_right": [1.0, 1.0, 0.0, 1.0],
        }
    )
    before, after = np.zeros((300, 400, 3), dtype=np.uint8), np.full((300, 400, 3), 255, dtype=np.uint8)
    figure = generated_actions(answered, [(before, after)] * 4, "title")
    drawn = [axes for axes in figure.axes if axes.images]
    assert [axes.get_title(loc="left") for axes in drawn] == [f"{trial}. “touch cup”" for trial in (1, 2, 3, 4)]
    pair = np.asarray(drawn[0].images[0].get_array())
    assert (pair[:, : pair.shape[1] // 3] == 0).all()
    assert (pair[:, -pair.shape[1] // 3 :] == 255).all()
