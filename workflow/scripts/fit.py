"""Fit one method to one condition."""

from pathlib import Path

from data_collection.seeding import generator
from features.table import read_table
from model import Prior, Settings, Trials, fit, save
from model.omission import kept_words
from workflow.execution.job import job

BOXES = {"position": (-0.5, 0.5)}

with job(snakemake):
    names, params = snakemake.wildcards, snakemake.params
    table = read_table(Path(snakemake.input.trials), Path(snakemake.input.objects), need_attention=True)
    trials = Trials.from_arrays(**table.learning_input())
    # The same words are omitted for all methods, so that methods are compared in pairs.
    omission = generator(params.seed, "omission", params.data, int(names.D), int(names.seed))
    inference = names.inference.partition("_")[0]
    condition = [names[key] for key in ("experiment", "variant", "method", "inference", "D", "ROW", "seed")]
    result = fit(
        trials.keep_words(kept_words(omission, len(trials.word_trial), int(names.ROW))),
        names.method,
        generator(params.seed, "fit", *condition),
        priors=[
            Prior(**params.priors[channel.name], box=BOXES.get(channel.name, (0.0, 1.0)))
            for channel in trials.channels
        ],
        iterations=params.iterations,
        chains=params.chains,
        inference=inference,
        keep_history=min(params.keep_history, params.iterations),
        # The one sampler has deviations from the paper to choose, the other annealing.
        **(
            {"settings": Settings(**params.sampler)}
            if inference == "blocked"
            else {"temperature": params.temperature}
        ),
    )
    save(result, Path(snakemake.output[0]))
