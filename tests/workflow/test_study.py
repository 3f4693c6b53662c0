"""The smoke study, run for real: same bytes everywhere, only what is new is run."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from evaluation.convergence import read_lights
from evaluation.figures.catalogue import FIGURES
from model import load
from model.diagnostics import check_chains
from tests.browser import look, needs_chromium
from tests.workflow.runs import SMOKE, command, hashes, jobs, run
from workflow.artifacts.provenance import ROOT

pytestmark = pytest.mark.slow


def test_every_stage_left_its_artifacts(finished: Path) -> None:
    found = hashes(finished)
    for number in range(1, 7):
        assert f"mcap/simulator/train/trial_{number:04}.mcap" in found
    fits = [name for name in found if name.startswith("fits/")]
    assert len(fits) == 2 * 2 * 2 + 2 + 2  # with ALL, and another chain of each method at ROW 40
    assert {f"tables/simulator_csl.{form}" for form in ("csv", "md", "tex", "html")} <= set(found)
    assert {"claims.csv", "claims_comparisons.csv", "claims_shades.csv", "claims.html"} <= set(found)
    assert "tables/simulator_csl_differences.csv" in found
    assert {f"tables/simulator_uncertain.{form}" for form in ("csv", "md", "tex", "html")} <= set(found)
    assert {f"figures/simulator_{name}.png" for name in ("uncertain", "instructions")} <= set(found)
    assert "generation/simulator/default/proposed/published/D6/ROW0/seed1/scores.csv" in found
    assert "scores.csv" in found
    shown: tuple[str, ...] = ("words", "positions", "object_categories", "color_categories", "generation", "objects")
    shown += ("confusion_proposed", "confusion_mmlda")
    assert {f"figures/simulator_{name}.{form}" for name in shown for form in ("png", "pdf")} <= set(found)
    assert {f"figures/simulator_{name}" for name in ("action.gif", "trials.png", "features.png")} <= set(found)
    # 2 methods × 2 instructions.
    clips = [name for name in found if re.fullmatch(r"ratings/simulator/clips/clip_[0-9a-f]+_00[1-4]\.gif", name)]
    assert len(clips) == 4
    assert {"ratings/simulator/form.csv", "ratings/simulator/index.html", "ratings/simulator_key.csv"} <= set(found)


@pytest.mark.parametrize("method", ["proposed", "mmlda"])
def test_chains_of_one_omission_hear_the_same_and_draw_anew(finished: Path, method: str) -> None:
    folder = finished / "fits" / "simulator" / "default" / method / "published" / "D6" / "ROW40"
    first, further, other = (load(folder / f"seed{name}.npz") for name in ("1", "1_chain2", "2"))
    assert np.array_equal(first.trials.words, further.trials.words)
    assert np.array_equal(first.trials.word_trial, further.trials.word_trial)
    assert not np.array_equal(first.trace_log_joint, further.trace_log_joint)
    assert not np.array_equal(first.trials.words, other.trials.words)
    check_chains([first, further])
    with pytest.raises(ValueError, match="other words"):
        check_chains([first, other])


def test_every_condition_has_a_light_that_tables_and_report_tell(finished: Path) -> None:
    """Thirty sweeps do not converge, and where seeds hear different words two chains of one omission are compared."""
    found, diagnosed = read_lights(finished / "convergence.csv"), pd.read_csv(finished / "diagnostics.csv")
    conditions = {("proposed", 0), ("proposed", 40), ("mmlda", 0), ("mmlda", 40), ("gmm", 100)}
    assert set(zip(found.method, found.ROW, strict=True)) == conditions
    assert set(zip(diagnosed.method, diagnosed.ROW, strict=True)) == conditions
    assert found.chains.tolist() == [2] * len(conditions)
    assert set(found.light) == {"red"}
    words = diagnosed[(diagnosed.method == "proposed") & diagnosed.quantity.str.startswith("word_action_")]
    assert words.groupby("ROW").size().min() > 1
    for page in ("diagnostics.html", "report.html"):
        assert (finished / page).read_text().count('<span class="mark no"') >= len(conditions)
    for form in ("csl.md", "generation.html", "uncertain.tex"):
        assert "all of sampler published" in (finished / "tables" / f"simulator_{form}").read_text()


def test_the_counts_of_confusions_are_those_of_the_descriptions(finished: Path) -> None:
    described = pd.read_csv(finished / "descriptions" / "simulator_D6.csv")
    counts = pd.read_csv(finished / "confusion" / "simulator_D6.csv")
    keys = ["method", "ROW"]
    assert counts.groupby(keys)["count"].sum().to_dict() == described.groupby(keys).size().to_dict()


@needs_chromium
def test_the_report_shows_every_table_and_figure(finished: Path, tmp_path: Path) -> None:
    seen = look(finished / "report.html", tmp_path)
    tables = {path.stem for path in finished.glob("tables/*.html")}
    figures = {f"figures/{path.name}" for form in ("png", "gif") for path in finished.glob(f"figures/*.{form}")}
    assert figures <= set(seen.anchors)
    # Tables 2 and 3 of the paper have all their cells.
    assert tables - set(seen.anchors) == {"simulator_description", "simulator_generation"}
    assert (seen.images, seen.broken_images, seen.silent_images) == (len(figures), [], 0)
    assert (seen.lost_links, seen.fetched) == ([], [])


def test_links_of_the_report_lead_to_files(finished: Path) -> None:
    links = set(re.findall(r"href=[\"']([^#\"'][^\"']*)", (finished / "report.html").read_text()))
    assert [link for link in links if "://" not in link and not (finished / link).is_file()] == []
    assert {"scores.csv", "tables/simulator_csl.csv", "diagnostics/simulator_D6.html"} <= links


def test_snakemake_reports_it_as_well(finished: Path, tmp_path: Path) -> None:
    run(SMOKE, finished, "--report", str(tmp_path / "snakemake.html"))
    page = (tmp_path / "snakemake.html").read_text()
    assert not re.findall(r"<(?:script|link|img)[^>]* (?:src|href)=.https?:", page)
    for shown in ("Learning, simulator, D = 6", "Words, simulator", "report.html", "scores.csv"):
        assert f'"{shown}"' in page


def test_no_artifact_names_this_machine(finished: Path) -> None:
    traces = [str(ROOT).encode(), str(finished.parent).encode()]
    if len(os.uname().nodename) > 5:  # a shorter name occurs in compressed data by chance
        traces.append(os.uname().nodename.encode())
    for name in hashes(finished):
        content = (finished / name).read_bytes()
        assert not any(trace in content for trace in traces), name


def test_the_same_bytes_again_on_another_number_of_cores(finished: Path, tmp_path: Path) -> None:
    run(SMOKE, tmp_path / "out", "--cores", "1")
    assert hashes(tmp_path / "out") == hashes(finished)


def test_a_finished_study_runs_nothing(finished: Path) -> None:
    run(SMOKE, finished)
    assert jobs(finished) == {}


def workflow(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    line = [sys.executable, "-m", "workflow", *map(str, arguments)]
    return subprocess.run(line, cwd=ROOT, capture_output=True, text=True, check=False)


def test_another_folder_is_filled_from_the_cache(finished: Path, tmp_path: Path) -> None:
    run(SMOKE, tmp_path / "out", cache=Path(f"{finished}.cache"))
    assert jobs(tmp_path / "out") == {}
    assert hashes(tmp_path / "out") == hashes(finished)
    assert (tmp_path / "out" / "manifest.json").read_bytes() == (finished / "manifest.json").read_bytes()


def test_damage_is_verified_and_mended(finished: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    subprocess.run(["cp", "-a", str(finished), str(out)], check=True)
    assert workflow("verify", "--out", out).returncode == 0
    fit = next((out / "fits").rglob("seed2.npz"))
    name = fit.relative_to(out).as_posix()
    fit.write_bytes(fit.read_bytes()[:-1])
    done = workflow("verify", "--out", out)
    assert done.returncode == 1
    assert f"changed: {name}" in done.stdout
    printed = run(SMOKE, out)
    assert f"damaged: {name}, will be made again" in printed
    assert jobs(out) == {"fit": 1}
    assert workflow("verify", "--out", out).returncode == 0
    assert hashes(out) == hashes(finished)


def test_lineage_of_a_table(finished: Path) -> None:
    done = workflow("explain", finished / "tables" / "simulator_csl.md")
    assert done.returncode == 0
    for line in (
        "scores.csv",
        "rule fit",
        "rule features",
        "rule perceive",
        "trial_0001.mcap",
        "rule collect_",
        "seed: 1",
    ):
        assert line in done.stdout


def test_an_interrupt_stops_the_run_and_its_jobs(tmp_path: Path) -> None:
    out = tmp_path / "out"
    with subprocess.Popen(
        command(SMOKE, out),
        cwd=ROOT,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
        # A shell has its background jobs ignore interrupts, and so would all that these tests start.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    ) as process:
        while not (out / "joblogs" / "collect").exists():
            time.sleep(0.1)
        os.killpg(process.pid, signal.SIGINT)
        assert process.wait(60) == 1
    with pytest.raises(ProcessLookupError):  # nobody of the group lives on
        os.killpg(process.pid, 0)
    assert not (out / "manifest.json").exists()


def test_only_new_conditions_run(finished: Path, tmp_path: Path) -> None:
    """ROW 80 and a third seed: the fits that did not exist, and what sums them up."""
    out = tmp_path / "out"
    subprocess.run(["cp", "-a", str(finished), str(out)], check=True)
    before = hashes(out)
    config = yaml.safe_load(SMOKE.read_text())
    config["experiments"]["simulator"]["ROW"].append(80)
    config["experiments"]["simulator"]["seeds"] += 1
    (tmp_path / "more.yaml").write_text(yaml.safe_dump(config))
    run(tmp_path / "more.yaml", out)
    ran = jobs(out)
    # 2 methods: ROW 80 × 3 seeds, ROW 0 and 40 × the new seed; ALL × the new seed.
    assert ran.pop("fit") == 2 * 3 + 2 * 2 + 1
    assert ran.pop("fit_chain") == 2  # at ROW 80; a third seed is none of the first one's chains
    assert ran.pop("generate") == 2 * 1  # 2 methods × the new seed at ROW 0
    assert ran.pop("figure_confusion") == 2
    sums = ["evaluate_learning", "describe", "evaluate_generation", "diagnose", "scores", "tables", "claims"]
    sums += ["uncertain", "report", "count_confusions", "ratings", "convergence"]
    # Figures of the data stay, and there is none over one D.
    not_drawn = {"features", "trials", "objects", "learning_curves"}
    # The study shows one sampler, so that each figure of a fit is one.
    shown = [name.removesuffix("{sampler}") for name in FIGURES if name not in not_drawn]
    sums += [f"figure_{name}" for name in shown if "{" not in name]
    assert ran == dict.fromkeys(sums, 1)
    after = hashes(out)
    kept = [name for name in before if name.split("/")[0] in ("mcap", "percepts", "features", "fits")]
    assert {name: after[name] for name in kept} == {name: before[name] for name in kept}


def test_two_studies_at_once_in_one_folder(tmp_path: Path) -> None:
    out = tmp_path / "out"
    with subprocess.Popen(
        command(SMOKE, out), cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    ) as process:
        while not (out / ".running").exists():
            time.sleep(0.1)
        time.sleep(0.5)
        assert "another study is running in this folder" in run(SMOKE, out, succeeds=False)
        process.kill()
