"""Fit one method to one condition."""

from pathlib import Path

from data_collection.seeding import generator
from features.table import read_table
from model import Prior, Problem, Trials, fit, save
from model.omission import kept_words
from model.samplers import sampler_of
from workflow.execution.job import job

with job(snakemake):
    names, params = snakemake.wildcards, snakemake.params
    table = read_table(Path(snakemake.input.trials), Path(snakemake.input.objects), need_attention=True)
    trials = Trials.from_arrays(**table.learning_input())
    # The same words are omitted for all methods, so that methods are compared in pairs.
    omission = generator(params.seed, "omission", params.data, int(names.D), int(names.seed))
    heard = trials.keep_words(kept_words(omission, len(trials.word_trial), int(names.ROW)))
    priors = [Prior(**params.priors[channel.name]) for channel in trials.channels]
    sampler = sampler_of(params.sampler)
    condition = names.experiment, names.variant, names.method, sampler.stream, names.D, names.ROW, names.seed
    # Another chain of the same posterior has other draws.
    chain = ("chain", names.chain) if names.get("chain") else ()
    rng = generator(params.seed, "fit", *condition, *chain)
    save(fit(Problem.of(heard, names.method, priors), sampler, rng), Path(snakemake.output[0]))
