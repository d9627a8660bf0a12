"""A Slurm of one machine: `python -m tests.cluster.slurm COMMAND...` runs a command in it.

Its daemons are children of this process, below one temporary folder; they need no right of root.
"""

import getpass
import os
import secrets
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "srun", "squeue", "scancel", "setpriv")
PATH = os.pathsep.join([os.environ["PATH"], "/usr/sbin"])

CONFIGURATION = """\
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
SlurmUser={user}
SlurmdUser={user}
AuthInfo=socket={folder}/munge.socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MpiDefault=none
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} RealMemory={megabytes}
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def missing() -> list[str]:
    """Return the programs of Slurm and munge that this machine lacks."""
    return [program for program in PROGRAMS if shutil.which(program, path=PATH) is None]


@contextmanager
def slurm() -> Iterator[dict[str, str]]:
    """Run a Slurm during the context; yields the environment that its commands need."""
    with tempfile.TemporaryDirectory(prefix="slurm-") as name, ExitStack() as stack:
        folder = Path(name)
        _configure(folder)
        environment = os.environ | {
            "PATH": f"{folder}{os.pathsep}{PATH}",
            "SLURM_CONF": str(folder / "slurm.conf"),
        }

        def start(*command: str) -> None:
            with (folder / f"{command[0]}.log").open("w") as log:
                daemon = subprocess.Popen(
                    ["setpriv", "--pdeathsig", "TERM", *command],  # even if this process is killed
                    env=environment,
                    stdin=subprocess.DEVNULL,
                    stdout=log,
                    stderr=log,
                )
            stack.callback(daemon.wait)
            stack.callback(daemon.terminate)

        def succeeds(*command: str) -> bool:
            return subprocess.run(command, env=environment, capture_output=True).returncode == 0

        start(
            "munged",
            "--foreground",
            "--force",
            *(
                f"--{option}={folder}/munge.{option.removesuffix('-file')}"
                for option in ("key-file", "log-file", "pid-file", "seed-file", "socket")
            ),
        )
        _wait(folder, lambda: succeeds("munge", f"--socket={folder}/munge.socket", "--no-input"))
        start("slurmctld", "-D", "-i")
        start("slurmd", "-D")
        _wait(folder, lambda: succeeds("srun", "--immediate=5", "true"))
        stack.callback(_cancel_all, environment)
        yield environment


def _configure(folder: Path) -> None:
    for subfolder in ("state", "spool"):
        (folder / subfolder).mkdir()
    key = folder / "munge.key"
    key.touch(mode=0o600)
    key.write_bytes(secrets.token_bytes(128))
    controller_port, node_port = _free_ports()
    text = CONFIGURATION.format(
        folder=folder,
        host=socket.gethostname().partition(".")[0],
        user=getpass.getuser(),
        controller_port=controller_port,
        node_port=node_port,
        cpus=os.cpu_count(),
        megabytes=os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") // 2**20,
    )
    (folder / "slurm.conf").write_text(text)
    real_srun = shutil.which("srun", path=PATH)
    # Snakemake's executor starts srun without the variables of Slurm, this one too.
    srun = folder / "srun"
    srun.write_text(f'#!/bin/sh\nSLURM_CONF={folder}/slurm.conf exec {real_srun} "$@"\n')
    srun.chmod(0o755)


def _free_ports() -> tuple[int, int]:
    with socket.socket() as one, socket.socket() as other:
        one.bind(("127.0.0.1", 0))
        other.bind(("127.0.0.1", 0))
        return one.getsockname()[1], other.getsockname()[1]


def _wait(folder: Path, ready: Callable[[], bool]) -> None:
    for _ in range(60):
        if ready():
            return
        time.sleep(0.5)
    said = "\n".join(path.read_text(errors="replace") for path in sorted(folder.glob("*.log")))
    raise RuntimeError(f"Slurm does not start:\n{said}")


def _cancel_all(environment: dict[str, str]) -> None:
    """End all jobs, because an ended daemon leaves its jobs running."""

    def jobs() -> str:
        return subprocess.run(
            ["squeue", "--noheader"], env=environment, capture_output=True, text=True
        ).stdout

    subprocess.run(["scancel", "--user", getpass.getuser()], env=environment)
    for _ in range(80):
        if not jobs():
            return
        time.sleep(0.5)


if __name__ == "__main__":
    with slurm() as environment:
        sys.exit(subprocess.run(sys.argv[1:], env=environment).returncode)
