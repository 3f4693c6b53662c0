"""Let one fit answer the instructions of the test set, and carry the answers out where the scenes are simulated."""

from data_collection.seeding import generator
from data_collection.simulation_settings import Simulation
from evaluation.acting import carry_out, commands
from evaluation.generation import answers, write_answers, write_distributions
from features.percept_data import join, load_percepts
from features.table import read_table
from features.transforms import load_transforms
from model import load
from workflow.artifacts.provenance import parts_of_code
from workflow.execution.job import job

with job(snakemake) as (files, out):
    names, params = snakemake.wildcards, snakemake.params
    fit = load(files.fit)
    table = read_table(files.trials, files.objects, need_attention=False)
    answered = answers(fit, table)
    out.logs.mkdir(parents=True)
    judged: list[str | None] = [None] * len(answered)
    if params.simulation is not None:
        condition = [names.experiment, names.variant, names.method, params.stream, names.D, names.ROW, names.seed]
        told = commands(
            generator(params.seed, "generate", *condition),
            fit,
            load_transforms(files.transforms),
            table,
            answered,
            join(map(load_percepts, files.percepts)).hand,
        )
        judged = carry_out(
            Simulation.model_validate(params.simulation),
            told,
            experiment=params.data,
            seed=params.data_seed,
            provenance=parts_of_code(params.code),
            folder=out.logs,
        )
    write_answers(table, answered, judged, out.answers)
    write_distributions(table, answered, out.scores)
