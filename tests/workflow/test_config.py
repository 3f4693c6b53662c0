"""Configs: every key broken in every way that its type allows, and contradictions between keys."""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from jsonschema import Draft202012Validator
from pydantic import ValidationError

from data_collection.limits import NAME_PATTERN, NAME_RULE, PATH_PATTERN, WORD_PATTERN, WORD_RULE
from evaluation.figures.catalogue import FIGURES
from tests.fuzz import FEW, MANY, MUTATIONS, Mutation, examples, mutated
from tests.synthetic import WORDS
from tests.workflow.configs import FILE, minimal
from tests.workflow.violations import broken, sample
from workflow.artifacts.provenance import ROOT
from workflow.plan.config import ConfigError, read_config
from workflow.plan.loading import load_study, plan
from workflow.plan.problems import key_path
from workflow.plan.problems import problems_of as told
from workflow.plan.schema import config_schema, inner
from workflow.plan.study_config import StudyConfig

GOOD = (ROOT / "config" / "smoke.yaml").read_bytes()
EXPERIMENT = inner(inner(config_schema(), "experiments"), "own")
KEYS = sorted(EXPERIMENT["properties"])
SAMPLERS = inner(inner(config_schema(), "samplers"), "own")["discriminator"]["mapping"]
OVERRIDES: dict[str, Any] = {
    "words": WORDS,
    "K": {"action": 3, "position": 4, "object": 5, "color": 6},
    "variants": {
        "small_alpha": {
            "alpha": 0.1,
            "gamma": {"action": 0.2},
            "mean_precision": 0.1,
            "scale": 0.5,
            "extra_degrees_of_freedom": 3.0,
            "K": 7,
            "only": {"methods": ["proposed"], "samplers": ["slow"], "D": [20], "ROW": [0]},
        }
    },
    "figure": {"variant": "small_alpha", "method": "proposed", "samplers": ["slow"], "D": 20, "ROW": 0},
    "samplers": {
        kind: sample({"$ref": f"#/$defs/{kind.capitalize()}"}, {}) | {"kind": kind}
        for kind in ("blocked", "collapsed")
    },
    "data": "simulator",
    "trials": 40,
    "D": [20],
    "ROW": [0],
    "generation": {"sentences": 12, "D": [20], "ROW": [0], "rated": 1},
    "description": {"actions": 12, "D": [20], "ROW": [0]},
    "features": {"trials": "trials.parquet", "objects": "objects.parquet"},
    "logs": "logs",
}


SIMULATION: dict[str, Any] = {
    "objects": [
        {"object": "cup", "color": "red", "shape": "cup", "size": 0.05, "height": 0.05}
        | {"style": 0, "shade": 0, "mass": 0.06}
    ],
    "objects_most": 1,
}


def everything() -> dict[str, Any]:
    """A config that sets every key that there is."""
    overrides = OVERRIDES | {"simulation": sample(EXPERIMENT["properties"]["simulation"], SIMULATION)}
    own = sample(EXPERIMENT, overrides)
    return {key: own[key] for key in ("seed", "methods", "samplers")} | {"experiments": {"own": own}}


def cases() -> list[Any]:
    found = broken(config_schema(), everything())
    return [pytest.param(path, wrong, id=f"{key_path(path)}: {label}"[:150]) for label, path, wrong in found]


def schema_problems(config: dict[str, Any]) -> list[str]:
    try:
        StudyConfig.model_validate(config)
    except ValidationError as error:
        return told(error, config)
    return []


CASES = cases()


def problems_of(config: dict[str, Any]) -> tuple[str, ...]:
    with pytest.raises(ConfigError) as caught:
        plan(config, FILE)
    return caught.value.problems


def test_the_config_that_is_broken_below_is_valid() -> None:
    assert schema_problems(everything()) == []


def test_every_key_is_broken_somehow() -> None:
    """No key of the config, however deep, is without a broken case."""
    broken = {tuple(part for part in path if isinstance(part, str)) for path, _ in (case.values for case in CASES)}

    def leaves(value: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
        for key, found in value.items() if isinstance(value, dict) else ():
            yield (*path, key)
            yield from leaves(found, (*path, key))

    free = {("words",), ("colors",), ("places",)}  # mappings of free names are broken by their first entry
    missing = [path for path in leaves(everything()) if path not in broken and path[-2:-1] not in free]
    assert missing == []


@pytest.mark.bad_input
@pytest.mark.parametrize(("path", "broken"), CASES)
def test_broken_key_is_named(path: tuple[str | int, ...], broken: dict[str, Any]) -> None:
    problems = problems_of(broken)
    assert any(problem.startswith(key_path(path)) for problem in problems), problems
    assert all(len(problem) < 1500 for problem in problems)


@pytest.mark.bad_input
@pytest.mark.parametrize(
    ("change", "where", "says"),
    [
        (
            {"words": WORDS | {"color": ["green", "box"]}},
            "experiments.own.words",
            "'box' is a word of object and of color",
        ),
        ({"words": None}, "experiments.own", "key 'words' is missing"),
        ({"D": [6, 50], "trials": 40}, "experiments.own.D[1]", "50 is more than the 40 trials collected"),
        (
            {"generation": {"D": [7]}},
            "experiments.own.generation.D[0]",
            "7 is not run (allowed: 6, from experiments.own.D)",
        ),
        ({"description": {"ROW": [0, 5]}}, "experiments.own.description.ROW[1]", "5 is not run (allowed: 0"),
        ({"figure": {"D": 7}}, "experiments.own.figure.D", "7 is not run (allowed: 6, from experiments.own.D)"),
        ({"figure": {"variant": "few"}}, "experiments.own.figure.variant", "few is not run (allowed: default"),
        (
            {"methods": ["mmlda"], "figure": {"method": "proposed"}},
            "experiments.own.figure.method",
            "proposed is not run (allowed: mmlda, from experiments.own.methods)",
        ),
        (
            {"samplers": {"a": {"kind": "mixing"}}, "methods": ["proposed", "mmlda_released"]},
            "experiments.own",
            "no sampler can fit method mmlda_released (add one of kind blocked)",
        ),
        (
            {"samplers": {"a": {"kind": "blocked"}}, "figure": {"samplers": ["a", "b"]}},
            "experiments.own.figure.samplers[1]",
            "b is not run (allowed: a, from experiments.own.samplers)",
        ),
        (
            {"variants": {"own": {"mean_precision": {"action": "lerned"}}}},
            "experiments.own.variants.own.mean_precision.action",
            "'lerned' is unknown; did you mean 'learned'? (a number above 0 or `learned`)",
        ),
        (
            {"variants": {"own": {"mean_precision": 0}}},
            "experiments.own.variants.own.mean_precision",
            "0 must be more than 0 (κ0, the pseudo-observations behind m0; learned:",
        ),
        (
            {"variants": {"own": {"mean_precision": "learned", "mean_precision_range": [10, 1]}}},
            "experiments.own.variants.own.mean_precision_range",
            "the smaller number comes first",
        ),
        (
            {"variants": {"few": {"only": {"samplers": ["released"]}}}},
            "experiments.own.variants.few.only.samplers[0]",
            "released is not run (allowed: published, from experiments.own.samplers)",
        ),
        (
            {"variants": {"few": {"only": {"ROW": [0, 9]}}}},
            "experiments.own.variants.few.only.ROW[1]",
            "9 is not run (allowed: 0, from experiments.own.ROW)",
        ),
        (
            {"methods": ["mmlda"], "variants": {"few": {"only": {"methods": ["proposed"]}}}},
            "experiments.own.variants.few.only.methods[0]",
            "proposed is not run (allowed: mmlda, gmm",
        ),
        (
            {"D": [6, 8], "variants": {"few": {"only": {"D": [8]}}}},
            "experiments.own.D[0]",
            "6 is run for no variant",
        ),
        (
            {"D": [6, 8], "variants": {"a": {}, "b": {"only": {"D": [8]}}}, "figure": {"variant": "b", "D": 6}},
            "experiments.own.figure",
            "no fit has variant b, D 6 (allowed: ",
        ),
        (
            {
                "samplers": {"a": {"kind": "blocked"}, "b": {"kind": "mixing"}},
                "variants": {"few": {"only": {"samplers": ["a"]}}, "all": {}},
                "figure": {"variant": "few", "samplers": ["a", "b"]},
            },
            "experiments.own.figure",
            "no fit has variant few, samplers a, b (allowed: ",
        ),
        ({"data": "own"}, "experiments.own.data", "is no other experiment"),
        ({"data": "other"}, "experiments.own.data", "'other' is no other experiment (allowed: there is none)"),
        ({"features": {"trials": "a", "objects": "b"}, "logs": "c"}, "experiments.own", "features and logs exclude"),
        (
            {"features": {"trials": "a", "objects": "b"}, "trials": 6},
            "experiments.own.trials",
            "no effect with features",
        ),
        (
            {"logs": "nowhere", "description": {"actions": 3}},
            "experiments.own.description.actions",
            "only 0 has an effect",
        ),
        (
            {"ROW": [0, 40], "variants": {"few": {"only": {"ROW": [40]}}}},
            "experiments.own.generation",
            "no fit is run with D 6 and ROW 0 (see experiments.own.variants; sentences: 0 leaves the task out)",
        ),
        ({"features": {"trials": "a", "objects": "b"}}, "experiments.own.features.trials", "is not a file"),
        ({"logs": "nowhere"}, "experiments.own.logs", "calibration.mcap is not a file"),
        ({"logs": ["nowhere", "else"]}, "experiments.own.logs[1]", "calibration.mcap is not a file"),
        (
            {"features": [{"trials": "a", "objects": "b"}, {"trials": "c", "objects": "d"}]},
            "experiments.own.features[1].trials",
            "is not a file",
        ),
        ({"logs": "nowhere", "datasets": 2}, "experiments.own.datasets", "has no effect with logs (remove it)"),
        ({"datasets": 1000, "seeds": 100}, "experiments.own", "fewer data sets, seeds"),
        ({"words": WORDS | {"position": ["front", "behind"]}}, "experiments.own.simulation", "behind"),
    ],
)
def test_contradictions_are_named(change: dict[str, Any], where: str, says: str) -> None:
    problems = problems_of(minimal(**change))
    assert any(problem.startswith(where) and says in problem for problem in problems), problems


@pytest.mark.bad_input
@pytest.mark.parametrize(
    ("change", "says"),
    [
        (
            {"trails": 5},
            ": unknown key 'trails'; did you mean 'trials'? (allowed: D, K, ROW, data, datasets, "
            "description, diagnostics, feature_extraction, features, figure, generation, logs, methods, samplers, "
            "seed, seeds, simulation, trials, trials_per_job, variants, words)",
        ),
        ({"D": None}, ": key 'D' is missing (numbers of training trials; the first D are used)"),
        ({"ROW": [0, 140]}, ".ROW[1]: 140 is more than the maximum of 100 (a whole number from 0 to 100)"),
        ({"ROW": [0, True]}, ".ROW[1]: True must be a whole number from 0 to 100"),
        (
            {"datasets": 0},
            ".datasets: 0 is less than the minimum of 1 (data sets to simulate, each by itself, and to run with all "
            "conditions and seeds; tables and claims are then over data sets, and over seeds within them. More data "
            "sets leave the earlier ones alone)",
        ),
        (
            {"features": [{"trials": "a"}]},
            ".features[0]: key 'objects' is missing (a path, relative to the folder of the config file)",
        ),
        ({"logs": ["a", 5]}, ".logs[1]: 5 must be text (a path, relative to the folder of the config file)"),
        (
            {"simulation": {"light": {"direction": [1, 2]}}},
            ".simulation.light.direction: [1, 2] needs 3 entries (from the table to the lamp)",
        ),
        ({"ROW": [5, 5]}, ".ROW: 5 stands twice (rates of omitted words in per cent)"),
        (
            {"seeds": 2.0},
            ".seeds: 2.0 must be a whole number from 1 to 100000 (fits per condition, with seeds 1, 2, …); write 2",
        ),
        (
            {"methods": ["propsed"]},
            ".methods[0]: 'propsed' is unknown; did you mean 'proposed'? (allowed: proposed, no_mec2, "
            "mmlda, mmlda_released, proposed_open, no_mec2_open, proposed_ordered, proposed_open_ordered, gmm)",
        ),
        (
            {"K": {"aktion": 5}},
            ".K: unknown key 'aktion'; did you mean 'action'? (allowed: action, position, object, color)",
        ),
        (
            {"simulation": {"actions": {"touhc": "x"}}},
            ".simulation.actions: unknown key 'touhc'; did you mean 'touch'? (allowed: reach, touch, "
            "grasp, look-at)",
        ),
        (
            {"simulation": {"table": {"color": [0.5, 2, 0.5]}}},
            ".simulation.table.color[1]: 2 is more than the maximum of 1 (a number from 0 to 1)",
        ),
        (
            {"simulation": {"objects_most": 9}},
            ".simulation.objects_most: 9 objects need as many places, there are 4",
        ),
        (
            {"samplers": {"fast": {"kind": "bloked"}}},
            ".samplers.fast.kind: 'bloked' is unknown; did you mean 'blocked'? (allowed: blocked, collapsed, mixing)",
        ),
        (
            {"samplers": {"fast": {"iterations": 5}}},
            ".samplers.fast: key 'kind' is missing (allowed: blocked, collapsed, mixing)",
        ),
        (
            {"samplers": {"fast": {"kind": "collapsed", "averaged_draws": 5}}},
            ".samplers.fast: unknown key 'averaged_draws' (allowed: burn_in, chains, iterations, "
            "keep_history, kind, parameters, temperature)",
        ),
        (
            {"samplers": {"fast": {"kind": "mixing", "burn_in": 0.1}}},
            ".samplers.fast.burn_in = 0.1 would keep annealed states (at least 0.3)",
        ),
        (
            {"samplers": {"fast": {"kind": "collapsed", "parameters": "mean", "keep_history": 0}}},
            ".samplers.fast.parameters: mean needs kept states (keep_history 1 or more)",
        ),
        (
            {"samplers": {"fast": {"kind": "blocked", "iterations": 10**30}}},
            f".samplers.fast.iterations: {10**30} is more than the maximum of 1000000 (sweeps per chain)",
        ),
    ],
    ids=lambda value: str(value)[:60],
)  # fmt: skip
def test_messages_say_what_is_wrong_where_and_what_is_allowed(change: dict[str, Any], says: str) -> None:
    assert problems_of(minimal(**change)) == (f"experiments.own{says}",)


def test_all_problems_are_told_in_one_order() -> None:
    wrong = {"seeds": 0, "ROW": ["a"], "words": None, "K": 0}
    config = minimal(**wrong) | {"sead": 1}
    assert [problem.partition(": ")[0] for problem in problems_of(config)] == [
        "experiments.own.K", "experiments.own.ROW[0]", "experiments.own.seeds", "the config"
    ]  # fmt: skip
    assert problems_of(dict(reversed(config.items()))) == problems_of(config)


def test_sharing_the_data_of_an_experiment_that_shares() -> None:
    experiments = {
        "a": {"words": WORDS, "D": [6]},
        "b": {"data": "a", "D": [6]},
        "c": {"data": "b", "D": [6]},
    }
    assert "b has no data of its own" in problems_of({"experiments": experiments})[0]


@pytest.mark.bad_input
@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("seed: 1\nseed: 2\n", "'seed' stands twice"),
        ("experiments: {own: {D: [6], D: [7]}}", "'D' stands twice"),
        ("seed: !!python/object/apply:os.system ['true']", "not plain YAML"),
        ("a: &x [1]\nb: *x", "aliases are not used"),
        ("1: a", "is not text"),
        ("[1, 2]", "must be a mapping"),
        ("", "must be a mapping"),
        ("a: [1", "not plain YAML"),
        ("a: " + "[" * 5000, "not plain YAML"),
        ("a: " + "x" * 1_100_000, "larger than"),
        (b"\xff\xfe\x00", "cannot be read"),
        (b"a: caf\xe9", "cannot be read"),
        (b"a: \x00", "not plain YAML"),
        (b"a: \x1b[31m", "not plain YAML"),
        ("a: !!python/name:os.system", "tags are not used"),
        ("a: !!python/object/new:os.system [true]", "tags are not used"),
        ("a: !!binary aGVsbG8=", "tags are not used"),
        ("a: !!set {x}", "tags are not used"),
        ("a: !!int '5'", "tags are not used"),
        ("a: !own {x: 1}", "tags are not used"),
        ("!!map {a: 1}", "tags are not used"),
        ("a: &x {b: 1}\nc: {<<: *x}", "merge keys .<<. are not used here"),
        ("a: {<<: {b: 1}}", "merge keys .<<. are not used here"),
        ("a: &x [*x]", "aliases are not used"),
        (
            "a0: &a0 [x, x]\n" + "".join(f"a{i}: &a{i} [*a{i - 1}, *a{i - 1}]\n" for i in range(1, 60)),
            "aliases are not",
        ),
        ("".join(" " * i + "a:\n" for i in range(600)), "not plain YAML"),
        ("a: [" + "x," * 100_000 + "]", "more than 20,000 values"),
        ("a: " + "9" * 5000, "a number that is too long"),
        ("a: 0x" + "f" * 5000, "a number that is too long"),
        ("a: " + "1:" * 5000 + "1", "a number that is too long"),
        ("a: 2001-99-99", "not plain YAML"),
        ("a: 0x_", "not plain YAML"),
        ("? [a, b]\n: 1", "is not text"),
        ("? {a: b}\n: 1", "is not text"),
        ("null: 1", "is not text"),
        ("a: 1\n---\nb: 1", "not plain YAML"),
        ("%YAML 9.9\n---\na: 1", "not plain YAML"),
        ("a: @b", "not plain YAML"),
        ("a: *nowhere", "aliases are not used"),
    ],
    ids=lambda value: repr(value)[:40],
)
def test_files_that_are_no_config(tmp_path: Path, text: str | bytes, says: str) -> None:
    path = tmp_path / "config.yaml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(ConfigError, match=says) as caught:
        read_config(path)
    assert str(path) in str(caught.value)


HOSTILE_NAMES = (
    "", ".", "..", "../x", "/etc/passwd", "a/b", "a\\b", "a;rm -rf", "a b", "a\n", "\n", "a\tb", "$(x)", "`x`",
    "a|b", "a&b", "a>b", "{wildcard}", "{experiment}", "*", "a*", "~", "-rf", "--help", "1a", "a\0", "a\x1b[31m",
    "a\u200b", "a\u202eb", "\ud800", "\u0430", "\uff21", "é", "a.b", "a'b", 'a"b', "<b>", "x" * 41, "x" * 200_000,
    "NA", "nan", "None", "TRUE", "Inf",
)  # fmt: skip
HOSTILE_WORDS = (
    "", " ", "two words", "a\n", "a\tb", "a\0", "a\x07", "a\x1b[31m", "a\x85", "a\xa0b", "a\xad", "a\u200bb",
    "a\u200d", "\u202eb", "a\u2028b", "a\u2066", "\ufeffa", "\ud800", "\uffff", "=1+1", "+1", "-1", "@cmd", "/reach",
    "x" * 41, "x" * 200_000, "NA", "N/A", "nan", "None", "null", "True", "1", "007", ".5", "1.5", "1e5", "1E-5",
)  # fmt: skip


@pytest.mark.bad_input
@pytest.mark.parametrize("kind", ["experiment", "variant", "sampler", "data", "figure"])
@pytest.mark.parametrize("name", HOSTILE_NAMES, ids=lambda name: repr(name)[:30])
def test_names_that_are_no_part_of_a_path(kind: str, name: str) -> None:
    samplers = {"samplers": {name: {"kind": "blocked"}}}
    config = minimal(
        **{"variant": {"variants": {name: {}}}, "sampler": samplers, "data": {"data": name, "words": None}}.get(
            kind, {}
        )
    )
    if kind == "experiment":
        config = {"experiments": {name: config["experiments"]["own"]}}
    if kind == "figure":
        config = minimal(figure={"variant": name})
    problems = problems_of(config)
    assert any("a letter, then up to 39 letters, digits, _ or -" in problem for problem in problems), problems
    assert all(len(problem) < 1000 and "\n" not in problem and "\x1b" not in problem for problem in problems)


@pytest.mark.bad_input
@pytest.mark.parametrize("word", HOSTILE_WORDS, ids=lambda word: repr(word)[:30])
@pytest.mark.parametrize("channel", sorted(WORDS))
def test_words_that_cannot_be_seen_or_that_spreadsheets_run(channel: str, word: str) -> None:
    problems = problems_of(minimal(words=WORDS | {channel: [*WORDS[channel], word]}))
    assert problems[0].startswith(f"experiments.own.words.{channel}[{len(WORDS[channel])}]: ")
    assert WORD_RULE in problems[0]
    assert "\x1b" not in problems[0]


@pytest.mark.bad_input
@pytest.mark.parametrize("path", ["", "a\0b", "a\n", "\x1b", "\ud800", "x" * 4001], ids=lambda path: repr(path)[:30])
@pytest.mark.parametrize("key", ["logs", "trials", "objects", "weights"])
def test_paths_that_are_none(key: str, path: str) -> None:
    tables = {"trials": "a", "objects": "b"}
    change = {"logs": {"logs": path}, "weights": {"feature_extraction": {"weights": path}}}
    problems = problems_of(minimal(**change.get(key, {"features": tables | {key: path}})))
    assert any(f"{key}: " in problem for problem in problems), problems


@pytest.mark.bad_input
@pytest.mark.parametrize(
    "change",
    [
        {"features": {"trials": "{wildcard}.parquet", "objects": "b"}},
        {"features": {"trials": "a", "objects": "{experiment}/b"}},
        {"logs": "logs {x}"},
        {"feature_extraction": {"weights": "}.pt"}},
    ],
    ids=str,
)
def test_paths_that_snakemake_would_fill_in(change: dict[str, Any]) -> None:
    assert any("has { or } in it" in problem for problem in problems_of(minimal(**change)))


@pytest.mark.parametrize(
    "word",
    [
        "look-at",
        "écarlate",
        "赤い",
        "l'eau",
        "c++",
        "50%",
        "<b>",
        "a&b",
        "$x$",
        "a|b",
        "\\end",
        "{x}",
        "nana",
        "1st",
        "3D",
        "a;b",
    ],
)
def test_any_other_word_is_a_word(word: str) -> None:
    assert schema_problems(minimal(words=WORDS | {"color": [word]})) == []


@pytest.mark.bad_input
@pytest.mark.parametrize(
    "change",
    [
        {"seeds": 100_000},
        {"D": list(range(1, 2000)), "ROW": list(range(101))},
        {"trials": 1_000_000, "trials_per_job": 1},
        {"variants": {f"v{i}": {} for i in range(100)}, "seeds": 1000},
    ],
    ids=lambda change: ", ".join(change),
)
def test_a_study_of_absurd_size(change: dict[str, Any]) -> None:
    assert "fits and parts of a simulation; at most 100,000 are run" in problems_of(minimal(**change))[0]


@pytest.mark.bad_input
def test_names_that_some_disks_do_not_tell_apart() -> None:
    own = minimal()["experiments"]["own"]
    assert problems_of({"experiments": {"own": own, "Own": own}})[0].startswith(
        "experiments.own: differs from experiments.Own"
    )
    assert "only in capitals" in problems_of(minimal(variants={"few": {}, "Few": {}}))[0]
    samplers = {name: {"kind": "blocked"} for name in ("fast", "Fast")}
    assert "only in capitals" in problems_of(minimal(samplers=samplers))[0]


def test_the_schema_for_editors_accepts_what_is_accepted() -> None:
    schema = config_schema()
    Draft202012Validator.check_schema(schema)
    editor = Draft202012Validator(schema)
    for config in sorted((ROOT / "config").glob("*.yaml")):
        editor.validate(yaml.safe_load(config.read_text(encoding="utf-8")))
    editor.validate(json.loads(json.dumps(everything())))
    assert not editor.is_valid(minimal(D=[0]))
    assert not editor.is_valid(minimal(trials=None) | {"seeed": 1})


def test_the_schema_for_editors_refuses_null() -> None:
    for key in KEYS:
        assert not Draft202012Validator(config_schema()).is_valid({"experiments": {"own": {"D": [6], key: None}}}), (
            key
        )


def test_one_schema_of_words_and_paths_everywhere() -> None:
    text = json.dumps(config_schema())
    for pattern in (WORD_PATTERN, NAME_PATTERN, PATH_PATTERN):
        assert text.count(json.dumps(pattern)) == 1
    known = config_schema()["$defs"]
    assert known["Word"]["description"] == f"a word: {WORD_RULE}"
    assert known["Name"]["description"] == NAME_RULE


def test_no_two_experiments_can_name_one_file() -> None:
    for one, other in itertools.permutations(FIGURES, 2):
        assert not one.endswith(f"_{other}")


def test_thousands_of_problems_are_told_in_brief() -> None:
    config = minimal() | {f"key{i}": 1 for i in range(19_000)}
    error = ConfigError("x", schema_problems(config))
    assert len(error.problems) <= 101
    mixed = [value for i in range(9000) for value in (i, f"a{i}")]
    assert any("must be a whole number" in problem for problem in problems_of(minimal(D=mixed)))


@examples(FEW)
@given(content=st.binary(max_size=300))
def test_fuzz_any_bytes(shared_folder: Path, content: bytes) -> None:
    read_anything(shared_folder, content)


@examples(FEW)
@given(mutations=MUTATIONS)
def test_fuzz_a_config(shared_folder: Path, mutations: list[Mutation]) -> None:
    read_anything(shared_folder, mutated(GOOD, mutations))


@pytest.mark.slow
@examples(MANY)
@given(mutations=MUTATIONS)
def test_fuzz_a_config_much(shared_folder: Path, mutations: list[Mutation]) -> None:
    read_anything(shared_folder, mutated(GOOD, mutations))


LEAVES = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8)
PLAIN = st.recursive(
    LEAVES | st.sampled_from(["own", "default", "gmm"]),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(KEYS), inner, max_size=4),
    max_leaves=8,
)


@examples(FEW)
@given(own=st.dictionaries(st.sampled_from(KEYS), PLAIN, max_size=6))
def test_fuzz_any_values(own: dict[str, Any]) -> None:
    with suppress(ConfigError):
        plan({"experiments": {"own": minimal()["experiments"]["own"] | own}}, FILE)


def read_anything(folder: Path, content: bytes) -> None:
    """It is planned as what it says, or refused by the documented error."""
    path = folder / "config.yaml"
    path.write_bytes(content)
    with suppress(ConfigError):
        load_study(path)
        assert read_config(path) == yaml.safe_load(content.decode())


@pytest.fixture(scope="session")
def shared_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("hostile_configs")


def test_a_missing_file(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="cannot be read"):
        load_study(tmp_path / "config.yaml")
