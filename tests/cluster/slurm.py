"""A real Slurm of one node on this machine, on 127.0.0.1 alone: `python -m tests.cluster.slurm FOLDER COMMAND …`.

The command finds it as any Slurm, by `sbatch` and so on; Slurm ends with it. All that Slurm writes is in the folder.
"""

from __future__ import annotations

import os
import secrets
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

COMMANDS = ("sacct", "sacctmgr", "sbatch", "scancel", "scontrol", "sinfo", "squeue", "srun")
PROGRAMS = ("munged", "slurmctld", "slurmd", *COMMANDS)
PACKAGES = "slurmctld slurmd slurm-client slurm-wlm-basic-plugins munge"
PATIENCE = 30.0  # seconds for anything to start or to stop
CPUS = 2
PATH = os.pathsep.join([os.environ.get("PATH", ""), "/usr/sbin", "/sbin"])

# No accounting, no cgroups; a finished job stays in `squeue` for MinJobAge seconds, which is how the plugin sees it.
CONFIGURATION = """\
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
SlurmUser=root
SlurmdUser=root
AuthInfo=socket={folder}/munge.socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/filetxt
JobCompLoc={folder}/jobs.txt
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MpiDefault=none
ReturnToService=2
EnforcePartLimits=ALL
MinJobAge=3600
KillWait=2
SlurmdParameters=config_overrides
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} RealMemory=16000
PartitionName=local Nodes={host} Default=YES MaxTime=1-0 State=UP
"""

# Our configuration is named here rather than by SLURM_CONF alone, because Snakemake's plugin removes SLURM_… from the
# environment of its jobs, nor is it put into /etc, where it would be everybody's.
COMMAND = """\
#!/bin/sh
SLURM_CONF='{configuration}' exec '{program}' "$@"
"""


@dataclass(frozen=True)
class Slurm:
    """A running Slurm.

    Attributes:
        folder: Where it writes.
        environment: That of those who use it.
    """

    folder: Path
    environment: dict[str, str]

    def call(self, *command: str) -> str:
        """What one of Slurm's commands prints.

        Raises:
            subprocess.SubprocessError: It failed, or took too long.
        """
        return subprocess.run(
            command, env=self.environment, capture_output=True, text=True, check=True, timeout=PATIENCE
        ).stdout

    def ended(self) -> list[dict[str, str]]:
        """The jobs that have ended, in this order: JobId, JobState, StartTime, EndTime, ProcCnt and more by name."""
        record = self.folder / "jobs.txt"
        lines = record.read_text(encoding="utf-8").splitlines() if record.exists() else []
        return [dict(word.split("=", 1) for word in line.split() if "=" in word) for line in lines]


def missing() -> str:
    """Why Slurm cannot be started here; empty where it can."""
    absent = [program for program in PROGRAMS if shutil.which(program, path=PATH) is None]
    if absent:
        return f"needs {PACKAGES}: apt install --no-install-recommends {PACKAGES}"
    return "" if os.geteuid() == 0 else "slurmd can be started by root alone"


@contextmanager
def slurm(folder: Path) -> Iterator[Slurm]:
    """Start a Slurm in a new folder, and stop it however the block ends.

    Raises:
        RuntimeError: It did not start; with what it said.
    """
    running = Slurm(folder.resolve(), {**os.environ, "PATH": f"{folder.resolve()}/bin{os.pathsep}{PATH}"})
    _write_files(running.folder)
    key, configuration = str(running.folder / "munge.key"), str(running.folder / "slurm.conf")
    munge = [f"--{name}-file={running.folder}/munge.{name}" for name in ("pid", "seed", "log")]
    socket_file = running.folder / "munge.socket"
    with ExitStack() as stack:
        # --force: the folder need not be open to others, who have no business here.
        munge += ["--force", f"--key-file={key}", f"--socket={socket_file}"]
        stack.enter_context(_daemon(running, "munged", "--foreground", *munge))
        _wait(running, "munged", socket_file.exists)
        stack.enter_context(_daemon(running, "slurmctld", "-D", "-f", configuration))
        stack.enter_context(_daemon(running, "slurmd", "-D", "-f", configuration, "-N", _host()))
        _wait(running, "slurmctld", lambda: _says(running, "idle", "sinfo", "--noheader", "--format=%T"))
        try:
            yield running
        finally:
            running.call("scancel", "--partition=local")
            _wait(running, "slurmctld", lambda: not running.call("squeue", "--noheader"))


def _write_files(folder: Path) -> None:
    for name in ("state", "spool", "bin"):
        (folder / name).mkdir(parents=True)
    folder.chmod(0o755)
    key = folder / "munge.key"
    key.write_bytes(secrets.token_bytes(1024))
    key.chmod(0o400)
    configuration = folder / "slurm.conf"
    configuration.write_text(
        CONFIGURATION.format(host=_host(), folder=folder, cpus=CPUS, ports=_free_ports(2)), encoding="utf-8"
    )
    for name in COMMANDS:
        command = folder / "bin" / name
        command.write_text(COMMAND.format(configuration=configuration, program=shutil.which(name, path=PATH)))
        command.chmod(0o755)


@contextmanager
def _daemon(running: Slurm, name: str, *arguments: str) -> Iterator[None]:
    """Run a program as long as the block lasts, or this process lives."""
    line = ["setpriv", "--pdeathsig", "TERM", shutil.which(name, path=PATH) or name, *arguments]
    with (running.folder / f"{name}.log").open("w") as log:
        process = subprocess.Popen(line, env=running.environment, stdout=log, stderr=subprocess.STDOUT)
    try:
        yield
    finally:
        process.terminate()
        try:
            process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _wait(running: Slurm, name: str, done: Callable[[], bool]) -> None:
    until = time.monotonic() + PATIENCE
    while not done():
        if time.monotonic() > until:
            said = (running.folder / f"{name}.log").read_text(encoding="utf-8", errors="replace")
            raise RuntimeError(f"{name} was not ready in {PATIENCE:.0f} s:\n{said[-3000:]}")
        time.sleep(0.1)


def _says(running: Slurm, what: str, *command: str) -> bool:
    try:
        return running.call(*command).strip() == what
    except subprocess.SubprocessError:
        return False


def _host() -> str:
    return socket.gethostname().partition(".")[0]


def _free_ports(count: int) -> list[int]:
    with ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for each in sockets:
            each.bind(("127.0.0.1", 0))
        return [each.getsockname()[1] for each in sockets]


def main() -> int:
    """Run a command that finds a Slurm; its exit status."""
    with slurm(Path(sys.argv[1])) as running:
        return subprocess.run(sys.argv[2:], env=running.environment, check=False).returncode


if __name__ == "__main__":
    if missing():
        sys.exit(missing())
    sys.exit(main())
