"""`python -m benchmarks.memory TASK P G`: peak memory of a run, in MB, with episodes of one step.

All of a run but long episodes, which need no memory: real environment, NEAT, checkpoints, record.
"""

import resource
import sys
import tempfile
from pathlib import Path

from neol.run.runner import run_block
from neol.spec.configuration import load_configuration


def main() -> None:
    task, population, generations = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    spec = load_configuration("paper", [f"tasks.{task}.max_steps=1"]).run_spec(
        task=task,
        method="hebb",
        population=population,
        learning_rate=2.5e-4,
        generations=generations,
        seed=0,
    )
    with tempfile.TemporaryDirectory() as folder:
        run_block(spec, [0], Path(folder) / "run.parquet")
    print(peak_megabytes())


def peak_megabytes() -> float:
    """Return this program's peak memory; on Linux, getrusage would count its parent process."""
    status = Path("/proc/self/status")
    if status.exists():
        (line,) = (line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
        return int(line.split()[1]) / 2**10
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20  # macOS counts bytes


if __name__ == "__main__":
    main()
