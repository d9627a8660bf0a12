"""YAML from untrusted files: plain values in a bounded amount."""

from pathlib import Path

import pytest

from neol.base.errors import UserError
from neol.spec.plain_yaml import MAX_BYTES, parse_yaml, read_yaml


def test_words_and_numbers() -> None:
    content = parse_yaml("[off, no, 1e-3, -2., 010, 0o10, ~, 'true', 0x1f, +5, 1:30]", "test")
    assert content == ["off", "no", 0.001, -2.0, 10, 8, None, "true", 31, 5, "1:30"]
    assert [type(value) for value in content[2:6]] == [float, float, int, int]


def test_aliases_stand_for_what_they_name() -> None:
    assert parse_yaml("{a: &a [1, 2], b: *a}", "test") == {"a": [1, 2], "b": [1, 2]}


LAUGHS = "\n".join(
    [
        "a: &a [lol]",
        *(
            f"{b}: &{b} [{', '.join([f'*{a}'] * 9)}]"
            for a, b in zip("abcdefgh", "bcdefghi", strict=True)
        ),
    ]
)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (LAUGHS, "test, line 1: more than 32768 values"),
        ("&a [*a]", "test, line 1: more than 32768 values"),
        pytest.param("[" * 2000 + "]" * 2000, "test: nested too deeply", marks=pytest.mark.slow),
        ("9" * 5000, "test: not a value of its kind"),
        ("!!int one", "test: not a value of its kind"),
        ("!!bool one", "test: not a value of its kind"),
        ('!!int ""', "test: not a value of its kind"),
        ("!!int _", "test: not a value of its kind"),
        ('!!float ""', "test: not a value of its kind"),
        ("!!float _", "test: not a value of its kind"),
        ('"\\UFFFFFFFF"', "test: not a value of its kind"),
        ('"\\uD800"', "test, line 1: not a character of Unicode"),
        ("{a: 2001-01-01}", "test, line 1: tag:yaml.org,2002:timestamp is not a plain value"),
        ("!!binary YQ==", "binary is not a plain value"),
        ("{<<: {a: 1}}", "merge is not a plain value"),
        ("!!python/object/apply:os.system [id]", "os.system is not a plain value"),
        ("!!python/name:os.system", "os.system is not a plain value"),
        ("{b: 1,\n a: 1,\n a: 2}", 'test, line 3: found duplicate key "a"'),
        ("{[1]: 2}", "a key is not a plain value"),
        ("a: \0", "test: unacceptable character"),
    ],
)
def test_what_is_not_plain_is_refused_in_one_line(text: str, reason: str) -> None:
    with pytest.raises(UserError) as refused:
        parse_yaml(text, "test")
    assert reason in str(refused.value)
    assert "\n" not in str(refused.value)


def test_files_are_bounded_text(tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    for content in (b"\xff", b" " * (MAX_BYTES + 1)):
        path.write_bytes(content)
        with pytest.raises(UserError, match=r"a\.yaml"):
            read_yaml(path, "a.yaml")
