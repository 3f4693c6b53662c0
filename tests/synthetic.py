"""Hand-made data sets with known truth, for tests that need no robot."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import yaml

from model import Trials

WORDS = {
    "action": ["reach", "touch", "grasp", "look-at"],
    "position": ["front", "left", "right", "far"],
    "object": ["box", "cup", "ball"],
    "color": ["green", "red", "blue"],
}
TRIALS_COLUMNS = {
    "trial": pa.int64(),
    "attended_object": pa.int64(),
    "words": pa.list_(pa.string()),
    "action": pa.list_(pa.float64()),
    "truth_action": pa.string(),
}
OBJECTS_COLUMNS = {
    "trial": pa.int64(),
    "object": pa.int64(),
    "position": pa.list_(pa.float64()),
    "object_feature": pa.list_(pa.float64()),
    "color": pa.list_(pa.float64()),
    "truth_position": pa.string(),
    "truth_object": pa.string(),
    "truth_color": pa.string(),
}


def own_rows(
    trials: int = 20, object_dimension: int = 100, action_dimension: int = 38, truth: bool = True
) -> tuple[list[dict[str, object]], list[dict[str, object]]]:
    """Rows of the two tables that somebody might bring: clear clusters, four words a sentence."""
    rng = np.random.default_rng(20171219)
    centres = {
        "action": rng.random((4, action_dimension)),
        "position": np.array([[0.25, 0.0], [0.32, 0.16], [0.32, -0.16], [0.40, 0.0]]),
        "object": rng.random((3, object_dimension)),
        "color": np.eye(3, 10) * 0.7 + 0.03,
    }
    trial_rows: list[dict[str, object]] = []
    object_rows: list[dict[str, object]] = []
    for trial in range(1, trials + 1):
        action, count = rng.integers(4), rng.integers(1, 4)
        places = rng.permutation(4)[:count]
        attended = int(rng.integers(count))
        sentence: list[str] = []
        for m in range(count):
            kinds = {"position": places[m], "object": rng.integers(3), "color": rng.integers(3)}
            seen = {name: centres[name][k] for name, k in kinds.items()}
            seen["position"] = seen["position"] + 0.02 * rng.standard_normal(2)
            seen["object"] = seen["object"] + 0.05 * rng.standard_normal(object_dimension)
            names = {name: WORDS[name][k] for name, k in kinds.items()}
            row: dict[str, object] = {
                "trial": trial,
                "object": m,
                "position": seen["position"].tolist(),
                "object_feature": seen["object"].tolist(),
                "color": rng.dirichlet(300 * seen["color"]).tolist(),
            }
            object_rows.append(row | ({f"truth_{name}": word for name, word in names.items()} if truth else {}))
            if m == attended:
                sentence = [WORDS["action"][action], *names.values()]
        trial_row: dict[str, object] = {
            "trial": trial,
            "attended_object": attended,
            "words": [sentence[i] for i in rng.permutation(4)],
            "action": (centres["action"][action] + 0.05 * rng.standard_normal(action_dimension)).tolist(),
        }
        trial_rows.append(trial_row | ({"truth_action": WORDS["action"][action]} if truth else {}))
    return trial_rows, object_rows


def write_rows(rows: list[dict[str, object]], columns: dict[str, pa.DataType], path: Path) -> None:
    """Write rows as Parquet with the contract's types, of the columns that the rows have."""
    schema = pa.schema([(name, kind) for name, kind in columns.items() if any(name in row for row in rows)])
    pq.write_table(pa.Table.from_pylist(rows, schema=schema), path)


def write_own_study(folder: Path, truth: bool = True, **changes: object) -> Path:
    """A config with features of one's own, and the files that it names; returns the config's path."""
    trials, objects = own_rows(truth=truth)
    write_rows(trials, TRIALS_COLUMNS, folder / "trials.parquet")
    write_rows(objects, OBJECTS_COLUMNS, folder / "objects.parquet")
    own = {
        "features": {"trials": "trials.parquet", "objects": "objects.parquet"},
        "words": WORDS,
        "D": [20],
        "ROW": [0, 40],
        "seeds": 2,
    }
    samplers = {"published": {"kind": "blocked", "iterations": 30}}
    config = {"samplers": samplers, "methods": ["proposed", "mmlda"], "experiments": {"own": own | changes}}
    path = folder / "config.yaml"
    path.write_text(yaml.safe_dump(config, sort_keys=False))
    return path


def trials_of_model(rng: np.random.Generator, objects_per_trial: list[int], lengths: list[int], W: int = 5) -> Trials:
    """Trials laid out as asked, with random contents: two-dimensional action and position, one-dimensional color."""
    D, owner = len(objects_per_trial), np.repeat(np.arange(len(objects_per_trial)), objects_per_trial)
    vocabulary = [f"word{i}" for i in range(W)]
    sentences = [[str(word) for word in rng.choice(vocabulary, n)] for n in lengths]
    objects = {"position": rng.normal(size=(len(owner), 2)), "color": rng.normal(size=(len(owner), 1))}
    attended = [int(rng.integers(M)) for M in objects_per_trial]
    return Trials.from_arrays(rng.normal(size=(D, 2)), objects, owner, attended, sentences)
