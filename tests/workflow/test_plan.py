"""From a config to the plan of a study: defaults, conditions, and the fits that figures show."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from model.prior import Prior
from model.samplers import Blocked
from tests.synthetic import WORDS
from tests.workflow.configs import FILE, minimal
from workflow.artifacts.provenance import ROOT
from workflow.execution.engine import planned
from workflow.plan.config_types import CHANNELS
from workflow.plan.loading import load_study, plan
from workflow.plan.study import Study

SHIPPED = {
    "published": {"kind": "blocked"},
    "released": {"kind": "blocked", "averaged_draws": 100, "empty_category": "uniform"},
    "collapsed": {"kind": "collapsed"},
}


def study(config: dict[str, Any]) -> Study:
    return plan(config, FILE)


def test_defaults_are_filled_in() -> None:
    settings = study(minimal()).experiments["own"].settings
    assert (settings.seed, settings.seeds, settings.ROW) == (1, 10, (0,))
    assert settings.methods == ("proposed", "no_mec2", "mmlda")
    assert settings.samplers == {"published": Blocked()}
    assert (settings.generation.sentences, settings.generation.D, settings.description.ROW) == (12, (6,), (0,))


def test_an_experiments_own_value_wins() -> None:
    long, short = ({"long": {"kind": "blocked", "iterations": n}} for n in (900, 7))
    settings = study(minimal(samplers=short) | {"samplers": long, "seed": 3}).experiments["own"].settings
    assert (settings.samplers["long"].iterations, settings.seed) == (7, 3)
    assert settings.samplers["long"].chains == 1


def test_the_paths_of_the_fits() -> None:
    config = minimal(ROW=[0, 40], seeds=2, methods=["mmlda"], samplers=SHIPPED, variants={"narrow": {"scale": 0.1}})
    paths = [condition.path for condition in study(config).conditions("own")]
    assert len(paths) == len(set(paths)) == (2 + 1) * 2 * 3
    assert "fits/own/narrow/mmlda/released/D6/ROW40/seed2.npz" in paths
    assert "fits/own/narrow/gmm/published/D6/ROW100/seed1.npz" in paths


def test_chains_of_one_posterior_are_seeds_or_further_fits_of_the_first() -> None:
    config = minimal(ROW=[0, 40], seeds=2, methods=["mmlda"], diagnostics={"chains": 3})
    own = study(config)
    chains = {condition.ROW: own.chains(condition) for condition in own.conditions("own")}
    folder = "fits/own/default/mmlda/published/D6"
    assert chains[0] == [f"{folder}/ROW0/seed{seed}.npz" for seed in (1, 2)]
    assert chains[40] == [f"{folder}/ROW40/seed1{chain}.npz" for chain in ("", "_chain2", "_chain3")]
    assert chains[100] == [path.replace("mmlda", "gmm").replace("ROW0", "ROW100") for path in chains[0]]
    # As many are counted as are run: 2 seeds of ROW 0, 40 and ALL, two further chains, and the simulation of a block.
    assert own.size("own") == 2 * 3 + 2 + 1
    for few in (0, 1):
        config["experiments"]["own"]["diagnostics"] = {"chains": few}
        alone = study(config)
        assert {len(alone.chains(condition)) for condition in alone.conditions("own") if condition.ROW == 40} == {1}
        assert alone.size("own") == 2 * 3 + 1


def test_samplers_of_one_kind_with_different_lengths_share_their_draws() -> None:
    samplers = SHIPPED | {"long": {"kind": "blocked", "iterations": 400}}
    known = study(minimal(samplers=samplers)).experiments["own"].settings.samplers
    assert {name: sampler.stream for name, sampler in known.items()} == {
        "published": "blocked", "released": "blocked_averaged100", "collapsed": "collapsed", "long": "blocked",
    }  # fmt: skip


def test_a_sampler_is_run_and_shown_where_the_config_says() -> None:
    few = {"K": 5, "only": {"samplers": ["collapsed"]}}

    def shown(**figure: Any) -> dict[str, tuple[str, str] | None]:
        own = study(minimal(samplers=SHIPPED, seeds=1, variants={"default": {}, "few": few}, figure=figure))
        assert {c.sampler for c in own.conditions("own") if c.variant == "few"} == {"collapsed"}
        found = own.figure_conditions("own").items()
        return {ending: (one.variant, one.sampler) if one else None for ending, one in found}

    assert shown() == {"": ("default", "published")}
    assert shown(samplers=["released"]) == {"": ("default", "released")}
    both = {"_released": ("default", "released"), "_collapsed": ("default", "collapsed")}
    assert shown(samplers=["released", "collapsed"]) == both
    assert shown(variant="few") == {"": ("few", "collapsed")}


def test_a_variant_is_run_only_where_it_says() -> None:
    few = {"K": 5, "only": {"methods": ["proposed"], "D": [8], "ROW": [40]}}
    own = study(minimal(D=[6, 8], ROW=[0, 40], seeds=2, variants={"default": {}, "few": few}))
    conditions = list(own.conditions("own"))
    assert [c.path for c in conditions if c.variant == "few"] == [
        f"fits/own/few/proposed/published/D8/ROW40/seed{seed}.npz" for seed in (1, 2)
    ]
    assert len(conditions) == 2 * 2 * (3 * 2 + 1) + 2  # of the other variant all, ALL included
    assert own.experiments["own"].priors("few")["action"] == Prior(categories=5)
    assert own.experiments["own"].partial_variants == ["few"]
    alone = study(minimal(variants={"few": {"K": 5, "only": {"ROW": [0]}}})).experiments["own"]
    assert alone.partial_variants == []


def test_only_speaks_of_the_reference_by_its_name() -> None:
    def methods(**only: Any) -> set[str]:
        own = study(minimal(ROW=[0, 40], variants={"few": {"only": only}}, generation={"ROW": [0, 40]}))
        return {condition.method for condition in own.conditions("own")}

    assert methods(ROW=[40]) == {"proposed", "no_mec2", "mmlda", "gmm"}
    assert methods(methods=["mmlda"]) == {"mmlda"}
    assert methods(methods=["mmlda", "gmm"]) == {"mmlda", "gmm"}


def test_the_fit_that_figures_show() -> None:
    variants = {"default": {}, "few": {"K": 5, "only": {"methods": ["mmlda"], "D": [6]}}}

    def shown(**figure: Any) -> tuple[str, str, int, int]:
        own = study(minimal(D=[6, 8], ROW=[0, 40], variants=variants, figure=figure))
        condition = own.figure_conditions("own")[""]
        assert condition is not None
        assert [one.seed for one in own.seeds(condition)] == list(range(1, 11))
        return condition.variant, condition.method, condition.D, condition.ROW

    assert shown() == ("default", "proposed", 8, 0)
    assert shown(ROW=40) == ("default", "proposed", 8, 40)
    assert shown(variant="few") == ("few", "mmlda", 6, 0)
    assert shown(method="no_mec2", D=6) == ("default", "no_mec2", 6, 0)


def test_the_fit_whose_actions_are_shown() -> None:
    own = study(minimal(D=[6, 8], ROW=[0, 40], generation={"D": [6, 8], "ROW": [40]}))
    condition = own.generation_condition("own")
    assert condition is not None
    assert (condition.method, condition.D, condition.ROW) == ("proposed", 8, 40)
    assert study(minimal(generation={"sentences": 0})).generation_condition("own") is None


def test_zero_leaves_a_task_out_of_shared_trials_too() -> None:
    short = {"data": "a", "D": [6], "generation": {"sentences": 0}, "description": {"actions": 0}}
    shared = study({"experiments": {"a": {"words": WORDS, "D": [6]}, "b": short}})
    for task in ("generation", "description"):
        assert shared.task_conditions("a", task)
        assert shared.task_conditions("b", task) == []


def test_hyperparameters_by_channel() -> None:
    config = minimal(K={"action": 5}, variants={"v": {"alpha": 0.5, "gamma": {"color": 2.0}}})
    priors = study(config).experiments["own"].priors("v")
    assert priors["action"] == Prior(categories=5, concentration=0.5)
    assert priors["color"] == Prior(concentration=0.5, word_concentration=2.0)
    assert priors["position"] == Prior(concentration=0.5, box=(-0.5, 0.5))


def test_a_variant_changes_the_channels_that_it_names() -> None:
    config = minimal(K={"action": 20, "object": 20}, variants={"few": {"K": {"action": 5}}, "same": {}})
    few, same = (study(config).experiments["own"].priors(name) for name in ("few", "same"))
    assert few == same | {"action": Prior(categories=5)}
    assert [same[channel].categories for channel in CHANNELS] == [20, 10, 20, 10]


def test_blocks_of_trials_stay_when_more_are_added() -> None:
    few, many = (study(minimal(D=D)).blocks("own") for D in ([25], [25, 40]))
    assert few == many[:3]
    assert [len(block) for block in many] == [10] * 4


def test_trials_of_an_experiment_that_others_share() -> None:
    experiments = {"a": {"words": WORDS, "D": [6]}, "b": {"data": "a", "D": [21]}}
    assert study({"experiments": experiments}).trials("a", "train") == range(1, 31)


def test_the_configs_of_the_project_are_valid() -> None:
    for path in sorted((ROOT / "config").glob("*.yaml")):
        assert load_study(path).experiments
        assert yaml.safe_load(path.read_text())["experiments"]


def test_every_job_has_what_it_needs_where_variants_part_the_grid(tmp_path: Path) -> None:
    """Neither D has fits of all variants, and one has no fit that hears all words."""
    config = yaml.safe_load((ROOT / "config" / "smoke.yaml").read_text())
    few = {"K": 5, "only": {"D": [8], "ROW": [40], "methods": ["proposed"]}}
    config["experiments"]["simulator"] |= {
        "D": [6, 8],
        "ROW": [0, 40],
        "variants": {"default": {"only": {"D": [6]}}, "few": few},
        "generation": {"sentences": 2, "D": [6, 8], "ROW": [0]},
        "description": {"actions": 2, "ROW": [0]},
    }
    (tmp_path / "config.yaml").write_text(yaml.safe_dump(config))
    jobs = planned(tmp_path / "config.yaml", tmp_path / "out")
    compared = [job for job in jobs if "conditions" in job.parameters]
    assert {"describe", "uncertain", "diagnose", "evaluate_learning"} <= {job.rule for job in compared}
    assert all(job.inputs and job.parameters["conditions"] for job in compared)
    made = {path for job in jobs for path in job.outputs.values()}
    assert {"diagnostics/simulator_D6.csv", "descriptions/simulator_D6.csv", "scores/simulator_D8_csl.csv"} <= made
    assert not {"descriptions/simulator_D8.csv", "uncertain/simulator_D8.csv"} & made
    (further,) = (job for job in jobs if job.rule == "fit_chain" and job.wildcards["D"] == "8")
    assert further.outputs["[0]"].endswith("few/proposed/published/D8/ROW40/seed1_chain2.npz")


def test_the_claims_are_about_the_study_with_more_data_sets() -> None:
    """Of both configs data, conditions and tests are the same, so that the first data set is shared."""
    studies = [load_study(ROOT / "config" / f"{name}.yaml") for name in ("config", "claims")]
    plain, claims = studies
    assert {name: len(claims.sets(name)) for name in claims.first_sets} == {"simulator": 10, "real": 10}
    assert list(plain.experiments) == list(plain.first_sets) == list(claims.first_sets)
    for name, own in plain.experiments.items():
        other = claims.experiments[name]
        assert other.words == own.words
        for key in ("seed", "D", "ROW", "seeds", "K", "simulation", "feature_extraction", "description"):
            left, right = (
                getattr(one.settings, key).model_dump(exclude={"samplers"})
                if key == "description"
                else getattr(one.settings, key)
                for one in (own, other)
            )
            assert left == right
        assert other.priors("default") == own.priors("default")
        paths = {condition.path for condition in plain.conditions(name)}
        assert {condition.path for condition in claims.conditions(name)} <= paths
