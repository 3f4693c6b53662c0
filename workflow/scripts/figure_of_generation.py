"""Show what the most probable fit of a condition made the robot do, as pictures and as an animation of one action."""

from pathlib import Path

from data_collection.log.mcap_log import read_log
from data_collection.log.trial import observation
from data_collection.show import animation, save_gif
from evaluation.best_fit import by_log_joint, title
from evaluation.figures.drawing import save_figure
from evaluation.figures.generation import generated_actions, shown_action
from evaluation.generation import read_answers
from workflow.execution.job import job

WIDTH, HEIGHT, EVERY, RATE = 400, 300, 2, 8.0

with job(snakemake):
    best, fit = by_log_joint(Path(path) for path in snakemake.input.fits)[0]
    shown = title(snakemake.params.condition, fit, best, len(snakemake.input.fits))
    answered = read_answers(Path(snakemake.input.answers[best]))
    logs = [read_log(Path(snakemake.input.logs[best]) / f"trial_{trial:04}.mcap") for trial in answered["trial"]]
    seen = [observation(log) for log in logs]
    pictures = [(one.image_before, one.image_after) for one in seen if one.image_after is not None]
    save_figure(generated_actions(answered, pictures, shown), *map(Path, snakemake.output.generation))
    log = logs[shown_action(answered, logs)]
    save_gif(
        Path(snakemake.output.action[0]), animation(log, width=WIDTH, height=HEIGHT, every=EVERY), RATE, hold=2.0
    )
