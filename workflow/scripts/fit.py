"""Fit one method to one condition."""

from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from data_collection.seeding import generator
from features.table import read_table
from model import Prior, Settings, Trials, fit, save
from model.omission import kept_words
from model.samplers import AnySampler
from workflow.execution.job import job

with job(snakemake):
    names, params = snakemake.wildcards, snakemake.params
    table = read_table(Path(snakemake.input.trials), Path(snakemake.input.objects), need_attention=True)
    trials = Trials.from_arrays(**table.learning_input())
    # The same words are omitted for all methods, so that methods are compared in pairs.
    omission = generator(params.seed, "omission", params.data, int(names.D), int(names.seed))
    sampler: Any = TypeAdapter(AnySampler).validate_python(params.sampler)
    stream = [names.experiment, names.variant, names.method, sampler.stream, names.D, names.ROW, names.seed]
    old = {"mean_precision": "mean_strength", "extra_degrees_of_freedom": "extra_freedom"}
    result = fit(
        trials.keep_words(kept_words(omission, len(trials.word_trial), int(names.ROW))),
        names.method,
        generator(params.seed, "fit", *stream),
        priors=[
            Prior(**{old.get(key, key): value for key, value in params.priors[channel.name].items()})
            for channel in trials.channels
        ],
        iterations=sampler.iterations,
        chains=sampler.chains,
        inference=sampler.kind,
        keep_history=min(sampler.keep_history, sampler.iterations),
        # The one sampler has deviations from the paper to choose, the other annealing.
        **(
            {"settings": Settings(sampler.averaged_draws, sampler.empty_category)}
            if sampler.kind == "blocked"
            else {"temperature": sampler.temperature}
        ),
    )
    save(result, Path(snakemake.output[0]))
