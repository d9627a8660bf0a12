"""Files and words from strangers: each loads or gives one clear line, and none is executed.

`NEOL_FUZZ=5000 pytest tests/test_untrusted.py` tries so many damaged inputs of each kind.
"""

import ast
import io
import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import papermill.translators
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from neol import checkpoint, spec
from neol.analysis.claims import CLAIMS, load_claims
from neol.checkpoint import Cost
from neol.columns import SCHEMA
from neol.errors import UserError
from neol.files import folder
from neol.plain_yaml import parse_yaml
from neol.records import read_record, read_spec
from neol.spec import CONFIG, ROOT, load_configuration
from neol.trace import trace
from neol.verification import manifest
from neol.verification.check import Verification
from tests.test_checkpoint import started
from tests.test_evolution import run_spec
from tests.test_records import forge
from tests.verification.planted_errors import OJA, make_campaign, patch_budget

EXAMPLES = int(os.environ.get("NEOL_FUZZ", "60"))
fuzz = settings(max_examples=EXAMPLES, deadline=None, suppress_health_check=list(HealthCheck))

Json = Any
Read = Callable[[Path], object]

HOSTILE = st.one_of(
    st.sampled_from([None, True, -1, 0, 1.5, 1e308, 10**18, 10**30, float("nan"), float("inf")]),
    st.sampled_from(
        ["", "x", "\0", "é\n", "../x", "__import__('os')", "=1+1", [], [[]], {}, {"": 0}]
    ),
    st.text(max_size=5),
)
TOKENS = [
    b"[" * 3000,
    b"{" * 3000,
    b"9" * 5000,
    b"&a ",
    b"*a",
    b"!!python/name:os.system ",
    b"\0",
    b"\xff",
]
TOKENS += [
    b'"',
    b"\n",
    b": ",
    b"- ",
    b"<<: ",
    b"NaN",
    b"-0",
    b"1e999",
    b"null",
    b"\x80\x04.",
    b"PAR1",
    b"PK\x05\x06",
]


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
    checkpoint.save(folder / "a.npz", started(run_spec(), 2), Cost())
    (folder / "a.json").write_text(json.dumps(SIDECAR))
    (folder / "manifest.json").write_bytes((folder / "smoke" / "manifest.json").read_bytes())
    (folder / "a.yaml").write_bytes((CONFIG / "smoke.yaml").read_bytes())
    (folder / "claims.yaml").write_bytes(CLAIMS.read_bytes())
    return folder


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
    "record's footer": ("a.parquet", "x.parquet", read_spec),
    "checkpoint": ("a.npz", "x.npz", lambda path: checkpoint.load(path, run_spec())),
    "manifest": (
        "manifest.json",
        "manifest.json",
        lambda path: manifest.read_manifest(path.parent),
    ),
    "sidecar": ("a.json", "table3.json", read_trace),
    "configuration": ("a.yaml", "x.yaml", read_configuration),
    "claims": ("claims.yaml", "claims.yaml", load_claims),
}


def survive(read: Callable[[], object]) -> None:
    """It loads, or says in one line why not."""
    try:
        read()
    except UserError as error:
        assert str(error)
        assert "\n" not in str(error)


@st.composite
def damaged(draw: st.DrawFn, content: bytes) -> bytes:
    """A file with some bytes changed, lost, doubled or put in."""
    for _ in range(draw(st.integers(1, 3))):
        begin = draw(st.integers(0, len(content)))
        end = min(len(content), begin + draw(st.sampled_from([0, 1, 4, 64, len(content)])))
        part = content[begin:end]
        new = draw(
            st.one_of(
                st.just(part * 2),
                st.just(
                    bytes(byte ^ (1 << draw(st.integers(0, 7))) for byte in part[:1]) + part[1:]
                ),
                st.sampled_from([b"", *TOKENS]),
                st.binary(max_size=8),
            )
        )
        content = content[:begin] + new + content[end:]
    return content


def mistake(draw: st.DrawFn, content: Json) -> Json:
    """JSON with a value somewhere replaced, or a key removed, renamed or added."""
    if isinstance(content, dict) and content and draw(st.integers(0, 4)):
        key = draw(st.sampled_from(sorted(content)))
        return content | {key: mistake(draw, content[key])}
    if isinstance(content, list) and content and draw(st.integers(0, 4)):
        place = draw(st.integers(0, len(content) - 1))
        return [*content[:place], mistake(draw, content[place]), *content[place + 1 :]]
    if isinstance(content, dict) and content and draw(st.booleans()):
        key = draw(st.sampled_from(sorted(content)))
        return {k: v for k, v in content.items() if k != key} | draw(
            st.sampled_from([{}, {"x": 1}])
        )
    return draw(HOSTILE)


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


@pytest.mark.parametrize("kind", ["manifest", "sidecar", "configuration", "claims"])
@fuzz
@given(data=st.data())
def test_wrong_values_load_or_give_one_clear_error(
    kind: str, data: st.DataObject, home: Path, damaged_folder: Path
) -> None:
    whole, name, read = KINDS[kind]
    content = parse_yaml((home / whole).read_text(), kind)  # JSON is YAML too
    path = damaged_folder / name
    path.write_text(json.dumps(data.draw(st.composite(mistake)(content))))
    survive(lambda: read(path))


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

    forge(path, change)
    survive(lambda: read_record(path))
    with patch_budget():
        checked = list(Verification([path]).check())
    assert all(str(finding) for each in checked for finding in each.findings)


@fuzz
@given(data=st.data())
def test_sealed_checkpoints_load_or_give_one_clear_error(
    data: st.DataObject, home: Path, damaged_folder: Path
) -> None:
    with np.load(home / "a.npz") as file:
        arrays = {name: file[name] for name in file.files if name != "seal"}
    name = data.draw(st.sampled_from(sorted(arrays)))
    if name == "meta":
        meta = data.draw(st.composite(mistake)(json.loads(arrays[name].tobytes())))
        arrays[name] = np.frombuffer(json.dumps(meta).encode(), dtype=np.uint8)
    else:
        old = arrays.pop(name)
        values = [-1, 0, 1, 2**62, float("nan")]
        new = data.draw(
            st.lists(st.sampled_from([*old.tolist()[:3], *values]), max_size=len(old) + 1)
        )
        arrays[name] = np.array(new).astype(
            data.draw(st.sampled_from(["i8", "f8", "?", "u1", "U3"]))
        )
    buffer = io.BytesIO()
    np.savez(buffer, **arrays, seal=checkpoint._seal(arrays))
    path = damaged_folder / "sealed.npz"
    path.write_bytes(buffer.getvalue())
    survive(lambda: checkpoint.load(path, run_spec()))


KEYS = st.lists(
    st.sampled_from(["neat", "elitism", "tasks", "cartpole", "gym:x:y", "", "budget", "name"])
)


@fuzz
@given(keys=KEYS, value=st.one_of(st.text(), HOSTILE.map(str), st.sampled_from(TOKENS).map(repr)))
def test_overrides_are_taken_or_give_one_clear_error(keys: list[str], value: str) -> None:
    survive(lambda: load_configuration("smoke", [f"{'.'.join(keys)}={value}"]))


@fuzz
@given(budget=HOSTILE)
def test_a_budget_is_a_name_or_gives_one_clear_error(budget: Any) -> None:
    """It may be a notebook's parameter, of whatever type papermill made it."""
    survive(lambda: load_configuration(budget))


@fuzz
@given(name=HOSTILE)
def test_a_folder_is_a_name_or_gives_one_clear_error(name: Any) -> None:
    survive(lambda: folder(name))


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
    with pytest.raises(UserError, match="it would unpack to far more than it is"):
        read_record(path)


# --- What the code never does -------------------------------------------------------------------

FORBIDDEN_MODULES = {"pickle", "cPickle", "marshal", "shelve", "dill", "cloudpickle", "joblib"}
FORBIDDEN_CALLS = {
    "eval",
    "exec",
    "compile",
    "__import__",
    "read_pickle",
    "unsafe_load",
    "full_load",
}


def dangers(source: str) -> list[str]:
    """Calls and imports that could run what a file holds."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import | ast.ImportFrom):
            names = [alias.name for alias in node.names] + [getattr(node, "module", None) or ""]
            found += [name for name in names if name.split(".")[0] in FORBIDDEN_MODULES]
        if not isinstance(node, ast.Call):
            continue
        owner = node.func.value if isinstance(node.func, ast.Attribute) else None
        name = node.func.attr if isinstance(node.func, ast.Attribute) else ast.unparse(node.func)
        call = ast.unparse(node)
        wrong = (
            (name in FORBIDDEN_CALLS and ast.unparse(node.func) != "re.compile")
            or (
                name == "load"
                and ast.unparse(owner or node.func) == "yaml"
                and "_Loader" not in call
            )
            or (
                name == "load"
                and "np" in ast.unparse(node.func)
                and "allow_pickle=False" not in call
            )
            or "shell=True" in call
        )
        found += [call] * wrong
    return found


def test_dangers_are_seen() -> None:
    for source in (
        "import pickle",
        "from joblib import load",
        "eval(x)",
        "builtins.exec(x)",
        "pd.read_pickle(x)",
        "yaml.load(x, Loader=yaml.Loader)",
        "np.load(x)",
        "np.load(x, allow_pickle=True)",
        "subprocess.run(x, shell=True)",
    ):
        assert len(dangers(source)) == 1, source
    assert (
        dangers("re.compile(x); yaml.load(x, Loader=_Loader); np.load(x, allow_pickle=False)") == []
    )


@pytest.mark.parametrize("path", sorted((ROOT / "neol").rglob("*.py")), ids=str)
def test_nothing_read_is_executed(path: Path) -> None:
    assert dangers(path.read_text(encoding="utf-8")) == []
