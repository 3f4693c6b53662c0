"""What a robot makes of a sentence, which robot is meant, and the commands on results of one's own features."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from evaluation.__main__ import main
from evaluation.generation import objects_of
from evaluation.talk.robots import Robot, RobotName, TalkError, choose, robots_of
from evaluation.talk.understanding import hear, learned_channels, word_channels, words_of
from features.table import FeatureTable, write_table
from model import Fit, save
from model.data import Floats
from model.prediction import responsibilities, understand
from tests.evaluation.conftest import fit_of
from tests.evaluation.hand_made import scores_of

NAME = RobotName("own", "default", "proposed", "published", 12, 0, 1)


def robot_of(fit: Fit) -> Robot:
    return Robot(NAME, fit, "own", None)


def listed(fit: Fit, objects: dict[str, Floats], words: list[str]) -> Floats:
    """(N, C) the posterior of the words' channels, every frame, object and category by itself."""
    state, vocabulary = fit.state, fit.trials.vocabulary
    known, C = [vocabulary.index(word) for word in words], len(fit.trials.channels)
    weights = [responsibilities(state, fit.trials.index_of(name), rows) for name, rows in objects.items()]
    theta = [np.exp(log_words) for log_words in state.log_words]
    total = np.zeros((len(words), C))
    evidence = 0.0
    # A word that no channel explains is in the frames as −1; surplus ones are probable as any other word.
    prior = fit.problem.frame_prior
    limit, none = prior.most_per_channel, np.full(len(vocabulary), 1.0 / len(vocabulary))
    if prior.has_none:
        none = theta[C][0]
    for frame in product(range(-1, C), repeat=len(words)):
        counts = [frame.count(c) for c in range(C)]
        surplus = max(0, len(words) - C) if limit == 1 else 0
        if max(counts) > limit or (frame.count(-1) != surplus and not prior.has_none):
            continue
        named, N = len(words) - frame.count(-1), len(words)
        ways = math.perm(C, named) if limit == 1 else C**named
        frame_p = 1.0 / math.comb(N, named) / ways if prior.has_none else 1.0
        for m in range(len(weights[0])):
            p = frame_p * float(np.prod([none[w] for w, x in zip(known, frame, strict=True) if x < 0]))
            for c in range(C):
                own = [w for w, x in zip(known, frame, strict=True) if x == c]
                share = np.exp(state.log_weights[0]) if c == 0 else np.exp(weights[c - 1][m])
                p *= float(np.sum(share * np.prod(theta[c][:, own], axis=1)))
            evidence += p
            for n, c in enumerate(frame):
                if c >= 0:
                    total[n, c] += p
    return np.asarray(total / evidence)


@pytest.mark.parametrize("method", ["proposed", "no_mec2", "proposed_open", "no_mec2_open"])
@pytest.mark.parametrize("sentence", ["grasp", "red cup", "cup cup left", "grasp left red cup reach"])
def test_the_channels_of_words_are_sums_over_frames(method: str, sentence: str, table: FeatureTable) -> None:
    fit, words = fit_of(table, method), sentence.split()
    told = word_channels(fit, objects_of(table, 1), words)
    names = [channel.name for channel in fit.trials.channels]
    expected = listed(fit, objects_of(table, 1), words)
    assert np.allclose([[one[name] for name in names] for one in told], expected)


def test_a_sentence_is_heard_as_in_the_study(proposed: Fit, table: FeatureTable) -> None:
    told = hear(robot_of(proposed), table, 2, "grasp the red cup")
    answer = understand(proposed, objects_of(table, 2), ["grasp", "the", "red", "cup"])
    assert np.array_equal(told.answer.log_scores, answer.log_scores)
    assert told.unknown == ("the",)
    assert [word.known for word in told.words] == [True, False, True, True]
    assert told.words[1].channels is None
    assert told.objects.sum() == pytest.approx(1.0)
    assert told.categories.sum() == pytest.approx(1.0)
    assert told.chosen == tuple(sorted({m for m, _ in answer.choices()}))


def test_a_method_without_frames_tells_no_channels(table: FeatureTable) -> None:
    fit = fit_of(table, "mmlda")
    told = hear(robot_of(fit), table, 0, "red cup")
    assert [word.channels for word in told.words] == [None, None]
    assert set(learned_channels(fit).values()) == {None}


def test_the_channel_of_a_known_word_is_the_one_that_explained_it_most(proposed: Fit) -> None:
    told, trials = learned_channels(proposed), proposed.trials
    assert list(told) == sorted(trials.vocabulary)
    for word, channel in told.items():
        own = proposed.state.F[trials.words[0] == trials.vocabulary.index(word)]
        assert channel == trials.channels[int(np.bincount(own, minlength=4).argmax())].name


def test_nothing_said_leaves_any_object(proposed: Fit, table: FeatureTable) -> None:
    told = hear(robot_of(proposed), table, 0, "  ")
    assert told.words == ()
    assert np.allclose(told.objects, 1 / len(told.objects))


@pytest.mark.parametrize(
    ("sentence", "words"),
    [
        ("Grasp the RED cup!", ("grasp", "the", "red", "cup")),
        ("look-at … “cup”, -- please.", ("look-at", "cup", "please")),
        ("<b>cup</b>", ("b>cup</b",)),
        ("ＣＵＰ \u200b кружка", ("ＣＵＰ", "\u200b", "кружка")),
    ],
)
def test_case_and_punctuation_do_not_matter(sentence: str, words: tuple[str, ...]) -> None:
    assert words_of(sentence, ("cup", "grasp", "look-at", "red")) == words


@pytest.mark.parametrize(
    ("sentence", "message"),
    [("cup " * 41, r"41 words \(at most 40"), ("c" * 2000, r"2,000 characters \(at most 1,000")],
)
def test_a_sentence_that_is_too_long_is_refused(sentence: str, message: str) -> None:
    with pytest.raises(TalkError, match=message):
        words_of(sentence, ())


@pytest.fixture(scope="module")
def own(table: FeatureTable, proposed: Fit, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The results of a study of own features: two seeds of the proposed method, one of mMLDA, no simulation."""
    results = tmp_path_factory.mktemp("own_results")
    folder = results / "features" / "mine" / "D12"
    folder.mkdir(parents=True)
    write_table(table, folder / "train_trials.parquet", folder / "train_objects.parquet")
    better = replace(proposed, trace_log_joint=proposed.trace_log_joint + 1.0)
    fits = {("proposed", 1): proposed, ("proposed", 2): better, ("mmlda", 1): fit_of(table, "mmlda")}
    artifacts = {}
    for (method, seed), fit in fits.items():
        path = RobotName("own", "default", method, "published", 12, 0, seed).path
        (results / path).parent.mkdir(parents=True, exist_ok=True)
        save(fit, results / path)
        artifacts[path] = {"inputs": {"trials": {"path": "features/mine/D12/train_trials.parquet"}}}
    (results / "manifest.json").write_text(json.dumps({"artifacts": artifacts}))
    values = {("csl", "mmlda", 12, 0, "ARI_a"): [1.0], ("csl", "proposed", 12, 0, "ARI_a"): [1.0, 1.0, 1.0]}
    scores_of(values, experiment="own").to_csv(results / "scores.csv", index=False)
    return results


def test_the_most_probable_fit_of_the_proposed_method_is_meant(own: Path) -> None:
    robots = robots_of(own)
    assert [(name.method, name.seed) for name in robots] == [("mmlda", 1), ("proposed", 1), ("proposed", 2)]
    assert choose(own, robots, {}) == RobotName("own", "default", "proposed", "published", 12, 0, 2)
    assert choose(own, robots, {"method": "mmlda", "seed": None}).method == "mmlda"


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"method": "mlda"}, r"method: no fit with 'mlda' \(allowed: mmlda, proposed\)"),
        ({"method": "mmlda", "seed": 2}, r"seed: no fit with 2 \(allowed: 1\)"),
    ],
)
def test_a_robot_that_is_not_there_is_refused(own: Path, asked: dict[str, str | int | None], message: str) -> None:
    with pytest.raises(TalkError, match=message):
        choose(own, robots_of(own), asked)


def test_own_features_are_understood_and_not_acted_on(
    own: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    clip = tmp_path / "clip.gif"
    assert main(["tell", str(own), "grasp the red cup", "--scene", "3", "--out", str(clip)]) == 0
    printed = capsys.readouterr().out
    assert "scene 3" in printed
    assert "the" in printed
    assert "unknown: the robot never heard it" in printed
    assert printed.count("← this one") >= 1
    assert printed.endswith("so the robot understands but cannot act\n")
    assert not clip.exists()


def test_why_no_channels_are_told(own: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["tell", str(own), "cup " * 9, "--no-action"]) == 0
    assert capsys.readouterr().out.count("the channels of more than 8 known words are not told") == 9
    assert main(["tell", str(own), "cup", "--method", "mmlda", "--no-action"]) == 0
    assert "every channel explains it: (C) mMLDA has no frames" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["cup", "--scene", "99"], "there is no scene 99 (allowed: 1 to 12)"),
        (["cup", "--draw", "1"], "mine: scenes are not simulated, so that none can be drawn"),
        (["cup " * 40], "a sentence of 40 words (at most 12 are allowed)"),
        (["cup", "--sampler", "mixed"], "sampler: no fit with 'mixed' (allowed: published)"),
    ],
)
def test_what_cannot_be_told_is_refused(
    own: Path, arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["tell", str(own), *arguments]) == 2
    assert message in capsys.readouterr().err


def test_a_folder_without_a_study_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for arguments in (["tell", str(tmp_path), "cup"], ["describe", str(tmp_path)], ["talk", str(tmp_path)]):
        assert main(arguments) == 2
        assert "is no folder of a finished study" in capsys.readouterr().err


def test_a_robot_of_own_features_does_nothing_to_describe(own: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["describe", str(own)]) == 2
    assert "there is no record of what the robot did" in capsys.readouterr().err
