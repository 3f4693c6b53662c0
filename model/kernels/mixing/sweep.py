"""One sweep: how often it applies each kernel is data."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from model.compiled import compiled
from model.data import Ints
from model.kernels.mixing.clusters import move_clusters
from model.kernels.mixing.exchange import exchange
from model.kernels.mixing.group_move import move_group
from model.kernels.mixing.permutation import permute_channels
from model.kernels.mixing.setup import Setup, Tables
from model.kernels.mixing.silent import sweep_silent
from model.kernels.mixing.split_merge import split_or_merge
from model.kernels.mixing.trial_block import sweep_trials
from model.kernels.mixing.word_move import move_word


class Recipe(NamedTuple):
    """How often a sweep applies each kernel.

    Attributes:
        silent: Sweeps over the silent elements.
        trials: Sweeps over the trials.
        split_merge: (C,) splits, merges and shuffles per channel.
        group_moves: (C,) moves of an element and its followers per channel.
        cluster_moves: (C,) draws of the categories of one or two clusters per channel.
        word_moves: Moves of a random word to another channel.
        exchanges: Exchanges of two channels in the sentences with a random word.
        permutations: Permutations of channels, in the sentences with a random word, in half of all or in all.
    """

    silent: int
    trials: int
    split_merge: Ints
    group_moves: Ints
    cluster_moves: Ints
    word_moves: int
    exchanges: int
    permutations: int


@compiled
def sweep(rng: np.random.Generator, setup: Setup, tables: Tables, recipe: Recipe) -> None:
    """Apply the kernels of a recipe."""
    for _ in range(recipe.silent):
        sweep_silent(rng, setup, tables)
    for _ in range(recipe.trials):
        sweep_trials(rng, setup, tables)
    for c in range(len(setup.size)):
        for _ in range(recipe.split_merge[c]):
            split_or_merge(rng, setup, tables, c)
        for _ in range(recipe.group_moves[c]):
            move_group(rng, setup, tables, c)
        for _ in range(recipe.cluster_moves[c]):
            move_clusters(rng, setup, tables, c)
    W = tables.words.shape[2]
    if W == 0:
        return
    for _ in range(recipe.word_moves):
        move_word(rng, setup, tables, int(rng.random() * W))
    for _ in range(recipe.exchanges):
        exchange(rng, setup, tables, int(rng.random() * W))
    for _ in range(recipe.permutations):
        permute_channels(rng, setup, tables, int(rng.random() * (W + 2)) - 2)
