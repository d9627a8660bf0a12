"""Files and words from strangers: each loads or gives one clear line, and none is executed.

`NEOL_FUZZ=5000 pytest tests/cli/test_untrusted.py` tries so many damaged inputs of each kind.
"""

import ast
import json
import os
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import papermill.translators
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from neol.base.errors import UserError
from neol.run import checkpoint
from neol.run.checkpoint import Arrays, Past
from neol.run.record import SCHEMA
from neol.run.record_file import read_footer, read_record
from neol.spec import configuration as spec
from neol.spec.configuration import CONFIG, load_configuration
from neol.spec.plain_yaml import parse_yaml
from neol.study.campaign.shown import folder
from neol.study.claims.questions import CLAIMS, QUESTIONS, load_claims, load_questions
from neol.study.output.sidecar import trace
from neol.study.verification import manifest
from neol.study.verification.check import Verification
from tests.helpers.damage import (
    HOSTILE,
    TOKENS,
    Json,
    damaged,
    forge_checkpoint,
    forge_record,
    mistake,
)
from tests.helpers.refusal import survive
from tests.helpers.runs import run_spec, started
from tests.study.verification.campaign import OJA, make_campaign, patch_budget

EXAMPLES = int(os.environ.get("NEOL_FUZZ", "60"))
fuzz = settings(max_examples=EXAMPLES, deadline=None, suppress_health_check=list(HealthCheck))

Read = Callable[[Path], object]

SIDECAR = {
    "outputs": {"table3.tex": "0" * 64, "table3.csv": "1" * 64},
    "command": "snakemake figures/table3.tex",
    "commit": None,
    "dirty": False,
    "budget": "smoke",
    "configuration": "2" * 64,
    "records": [
        {"path": "a.parquet", "sha256": "3" * 64, "spec": "4" * 64, "runs": {"0": "5" * 64}}
    ],
}


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Whole files of every kind that is read."""
    folder = tmp_path_factory.mktemp("whole")
    make_campaign(folder / "smoke")
    (folder / "a.parquet").write_bytes((folder / "smoke" / OJA).read_bytes())
    checkpoint.write_checkpoint(folder / "a.npz", started(run_spec(), 2), Past())
    (folder / "a.json").write_text(json.dumps(SIDECAR))
    (folder / "manifest.json").write_bytes((folder / "smoke" / "manifest.json").read_bytes())
    (folder / "a.yaml").write_bytes((CONFIG / "smoke.yaml").read_bytes())
    (folder / "claims.yaml").write_text(some(CLAIMS, "nothing"))
    (folder / "questions.yaml").write_text(some(QUESTIONS, "kind"))
    return folder


def some(path: Path, key: str) -> str:
    """The file with one entry of each kind, or the first of all, which is read sooner."""
    head, *entries = re.split(r"^(?=  - id: )", path.read_text(), flags=re.MULTILINE)
    kinds = {(re.findall(rf"{key}: (\w+)", each) or [""])[0]: each for each in reversed(entries)}
    return head + "".join(kinds.values())


@pytest.fixture(scope="module")
def damaged_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the damaged ones are put, one after the other."""
    return tmp_path_factory.mktemp("damaged")


def read_trace(path: Path) -> object:
    output = path.with_suffix(".tex")
    output.touch()
    return list(trace(output, path.parent))


def read_configuration(path: Path) -> object:
    """The file as a budget of its own, over the real base.yaml."""
    config = path.parent / "config"
    config.mkdir(exist_ok=True)
    (config / "base.yaml").write_bytes((CONFIG / "base.yaml").read_bytes())
    (config / "mine.yaml").write_bytes(path.read_bytes())
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(spec, "CONFIG", config)
        return load_configuration("mine")


# kind: (the whole file, the name that a damaged one gets, what reads it)
KINDS: dict[str, tuple[str, str, Read]] = {
    "record": ("a.parquet", "x.parquet", read_record),
    "record's footer": ("a.parquet", "x.parquet", read_footer),
    "checkpoint": ("a.npz", "x.npz", lambda path: checkpoint.read_checkpoint(path, run_spec())),
    "manifest": (
        "manifest.json",
        "manifest.json",
        lambda path: manifest.read_manifest(path.parent),
    ),
    "sidecar": ("a.json", "table3.json", read_trace),
    "configuration": ("a.yaml", "x.yaml", read_configuration),
    "claims": ("claims.yaml", "claims.yaml", load_claims),
    "questions": ("questions.yaml", "questions.yaml", load_questions),
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@fuzz
@given(data=st.data())
def test_damaged_files_load_or_give_one_clear_error(
    kind: str, data: st.DataObject, home: Path, damaged_folder: Path
) -> None:
    whole, name, read = KINDS[kind]
    path = damaged_folder / name
    path.write_bytes(data.draw(damaged((home / whole).read_bytes())))
    survive(lambda: read(path))


@cache
def values(path: Path) -> Json:
    """What a file says; JSON is YAML too."""
    return parse_yaml(path.read_text(), path.name)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["manifest", "sidecar", "configuration", "claims", "questions"])
@fuzz
@given(data=st.data())
def test_wrong_values_load_or_give_one_clear_error(
    kind: str, data: st.DataObject, home: Path, damaged_folder: Path
) -> None:
    whole, name, read = KINDS[kind]
    path = damaged_folder / name
    path.write_text(json.dumps(data.draw(st.composite(mistake)(values(home / whole)))))
    survive(lambda: read(path))


@pytest.mark.slow
@fuzz
@given(data=st.data())
def test_sealed_records_load_or_give_one_clear_error(
    data: st.DataObject, home: Path, damaged_folder: Path
) -> None:
    path = damaged_folder / "sealed.parquet"
    path.write_bytes((home / "a.parquet").read_bytes())

    def change(metadata: Json, _: Json) -> None:
        new = data.draw(st.composite(mistake)(dict(metadata)))
        metadata.clear()
        metadata.update(new if isinstance(new, dict) else {"x": new})

    forge_record(path, change)
    survive(lambda: read_record(path))
    with patch_budget():
        checked = list(Verification([path]).check())
    assert all(str(finding) for each in checked for finding in each.findings)


@pytest.mark.slow
@fuzz
@given(data=st.data())
def test_sealed_checkpoints_load_or_give_one_clear_error(
    data: st.DataObject, home: Path, damaged_folder: Path
) -> None:
    path = damaged_folder / "sealed.npz"
    path.write_bytes((home / "a.npz").read_bytes())

    def change(arrays: Arrays) -> None:
        name = data.draw(st.sampled_from(sorted(arrays)))
        if name == "meta":
            meta = data.draw(st.composite(mistake)(json.loads(arrays[name].tobytes())))
            arrays[name] = np.frombuffer(json.dumps(meta).encode(), dtype=np.uint8)
            return
        new = np.resize(arrays[name], data.draw(st.integers(0, len(arrays[name]) + 1)))
        field = data.draw(st.sampled_from(new.dtype.names or [...]))
        value = np.array(data.draw(st.sampled_from([-1, 0, 1, 2**62, float("nan")])))
        with np.errstate(invalid="ignore"):  # NaN as an integer is any value
            new[field][:1] = value.astype(new[field].dtype)
        arrays[name] = new

    forge_checkpoint(path, change)
    survive(lambda: checkpoint.read_checkpoint(path, run_spec()))


KEYS = st.lists(
    st.sampled_from(["neat", "elitism", "tasks", "cartpole", "gym:x:y", "", "budget", "name"])
)


YAML = st.lists(st.sampled_from(TOKENS), max_size=3).map(
    lambda tokens: b"".join(tokens).decode(errors="replace")
)


@fuzz
@given(keys=KEYS, value=st.one_of(st.text(), HOSTILE.map(str), YAML))
def test_overrides_are_taken_or_give_one_clear_error(keys: list[str], value: str) -> None:
    survive(lambda: load_configuration("smoke", [f"{'.'.join(keys)}={value}"]))


@fuzz
@given(budget=HOSTILE)
def test_a_budget_is_a_name_or_gives_one_clear_error(budget: Any) -> None:
    """It may be a notebook's parameter, of any type that papermill made."""
    survive(lambda: load_configuration(budget))


@fuzz
@given(name=HOSTILE)
def test_a_folder_is_a_name_or_gives_one_clear_error(name: Any) -> None:
    survive(lambda: folder(name))


@pytest.mark.slow
@fuzz
@given(
    values=st.dictionaries(st.sampled_from(["budget", "results", "output"]), HOSTILE | st.text())
)
def test_a_notebooks_parameters_are_literals(values: dict[str, Any]) -> None:
    """What papermill writes into the notebook assigns constants and calls nothing of theirs."""
    for statement in ast.parse(papermill.translators.PythonTranslator.codify(values)).body:
        assert isinstance(statement, ast.Assign)
        text = ast.unparse(statement.value)
        if text not in ("float('nan')", "float('inf')", "float('-inf')"):
            ast.literal_eval(text)


def test_a_record_that_unpacks_to_much_is_refused_before_that(tmp_path: Path) -> None:
    rows = 1_000_000  # 112 megabytes of zeros in some tens of kilobytes
    zeros = {f.name: np.zeros(rows, dtype=f.type.to_pandas_dtype()) for f in SCHEMA}
    table = pa.table(zeros, schema=SCHEMA).replace_schema_metadata({"neol": "{}"})
    path = tmp_path / "a.parquet"
    pq.write_table(table, path, compression="zstd", use_dictionary=False)
    assert path.stat().st_size < rows
    with pytest.raises(UserError, match="it would unpack to far more than its own"):
        read_record(path)
