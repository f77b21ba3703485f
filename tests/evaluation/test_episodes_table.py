import math

import pytest

from ship_gym.config import ConfigError

pa = pytest.importorskip("pyarrow")
parquet = pytest.importorskip("pyarrow.parquet")

from ship_gym.evaluation import all_metrics  # noqa: E402
from ship_gym.evaluation.episodes_table import (  # noqa: E402
    Results,
    read_results,
    schema,
    table_of,
    write_results,
)


def row(seed, **more):
    return {"suite": "s", "scenario": "c", "ship": "kcs", "controller": "pid", "seed": seed} | more


def test_columns_are_those_of_the_design():
    names = schema().names
    assert names[0] == "suite" and names[-1] == "decision_ms"
    assert set(all_metrics()) < set(names) and len(set(names)) == len(names)
    assert str(schema().field("seed").type) == "int64"
    assert str(schema().field("success").type) == "double"


def test_rows_are_sorted_and_what_is_no_number_is_null():
    rows = [row(3, value=1.0), row(1, value=math.nan), row(2, value=math.inf, controller="a")]
    found = table_of(rows).to_pylist()
    assert [(r["controller"], r["seed"]) for r in found] == [("a", 2), ("pid", 1), ("pid", 3)]
    assert [r["value"] for r in found] == [None, None, 1.0] and found[0]["error"] is None
    with pytest.raises(ConfigError, match="no column 'valve'"):
        table_of([row(1, valve=2.0)])


def test_a_file_gives_back_what_was_written(tmp_path):
    made = Results(table_of([row(1, value=1.0 / 3.0)]), {"seeds": [1], "command": "ship-gym ü"})
    write_results(tmp_path / "episodes.parquet", made)
    for path in (tmp_path, tmp_path / "episodes.parquet"):
        found = read_results(path)
        assert found.table.equals(made.table) and found.about == made.about
    assert [path.name for path in tmp_path.iterdir()] == ["episodes.parquet"]
    assert found.rows()[0]["value"] == 1.0 / 3.0


def test_other_files_are_refused(tmp_path):
    with pytest.raises(ConfigError, match=r"episodes\.parquet: no such file; .*ship-gym benchmark"):
        read_results(tmp_path)
    text = tmp_path / "a.parquet"
    text.write_text("a,b\n")
    with pytest.raises(ConfigError, match=r"a\.parquet: not a parquet file, or damaged"):
        read_results(text)
    parquet.write_table(pa.table({"a": [1]}), text)
    with pytest.raises(ConfigError, match="not of a benchmark"):
        read_results(text)
    made = Results(table_of([row(1)]), {})
    write_results(text, Results(made.table.drop_columns(["tier"]), {}))
    with pytest.raises(ConfigError, match="no column 'tier'"):
        read_results(text)
    k = made.table.column_names.index("seed")
    write_results(text, Results(made.table.set_column(k, "seed", pa.array([1.5])), {}))
    with pytest.raises(ConfigError, match="column 'seed' is of type double, must be int64"):
        read_results(text)


@pytest.mark.parametrize(
    ("about", "values", "words"),
    [
        (b"", {}, "not valid JSON"),
        (b"[1]", {}, "says of itself [1]: allowed is a mapping"),
        (b'{"a": 1e999}', {}, "is larger than any number"),
        (b"[" * 100_000, {}, "nested too deep"),
        (b"{}", {"value": float("nan")}, "column 'value' holds a number that is not finite"),
        (b"{}", {"ship": None}, "column 'ship' has a row without a value"),
    ],
)
def test_damaged_contents_are_one_line(tmp_path, about, values, words):
    file, table = tmp_path / "a.parquet", table_of([row(1)])
    for name, value in values.items():
        field = table.schema.field(name)
        column = pa.array([value], field.type)
        table = table.set_column(table.column_names.index(name), field, column)
    parquet.write_table(table.replace_schema_metadata({b"ship_gym": about}), file)
    with pytest.raises(ConfigError) as error:
        read_results(file)
    assert words in str(error.value) and str(file) in str(error.value)
