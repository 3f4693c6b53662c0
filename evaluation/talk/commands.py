"""The commands `tell`, `describe` and `talk` of `python -m evaluation`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from evaluation.talk.acting import Picture
    from evaluation.talk.robots import Robot
    from evaluation.talk.scenes import SceneName, Scenes, SetName

COMMANDS = ("tell", "describe", "talk")
PORT = 8321


def add_commands(commands: Any) -> None:
    """Add the commands to a parser's subparsers."""
    tell = commands.add_parser("tell", help="tell a robot of a finished study what to do, and see what it does")
    _add_robot(tell)
    tell.add_argument("sentence", help='what it is told, such as "grasp the red cup"')
    _add_scene(tell, "of the test set with instructions")
    tell.add_argument("--no-action", action="store_true", help="only what the robot understands (default: it acts)")
    tell.add_argument("--out", type=Path, default=Path("tell.gif"), metavar="GIF", help="clip (default: tell.gif)")
    describe = commands.add_parser("describe", help="let a robot act of its own accord, and say what it did")
    _add_robot(describe)
    _add_scene(describe, "of the test set with actions")
    describe.add_argument("--out", type=Path, metavar="GIF", help="write a clip, too (default: none)")
    talk = commands.add_parser("talk", help="serve a page, to this machine alone, on which to talk to the robots")
    talk.add_argument("results", type=Path, help="output folder of a finished study")
    talk.add_argument("--port", type=_port, default=PORT, help=f"of 127.0.0.1 (default: {PORT}; 0: any free one)")
    _add_weights(talk)


_NAMES = {
    "experiment": "the first",
    "variant": "the first",
    "method": "the proposed one",
    "sampler": "of what remains, the fit with the highest log joint",
}
_NUMBERS = {"D": "most trials", "ROW": "fewest words omitted", "seed": "the fit with the highest log joint"}


def _add_robot(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("results", type=Path, help="output folder of a finished study")
    asked = parser.add_argument_group("whose fit")
    for name, default in _NAMES.items():
        asked.add_argument(f"--{name}", help=f"(default: {default})")
    for name, default in _NUMBERS.items():
        asked.add_argument(f"--{name}", type=int, metavar="N", help=f"(default: {default})")
    _add_weights(parser)


def _add_weights(parser: argparse.ArgumentParser) -> None:
    told = "of the network's weights, if the study named one"
    parser.add_argument("--weights", type=Path, metavar="FILE", help=f"file {told} (default: none)")


def _add_scene(parser: argparse.ArgumentParser, which: str) -> None:
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--scene", type=int, metavar="N", help=f"scene N {which} (default: the first)")
    where.add_argument("--draw", type=int, metavar="N", help="a new scene, the Nth that is drawn (default: none)")


def _port(text: str) -> int:
    if not text.isdecimal() or int(text) > 65_535:
        raise argparse.ArgumentTypeError(f"{text!r} is no port (0 to 65535)")
    return int(text)


def run(options: argparse.Namespace) -> int:
    """Run one of `COMMANDS`; 0, or a ValueError or FileNotFoundError that says what is wrong."""
    if options.command == "talk":
        from evaluation.talk.server import serve

        return serve(options.results, options.port, options.weights)
    return _tell(options) if options.command == "tell" else _describe(options)


def _tell(options: argparse.Namespace) -> int:
    from evaluation.talk.telling import done, told
    from evaluation.talk.understanding import hear, words_of
    from model import METHODS

    words_of(options.sentence, ())  # a sentence that is too long is refused before anything is loaded
    robot, scenes, name = _asked(options, "generation")
    scene = scenes.scene(robot, name)
    table, row = scenes.features(robot, scene)
    understood = hear(robot, table, row, options.sentence)
    _say([f"{robot.name.label}; {name}"], told(understood, table, row, METHODS[robot.name.method]))
    if options.no_action:
        return 0
    from data_collection.image_files import save_gif
    from evaluation.talk.acting import obey, reason_not_to_act

    if reason := reason_not_to_act(scenes, robot, scene):
        _say([reason])
        return 0
    pictures: list[Picture] = []
    _say(done(obey(scenes, robot, scene, understood, pictures.append)))
    save_gif(options.out, [picture.image for picture in pictures], rate=5.0, hold=2.0)
    _say([f"{options.out}: the clip"])
    return 0


def _describe(options: argparse.Namespace) -> int:
    from evaluation.talk.acting import on_its_own
    from evaluation.talk.telling import done

    robot, scenes, name = _asked(options, "description")
    deed = on_its_own(robot, scenes.scene(robot, name, "description"))
    _say([f"{robot.name.label}; {name}"], done(deed), [f"the tutor says: {deed.heard or '(nothing)'}"])
    if options.out is not None:
        from data_collection.image_files import save_gif
        from data_collection.show import brief

        save_gif(options.out, brief(deed.log), rate=4.0, hold=2.0)
        _say([f"{options.out}: written"])
    return 0


def _asked(options: argparse.Namespace, set_name: SetName) -> tuple[Robot, Scenes, SceneName]:
    """The robot and the scene that are asked for."""
    from evaluation.talk.robots import NAMES, choose, load_robot, robots_of
    from evaluation.talk.scenes import SceneName, Scenes

    chosen = choose(options.results, robots_of(options.results), {name: getattr(options, name) for name in NAMES})
    robot = load_robot(options.results, chosen)
    scenes = Scenes(options.results, robot.data, options.weights)
    if options.draw is not None:
        return robot, scenes, SceneName(options.draw, drawn=True)
    number = scenes.numbers(robot, set_name)[0] if options.scene is None else options.scene
    return robot, scenes, SceneName(number)


def _say(*parts: Sequence[str] | Iterator[str]) -> None:
    for lines in parts:
        for line in lines:
            sys.stdout.write(f"{line}\n")
    sys.stdout.flush()
