"""Commands on logs: `python -m data_collection check | show | regenerate | export-lerobot | topics`."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from data_collection.console import counted, run_command
from data_collection.log.mcap_log import Log, LogError, read_log
from data_collection.log.topics import TOPICS
from data_collection.processor import begin_pinned


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; return 0, or 1 when a log is bad or differs."""
    parser = argparse.ArgumentParser(prog="python -m data_collection", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    check = commands.add_parser("check", help="validate logs and summarise them")
    check.add_argument("logs", nargs="+", type=Path, metavar="LOG", help="log files")
    show = commands.add_parser("show", help="write a picture strip and an animation of each log")
    show.add_argument("logs", nargs="+", type=Path, metavar="LOG", help="log files")
    show.add_argument("--out", type=Path, default=Path(), metavar="FOLDER", help="where to (default: here)")
    show.add_argument(
        "--every", type=int, default=2, metavar="N", help="animate every Nth joint message (default: %(default)s)"
    )
    show.add_argument("--no-animation", action="store_true", help="only the strip (default: both)")
    again = commands.add_parser("regenerate", help="simulate trials again from their metadata and compare")
    again.add_argument("logs", nargs="+", type=Path, metavar="LOG", help="log files of a simulation")
    export = commands.add_parser("export-lerobot", help="write trials as a LeRobot v3.0 dataset")
    export.add_argument("logs", nargs="+", type=Path, metavar="LOG", help="log files, or folders of them")
    export.add_argument("--out", type=Path, required=True, metavar="FOLDER", help="where to: a new folder")
    commands.add_parser("topics", help="print the table of topics")
    options = parser.parse_args(arguments)
    if options.command == "topics":
        _say(topics())
        return 0
    if options.command == "export-lerobot":
        return _export(options.logs, options.out)
    actions = {"check": _check, "show": _show, "regenerate": _regenerate}
    failed = 0
    for path in options.logs:
        try:
            sound = actions[options.command](path, options)
        except LogError as error:
            _say(f"{error}", error=True)
            sound = False
        failed += not sound
    if len(options.logs) > 1 or failed:
        are = "is" if len(options.logs) == 1 else "are"
        _say(f"{len(options.logs) - failed} of {counted(len(options.logs), 'log')} {are} in order")
    return 1 if failed else 0


def topics() -> str:
    """Return the table of topics as Markdown."""
    lines = ["| topic | type | value | unit | frame | required in | optional in | meaning |", "|" + " --- |" * 8]
    for topic in TOPICS:
        cells = (
            f"`{topic.name}`", topic.value.type, topic.value.shape, topic.value.unit, topic.value.frame,
            ", ".join(topic.required), ", ".join(topic.optional),
            topic.meaning + ("; once" if topic.once else ""),
        )  # fmt: skip
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _check(path: Path, options: argparse.Namespace) -> bool:
    from data_collection.log.times import time_notes
    from data_collection.log.validation import kind_of, problems, told

    log = read_log(path)
    if found := problems(log):
        raise LogError(told(found))
    kind = kind_of(log)
    _say(f"{path}: {kind}, {len(log.messages)} messages, {_seconds(log):.2f} s{_said(log)}")
    for note in time_notes(log) if kind == "trial" else ():
        _say(f"  note: {note}")
    return True


def _show(path: Path, options: argparse.Namespace) -> bool:
    from data_collection import show
    from data_collection.image_files import save_gif, save_png
    from data_collection.log.validation import kind_of

    log = read_log(path)
    if kind_of(log) == "calibration":
        raise LogError(f"{path}: a calibration log shows no trial")
    picture = options.out / f"{path.stem}.png"
    save_png(picture, show.strip(log))
    _say(str(picture))
    if not options.no_animation:
        frames = show.animation(log, every=max(1, options.every))
        save_gif(options.out / f"{path.stem}.gif", frames, len(frames) / max(_seconds(log), 0.05))
        _say(str(options.out / f"{path.stem}.gif"))
    return True


def _regenerate(path: Path, options: argparse.Namespace) -> bool:
    from data_collection.log_differences import differences, regenerate

    log = read_log(path)
    found = differences(log, regenerate(log))
    _say(f"{path}: " + ("the same" if not found else f"differs from the simulation ({len(found)})"))
    for difference in found[:20]:
        _say(f"  {difference}")
    return not found


def _export(logs: Sequence[Path], out: Path) -> int:
    from data_collection.lerobot.export import export

    files = [file for path in logs for file in (sorted(path.rglob("*.mcap")) if path.is_dir() else [path])]
    try:
        notes = export(files, out)
    except (LogError, FileExistsError) as error:
        _say(str(error), error=True)
        return 1
    for note in notes:
        _say(f"note: {note}")
    _say(f"{out}: written")
    return 0


def _seconds(log: Log) -> float:
    times = [message.time for message in log.messages]
    return (max(times) - min(times)) / 1e9 if times else 0.0


def _said(log: Log) -> str:
    from data_collection.log.topics import SENTENCE

    sentences = [str(message.value) for message in log.messages if message.topic == SENTENCE]
    return f", “{sentences[-1]}”" if sentences else ""


def _say(text: str, *, error: bool = False) -> None:
    (sys.stderr if error else sys.stdout).write(f"{text}\n")


if __name__ == "__main__":
    begin_pinned()  # so that a simulation can be compared with that of a study
    sys.exit(run_command(main))
