"""Endings of modules that run as programs."""

import subprocess
import sys

import pytest

ENDING = "from neol.base.ending import exit_codes\nfrom neol.base.errors import UserError\n"


def start(body: str) -> subprocess.Popen[str]:
    program = f"{ENDING}with exit_codes():\n    {body}"
    pipe = subprocess.PIPE
    return subprocess.Popen([sys.executable, "-c", program], stdout=pipe, stderr=pipe, text=True)


@pytest.mark.parametrize("length", [1, 10**6])
def test_a_reader_that_went_away_is_no_error(length: int) -> None:
    process = start(f"print('x' * {length})")
    assert process.stdout is not None and process.stderr is not None
    process.stdout.close()
    assert process.stderr.read() == ""
    assert process.wait() == 141
    process.stderr.close()


def test_a_users_error_is_one_line() -> None:
    stdout, stderr = (process := start("raise UserError('a.yaml: is missing')")).communicate()
    assert (process.returncode, stdout, stderr) == (2, "", "neol: a.yaml: is missing\n")
