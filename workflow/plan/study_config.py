"""The config as one typed model: checks, defaults, messages, `docs/config.md` and the JSON schema derive from it."""

from __future__ import annotations

from typing import Annotated, Any, TypeAlias

from pydantic import Field

from data_collection.simulation_settings import Simulation
from data_collection.strict_model import FilePath, StrictModel, Word
from features.extraction_settings import FeatureSettings
from model.samplers import AnySampler, Blocked
from workflow.plan.config_types import Maybe, MethodName, Name, OnePerSet, Percent, Several, TrialCount
from workflow.plan.variants import Categories, Variant

Vocabulary: TypeAlias = Annotated[Several[Word], Field(max_length=1000, description="the words of one channel")]


class Words(StrictModel):
    """The words by channel: the true channel of each word."""

    action: Vocabulary
    position: Vocabulary
    object: Vocabulary
    color: Vocabulary


class Generation(StrictModel):
    """The action generation task: instructions that the robot carries out."""

    sentences: int = Field(
        12,
        ge=0,
        le=10_000,
        description="instructions to draw, each with a scene in which one object fits; each word is said equally "
        "often, ± 1; 0 leaves the task out",
    )
    D: Several[TrialCount] = Field((), description="some of the experiment's D, by default the largest")
    ROW: Several[Percent] = Field((), description="some of the experiment's ROW, by default the smallest")
    samplers: Several[Name] = Field((), description="some of the experiment's samplers, by default all")
    rated: int = Field(
        1,
        ge=0,
        le=100_000,
        description="fits per condition whose actions are shown to human raters: those with the highest log joint",
    )


class Description(StrictModel):
    """The action description task: actions that the robot tells about."""

    actions: int = Field(
        12,
        ge=0,
        le=10_000,
        description="actions to simulate, each until the tutor says the word that is due: each word is true equally "
        "often, ± 1; 0 leaves the task out",
    )
    D: Several[TrialCount] = Field((), description="some of the experiment's D, by default all")
    ROW: Several[Percent] = Field((), description="some of the experiment's ROW, by default all")
    samplers: Several[Name] = Field((), description="some of the experiment's samplers, by default all")


Task: TypeAlias = Generation | Description


class Diagnostics(StrictModel):
    """Whether chains agree: what the diagnostics of an experiment are made of."""

    chains: int = Field(
        4,
        ge=0,
        le=1000,
        description="chains of one posterior where each seed omits words of its own (ROW between 0 and 100): the "
        "fit of seed 1 and further fits of what it hears; 0 or 1 is none of these. At ROW 0 and 100 seeds are chains",
    )


class Figure(StrictModel):
    """The fits that figures show; of the seeds the one with the highest log joint."""

    variant: Maybe[Name] = Field(None, description="one of the experiment's variants; by default the first")
    method: Maybe[MethodName] = Field(None, description="one of the experiment's methods; by default the first")
    samplers: Several[Name] = Field(
        (),
        description="some of the experiment's samplers, by default the first; of several, each has its own figures, "
        "whose files say which",
    )
    D: Maybe[TrialCount] = Field(None, description="one of the experiment's D; by default the largest")
    ROW: Maybe[Percent] = Field(None, description="one of the experiment's ROW; by default the smallest")


class FeatureTable(StrictModel):
    """The two Parquet files of a feature table."""

    trials: FilePath
    objects: FilePath


class FeatureTables(FeatureTable):
    """Feature tables of your own instead of a simulation."""

    generation: Maybe[FeatureTable] = None
    description: Maybe[FeatureTable] = None


class Shared(StrictModel):
    """Keys that may stand at the top of a config, for all experiments, or inside an experiment, where they win."""

    seed: int = Field(
        1,
        ge=0,
        le=2**64 - 1,
        description="seed of the whole study; every draw derives from it and from the names of what is drawn",
    )
    methods: Several[MethodName] = Field(
        ("proposed", "no_mec2", "mmlda"),
        description="methods to compare: proposed (A), no_mec2 (B), mmlda (C), mmlda_released (C as the authors' "
        "program computes it, for samplers of kind blocked only), proposed_open, no_mec2_open, proposed_ordered and "
        "proposed_open_ordered (A and B with words of no channel, A with word order: docs/sentences.md); gmm (ALL, "
        "no words) runs by itself",
    )
    samplers: dict[Name, AnySampler] = Field(
        {"published": Blocked()},
        min_length=1,
        description="the samplers that are run, by a name of your choice: a kind and its settings; those of an "
        "experiment replace those at the top",
    )

    def given(self) -> dict[str, Any]:
        """The shared settings that the config says here."""
        return {key: getattr(self, key) for key in Shared.model_fields if key in self.model_fields_set}


class ExperimentConfig(Shared):
    """One experiment: where its data come from, its words, and its conditions."""

    words: Maybe[Words] = None
    D: Several[TrialCount] = Field(description="numbers of training trials; the first D are used")
    ROW: Several[Percent] = Field((0,), description="rates of omitted words in per cent")
    seeds: int = Field(10, ge=1, le=100_000, description="fits per condition, with seeds 1, 2, …")
    datasets: int = Field(
        1,
        ge=1,
        le=1000,
        description="data sets to simulate, each by itself, and to run with all conditions and seeds; tables and "
        "claims are then over data sets, and over seeds within them. More data sets leave the earlier ones alone",
    )
    K: Categories = Field(
        10, description="K, upper limit of the number of categories: a whole number, or one for each channel"
    )
    variants: dict[Name, Variant] = Field(
        {"default": Variant()}, min_length=1, description="named changes of hyperparameters; each is run"
    )
    trials: Maybe[TrialCount] = Field(None, description="training trials to simulate; by default the largest D")
    trials_per_job: int = Field(
        10,
        ge=1,
        le=1000,
        description="trials that one job simulates; "
        "logs come in whole jobs, so that a larger D leaves the earlier ones alone",
    )
    generation: Generation = Generation()
    description: Description = Description()
    figure: Figure = Figure()
    diagnostics: Diagnostics = Diagnostics()
    simulation: Simulation = Simulation()
    feature_extraction: FeatureSettings = FeatureSettings()
    features: Maybe[OnePerSet[FeatureTables]] = Field(
        None,
        description="feature tables of your own instead of a simulation; or a list of them, one for each data set",
    )
    logs: Maybe[OnePerSet[FilePath]] = Field(
        None,
        description="a folder of MCAP logs of your own robot (calibration.mcap and train/trial_0001.mcap …) instead "
        "of a simulation, relative to the folder of the config file; or a list of them, one for each data set",
    )
    data: Maybe[Name] = Field(None, description="the name of another experiment whose data this one shares")


class StudyConfig(Shared):
    """What a study runs."""

    experiments: dict[Name, ExperimentConfig] = Field(min_length=1, description="the experiments by name")


def count_of_sets(config: StudyConfig, name: str) -> int:
    """How many data sets an experiment has: those of the experiment whose data it uses."""
    own = config.experiments[config.experiments[name].data or name]
    listed = next((one for one in (own.features, own.logs) if isinstance(one, tuple)), None)
    return own.datasets if listed is None else len(listed)


def with_defaults(model: Any, **defaults: Any) -> Any:
    """A copy of a model in which keys that its config leaves open have these values."""
    return model.model_copy(
        update={key: value for key, value in defaults.items() if key not in model.model_fields_set}
    )


def completed(config: StudyConfig, name: str) -> ExperimentConfig:
    """The settings of an experiment, with those that it shares and the defaults that depend on its other keys."""
    own = config.experiments[name]
    largest, fullest = (max(own.D),), (min(own.ROW),)
    extraction, simulated = own.feature_extraction, own.simulation.objects_most
    most = max(extraction.detection.most_objects, simulated)
    settings: ExperimentConfig = with_defaults(own, **config.given()).model_copy(
        update={
            "feature_extraction": extraction.model_copy(
                update={"detection": with_defaults(extraction.detection, most_objects=most)}
            ),
            "generation": with_defaults(own.generation, D=largest, ROW=fullest),
            "description": with_defaults(own.description, D=own.D, ROW=own.ROW),
        }
    )
    return settings
