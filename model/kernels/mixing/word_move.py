"""All tokens of a word to another channel or to none, with the frames and the speakers of its sentences drawn anew.

If all tokens are in one channel x, another channel y is drawn. The trials that hold the word are taken out, and put
back one after the other in random order by the trial block's conditional, restricted to frames that send the word to
y. Accept with Z(new | y) / Z(present | x), Z the product of the normalisers along the path, the present one forced.
Of long sentences only some words are drawn anew, see `_part`.
"""

from __future__ import annotations

import math

import numpy as np

from model.compiled import compiled, lean
from model.data import Ints
from model.distributions.choices import draw_other, shuffle
from model.kernels.mixing.counts import count_frame
from model.kernels.mixing.setup import Setup, Tables
from model.kernels.mixing.trial_block import categories_of, draw_trial, put_back, take_out


@compiled
def move_word(rng: np.random.Generator, setup: Setup, tables: Tables, word: int) -> bool:
    """Try to move a word to another channel; tells whether it was accepted."""
    C = len(setup.size)
    sources = C + setup.none
    trials = setup.word_trials[setup.trials_of_word[word] : setup.trials_of_word[word + 1]].copy()
    if not setup.framed or sources < 2 or len(trials) == 0:
        return False
    x = _channel_of(setup, tables, word, trials)
    if x < 0:
        return False
    y, channels = draw_other(rng, sources, x), np.arange(C)
    shuffle(rng, trials)
    before, F = categories_of(setup, tables, trials, channels), tables.F.copy()
    _take_out(setup, tables, trials, channels)
    chosen = np.empty(C, dtype=np.int64)
    present = 0.0
    for p in range(len(trials)):
        d = trials[p]
        part = _part(setup, d, word)
        present += draw_trial(rng, setup, tables, d, part, word, x, chosen)
        for t in part:
            tables.F[t] = F[t]
        _put_back(setup, tables, d, channels, before[p])
    _take_out(setup, tables, trials, channels)
    new, done = 0.0, 0
    for d in trials:
        log_z = draw_trial(rng, setup, tables, d, _part(setup, d, word), word, y, chosen)
        new += log_z
        if log_z == -np.inf:
            break
        _put_back(setup, tables, d, channels, chosen)
        done += 1
    if math.log(rng.random()) < new - present:
        return True
    _take_out(setup, tables, trials[:done], channels)
    tables.F[:] = F
    for p in range(len(trials)):
        _put_back(setup, tables, trials[p], channels, before[p])
    return False


@lean
def _take_out(setup: Setup, tables: Tables, trials: Ints, channels: Ints) -> None:
    """Take the whole sentences of trials out, with their speakers."""
    take_out(setup, tables, trials, channels)
    for d in trials:
        count_frame(setup, tables, d, -1)


@lean
def _put_back(setup: Setup, tables: Tables, d: int, channels: Ints, z: Ints) -> None:
    """Put the whole sentence of trial d back, with its speakers in categories z."""
    put_back(setup, tables, d, channels, z)
    count_frame(setup, tables, d, 1)


@lean
def _channel_of(setup: Setup, tables: Tables, word: int, trials: Ints) -> int:
    """The channel of all tokens of a word, or C; −1 if they have several, or a sentence has too many of them."""
    channel, most = -1, 1 if setup.along else setup.joint
    for d in trials:
        tokens = 0
        for t in range(setup.bounds[d], setup.bounds[d + 1]):
            if setup.words[0, t] == word:
                tokens += 1
                if channel >= 0 and tables.F[t] != channel:
                    return -1
                channel = tables.F[t]
        if tokens > most:
            return -1
    return channel


@compiled
def _part(setup: Setup, d: int, word: int) -> Ints:
    """The words of trial d whose frames are drawn: all tokens of the word, and as many others as fit, the first ones.

    It depends on the words alone, so that the way back draws the same.
    """
    first, last = setup.bounds[d], setup.bounds[d + 1]
    others = min(last - first, setup.joint)
    part, size = np.empty(others, dtype=np.int64), 0
    for t in range(first, last):
        others -= setup.words[0, t] == word
    for t in range(first, last):
        if setup.words[0, t] == word or others > 0:
            part[size] = t
            size += 1
            others -= setup.words[0, t] != word
    return part[:size]
