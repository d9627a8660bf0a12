"""What the benchmarks' command line refuses."""

import pytest

from benchmarks.run import main


def test_an_unknown_task_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["--tasks", "hopper,hoper"])
    assert 'unknown task "hoper", did you mean "hopper"?' in capsys.readouterr().err
