"""The config as one typed model: checks, defaults, messages, `docs/config.md` and the JSON schema derive from it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias, TypeVar, get_args

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag, create_model
from pydantic_core import PydanticCustomError
from typing_extensions import TypeAliasType

from data_collection.limits import NAME_PATTERN, NAME_RULE
from data_collection.simulation_settings import Simulation
from data_collection.strict_model import LISTED, FilePath, StrictModel, Word
from features.extraction_settings import FeatureSettings
from model.frames import METHODS
from model.prior_standin import Prior
from model.samplers import AnySampler, Blocked

Channel = Literal["action", "position", "object", "color"]
CHANNELS: tuple[Channel, ...] = get_args(Channel)
HYPERPARAMETERS = {
    "K": "categories",
    "alpha": "concentration",
    "gamma": "word_concentration",
    "mean_precision": "mean_precision",
    "scale": "scale",
    "extra_degrees_of_freedom": "extra_degrees_of_freedom",
}
"""A hyperparameter of the config, and what `model.Prior` calls it."""
WORDLESS = tuple(name for name, method in METHODS.items() if not method.hears_words)
"""The methods that hear no words (ALL): they run by themselves, once for all ROW."""

_T = TypeVar("_T")


def _each_once(values: tuple[_T, ...]) -> tuple[_T, ...]:
    for i, value in enumerate(values):
        if value in values[:i]:
            raise PydanticCustomError("twice", "twice", {"value": value})
    return values


def _given(value: object) -> object:
    """A key may be left out, but not be null."""
    if value is None:
        raise PydanticCustomError("null", "null")
    return value


Several: TypeAlias = Annotated[
    tuple[_T, ...], Field(min_length=1, json_schema_extra={"uniqueItems": True}), LISTED, AfterValidator(_each_once)
]
Maybe: TypeAlias = Annotated[_T | None, BeforeValidator(_given)]
PerChannel: TypeAlias = Annotated[
    Annotated[_T, Tag("one")] | Annotated[dict[Channel, _T], Tag("each")],
    Discriminator(lambda value: "each" if isinstance(value, dict) else "one"),
]
Name = TypeAliasType("Name", Annotated[str, Field(pattern=NAME_PATTERN, description=NAME_RULE)])
TrialCount: TypeAlias = Annotated[int, Field(ge=1, le=1_000_000)]
Percent: TypeAlias = Annotated[int, Field(ge=0, le=100)]
Vocabulary: TypeAlias = Annotated[Several[Word], Field(max_length=1000, description="the words of one channel")]
if TYPE_CHECKING:
    MethodName: TypeAlias = str
else:
    MethodName = TypeAliasType("MethodName", Literal[tuple(METHODS)])


class Words(StrictModel):
    """The words by channel: the true channel of each word."""

    action: Vocabulary
    position: Vocabulary
    object: Vocabulary
    color: Vocabulary


class Only(StrictModel):
    """The conditions that a variant is run for; whatever is not named here is run for all."""

    methods: Several[MethodName] = Field(
        (), description="some of the experiment's methods, and gmm, which has no ROW; without gmm, ALL is left out"
    )
    samplers: Several[Name] = Field((), description="some of the experiment's samplers")
    D: Several[TrialCount] = Field((), description="some of the experiment's D")
    ROW: Several[Percent] = Field((), description="some of the experiment's ROW")


class _Variant(StrictModel):
    """Changes of hyperparameters against the paper's, each a number, or one for each channel; and where it is run."""

    only: Only = Field(Only(), description="the conditions that it is run for")


if TYPE_CHECKING:
    Variant = _Variant
    Categories: TypeAlias = int | dict[Channel, int]
else:

    def _hyperparameter(key):
        """The type of a hyperparameter of the config, and its field: what `model.Prior` says of it."""
        field = Prior.model_fields[HYPERPARAMETERS[key]]
        number = Annotated[(field.annotation, *field.metadata)]
        return PerChannel[number], Field(field.default, description=field.description)

    Variant = create_model(
        "Variant",
        __base__=_Variant,
        __doc__=_Variant.__doc__,
        **{key: _hyperparameter(key) for key in HYPERPARAMETERS},
    )
    Categories = _hyperparameter("K")[0]


class Generation(StrictModel):
    """The action generation task: instructions that the robot carries out."""

    sentences: int = Field(
        12,
        ge=0,
        le=10_000,
        description="instructions to draw, each with a scene in which one object fits; 0 leaves the task out",
    )
    D: Several[TrialCount] = Field((), description="some of the experiment's D, by default the largest")
    ROW: Several[Percent] = Field((), description="some of the experiment's ROW, by default the smallest")
    rated: int = Field(
        1,
        ge=0,
        le=100_000,
        description="fits per condition whose actions are shown to human raters: those with the highest log joint",
    )


class Description(StrictModel):
    """The action description task: actions that the robot tells about."""

    actions: int = Field(12, ge=0, le=10_000, description="actions to simulate; 0 leaves the task out")
    D: Several[TrialCount] = Field((), description="some of the experiment's D, by default all")
    ROW: Several[Percent] = Field((), description="some of the experiment's ROW, by default all")


Task: TypeAlias = Generation | Description


class Figure(StrictModel):
    """The fit that figures show; of its seeds the one with the highest log joint."""

    variant: Maybe[Name] = Field(None, description="one of the experiment's variants; by default the first")
    method: Maybe[MethodName] = Field(None, description="one of the experiment's methods; by default the first")
    sampler: Maybe[Name] = Field(None, description="one of the experiment's samplers; by default the first")
    D: Maybe[TrialCount] = Field(None, description="one of the experiment's D; by default the largest")
    ROW: Maybe[Percent] = Field(None, description="one of the experiment's ROW; by default the smallest")


class FeatureTable(StrictModel):
    """The two Parquet files of a feature table."""

    trials: FilePath
    objects: FilePath


class FeatureTables(FeatureTable):
    """Feature tables of your own instead of a simulation."""

    generation: Maybe[FeatureTable] = Field(None, description="the table of the generation task")
    description: Maybe[FeatureTable] = Field(None, description="the table of the description task")


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
        description="methods to compare: proposed (A), no_mec2 (B), mmlda (C); gmm (ALL, no words) runs by itself",
    )
    samplers: dict[Name, AnySampler] = Field(
        {"published": Blocked()},
        min_length=1,
        description="the samplers that are run, by a name of your choice: a kind and its settings",
    )

    def given(self) -> dict[str, Any]:
        """The shared settings that the config says here."""
        return {key: getattr(self, key) for key in Shared.model_fields if key in self.model_fields_set}


class ExperimentConfig(Shared):
    """One experiment: where its data come from, its words, and its conditions."""

    words: Maybe[Words] = Field(None, description="the words by channel: the true channel of each word")
    D: Several[TrialCount] = Field(description="numbers of training trials; the first D are used")
    ROW: Several[Percent] = Field((0,), description="rates of omitted words in per cent")
    seeds: int = Field(10, ge=1, le=100_000, description="fits per condition, with seeds 1, 2, …")
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
    generation: Generation = Field(
        Generation(), description="the action generation task: instructions that the robot carries out"
    )
    description: Description = Field(
        Description(), description="the action description task: actions that the robot tells about"
    )
    figure: Figure = Field(Figure(), description="the fit that figures show")
    simulation: Simulation = Field(
        Simulation(), description="the simulated robot, table, objects and tutor; every key has a default"
    )
    feature_extraction: FeatureSettings = Field(FeatureSettings(), description="how features are extracted from logs")
    features: Maybe[FeatureTables] = Field(None, description="feature tables of your own instead of a simulation")
    logs: Maybe[FilePath] = Field(
        None,
        description="a folder of MCAP logs of your own robot (calibration.mcap and train/trial_0001.mcap …) instead "
        "of a simulation, relative to the folder of the config file",
    )
    data: Maybe[Name] = Field(None, description="the name of another experiment whose data this one shares")


class StudyConfig(Shared):
    """What a study runs."""

    experiments: dict[Name, ExperimentConfig] = Field(min_length=1, description="the experiments by name")


def with_defaults(model: Any, **defaults: Any) -> Any:
    """A copy of a model in which keys that its config leaves open have these values."""
    return model.model_copy(
        update={key: value for key, value in defaults.items() if key not in model.model_fields_set}
    )


def completed(config: StudyConfig, name: str) -> ExperimentConfig:
    """The settings of an experiment, with those that it shares and the defaults that depend on its other keys."""
    own = config.experiments[name]
    largest, fullest = (max(own.D),), (min(own.ROW),)
    settings: ExperimentConfig = with_defaults(own, **config.given()).model_copy(
        update={
            "generation": with_defaults(own.generation, D=largest, ROW=fullest),
            "description": with_defaults(own.description, D=own.D, ROW=own.ROW),
        }
    )
    return settings


def hyperparameters(changes: Iterable[tuple[str, Any]]) -> dict[Channel, Prior]:
    """The hyperparameters of each channel after changes by the config's keys, of which later ones win.

    Args:
        changes: a key of `HYPERPARAMETERS`, and a number, or one per channel that changes.
    """
    priors: dict[Channel, dict[str, Any]] = {
        channel: {"box": BOXES[channel]} if channel in BOXES else {} for channel in CHANNELS
    }
    for key, value in changes:
        by_channel = value if isinstance(value, dict) else dict.fromkeys(CHANNELS, value)
        for channel, number in by_channel.items():
            priors[channel][HYPERPARAMETERS[key]] = number
    return {channel: Prior(**given) for channel, given in priors.items()}


BOXES: dict[Channel, tuple[float, float]] = {"position": (-0.5, 0.5)}
"""Where features do not lie in [0, 1]: the interval of each number of a channel."""
