"""Make clips of generated actions, in a blind order, with a form and a page for human raters, and the key to them."""

from pathlib import Path

from data_collection.image_files import save_gif
from data_collection.log.mcap_log import read_log
from data_collection.seeding import generator
from data_collection.show import brief
from evaluation.figures.source import by_log_joint
from evaluation.generation import read_answers
from evaluation.ratings import make_key, write_form, write_page
from evaluation.scores import write_csv
from workflow.execution.job import job

with job(snakemake) as (_, out):
    names, params = snakemake.wildcards, snakemake.params
    rows = []
    for conditions in params.conditions:
        for place, _ in by_log_joint(Path(one["fit"]) for one in conditions)[: params.rated]:
            one = conditions[place]
            for answer in read_answers(Path(one["answers"])).itertuples():
                told = {"trial": answer.trial, "instructed": answer.action, "judged": answer.judged}
                rows.append(one["names"] | told | {"log": f"{one['logs']}/trial_{answer.trial:04}.mcap"})
    key = make_key(rows, params.words, generator(params.seed, "ratings", names.experiment))
    clips = []
    for clip, log, allowed in zip(key["clip"], key["log"], key["allowed"], strict=True):
        save_gif(out.folder / "clips" / f"{clip}.gif", brief(read_log(Path(log))), rate=4.0, hold=2.0)
        clips.append((clip, f"clips/{clip}.gif", allowed.split()))
    write_form(key, out.folder / "form.csv")
    write_page(clips, f"What does the robot do? ({names.experiment})", out.folder / "index.html")
    write_csv(key, out.key)
