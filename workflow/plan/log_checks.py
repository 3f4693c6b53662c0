"""Open every log that a config names, so that a run does not stop half-way because of one."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Iterator, MutableMapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from data_collection.log.mcap_log import LogError
from data_collection.log.numbering import number_of, order_problems
from features.log_check import CheckedLog, check_log, open_calibration
from features.percepts import wrong_count
from features.transforms import LEAST_OBJECTS
from features.view import View
from workflow.plan.config_types import CHANNELS
from workflow.plan.experiment import TASKS, Experiment, log_folder_trials
from workflow.plan.own_tables import named_by, too_long
from workflow.plan.problems import key_path
from workflow.plan.study import Study

Memory = MutableMapping[str, dict[str, Any]]
"""What is known of logs by their content, and by what they were checked with: a log is opened once."""
Tell = Callable[[int, int], None]
"""Is told how many logs of how many have been opened."""


@dataclass(frozen=True)
class _Opened:
    """A sound log, its file and number."""

    path: Path
    number: int
    found: CheckedLog


def log_problems(study: Study, memory: Memory, version: str, tell: Tell) -> Iterator[str]:
    """Yield everything for which a run would refuse the logs that a config names.

    Args:
        study: A plan without other problems.
        memory: What is known of logs; what is learned is added.
        version: Of the code that checks; what another one found counts for nothing.
        tell: Is told of the progress.
    """
    own = [one for one in study.experiments.values() if one.source == "logs" and one.data == one.name]
    paths = {one.name: {name: log_folder_trials(study.log_folder(one.name), name) for name in _sets(study, one)}
             for one in own}  # fmt: skip
    total = sum(len(logs) for sets in paths.values() for logs in sets.values())
    done = 0
    for experiment in own:
        where = key_path(named_by(experiment, "logs"))
        calibration = study.log_folder(experiment.name) / "calibration.mcap"
        try:
            view = open_calibration(calibration)
        except LogError as error:
            yield from (f"{where}: {line}" for line in str(error).splitlines())
            done += sum(map(len, paths[experiment.name].values()))
            continue
        settings = experiment.settings.feature_extraction.detection.model_dump_json()
        context = _sha256(version, settings, _file_sha256(calibration))
        limits: dict[str, Path] = {}
        for set_name, files in paths[experiment.name].items():
            opened: list[_Opened] = []
            for path in files:
                tell(done, total)
                done += 1
                try:
                    found = _look(path, view, experiment, set_name, context, memory)
                except LogError as error:
                    yield from (f"{where}: {line}" for line in str(error).splitlines())
                    continue
                metadata = {} if found.said_number is None else {"trial": str(found.said_number)}
                opened.append(_Opened(path, number_of(str(path), metadata) or 0, found))
                limits.setdefault(found.limits, path)
            problems = (*_word_problems(study, experiment, opened), *_set_problems(experiment, set_name, opened))
            yield from (f"{where}: {problem}" for problem in problems)
            if set_name == "train":
                yield from _too_few(study, experiment, opened)
        if len(limits) > 1:
            one, other = list(limits.values())[:2]
            yield f"{where}: {other}: the limits of its joints are not those of {one}; all logs have the same"
    tell(total, total)


def unread_logs(study: Study) -> Iterator[str]:
    """Yield which files stand among the logs of a study, but are not called as its logs are."""
    for experiment in study.experiments.values():
        if experiment.source == "logs" and experiment.data == experiment.name:
            for set_name in ("train", *TASKS):
                folder = study.log_folder(experiment.name) / set_name
                read = {path.name for path in log_folder_trials(folder.parent, set_name)}
                if others := sorted({path.name for path in folder.glob("*.mcap*")} - read):
                    shown = ", ".join(others[:3]) + (", …" if len(others) > 3 else "")
                    yield f"{folder}: not read, for their names or a gap before them: {shown}"


def _sets(study: Study, experiment: Experiment) -> list[str]:
    """The sets of an experiment's logs that a run perceives."""
    users = study.users(experiment.name)
    return ["train", *(task for task in TASKS if any(study.is_tested(user.name, task) for user in users))]


def _look(path: Path, view: View, experiment: Experiment, set_name: str, context: str, memory: Memory) -> CheckedLog:
    """Return what a log says: what is known of its content, or else what is found when it is opened."""
    need_action = set_name != "generation"
    key = _sha256(context, str(need_action), _file_sha256(path))
    if known := memory.get(key):
        plain: dict[str, Any] = {name: tuple(one) if isinstance(one, list) else one for name, one in known.items()}
        return CheckedLog(**plain)
    detection = experiment.settings.feature_extraction.detection
    found = check_log(path, view, detection, need_action=need_action)
    memory[key] = asdict(found)
    return found


def _word_problems(study: Study, experiment: Experiment, opened: Iterable[_Opened]) -> Iterator[str]:
    """Words that the config lacks, and sentences that are too long for a method, as in tables."""
    allowed = {word for words in experiment.words.values() for word in words}
    for log in opened:
        if unknown := list(dict.fromkeys(word for word in log.found.words if word not in allowed)):
            yield (
                f"{log.path}: {', '.join(map(repr, unknown))} in “{' '.join(log.found.words)}” not among the "
                f"experiment's words: {', '.join(sorted(allowed))}"
            )
        for channel in CHANNELS:
            own = experiment.words.get(channel, [])
            true = dict.fromkeys(getattr(log.found, f"truth_{channel}"))
            if strange := [word for word in true if word not in own]:
                yield (
                    f"{log.path}: the truth says {', '.join(map(repr, strange))}, not among the experiment's words "
                    f"of {channel}: {', '.join(own)}"
                )
        if problem := too_long(study, experiment, len(log.found.words)):
            yield f"{log.path}: {problem}"


def _set_problems(experiment: Experiment, set_name: str, opened: list[_Opened]) -> Iterator[str]:
    """What the logs of a set say together: their order, and objects that are too few or too many."""
    yield from order_problems((str(log.path), log.number) for log in opened)
    if experiment.settings.feature_extraction.detection.on_wrong_count == "error":
        yield from (f"{log.path}: {problem}" for log in opened if (problem := _wrong(experiment, log)))
    elif set_name != "train" and opened and all(_wrong(experiment, log) for log in opened):
        yield f"{opened[0].path.parent}: no trial is left; all show a number of objects that drops them"


def _too_few(study: Study, experiment: Experiment, opened: list[_Opened]) -> Iterator[str]:
    """Numbers of training trials of which too little is left to fit on, since trials are dropped."""
    if experiment.settings.feature_extraction.detection.on_wrong_count == "error":
        return
    for user in study.users(experiment.name):
        for i, D in enumerate(user.settings.D):
            left = [log for log in opened[:D] if not _wrong(experiment, log)]
            if len(opened) >= D and sum(log.found.objects for log in left) < LEAST_OBJECTS:
                yield (
                    f"experiments.{user.title}.D[{i}]: of the first {D} trials {len(left)} are left, the others show "
                    f"a number of objects that drops them; at least {LEAST_OBJECTS} objects are needed"
                )


def _wrong(experiment: Experiment, log: _Opened) -> str:
    """Say what is implausible about the objects that a log shows; empty if nothing is."""
    return wrong_count(log.number, log.found.objects, experiment.settings.feature_extraction.detection)


def _file_sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _sha256(*parts: str) -> str:
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()
