import csv
import io
import itertools
import math

import numpy as np
import pytest

from ship_gym.config import ConfigError
from ship_gym.csv_file import read_csv

HEADER = "# title: t\n# source: s\n# obtained: o\n# conventions: c\n"


def test_read_csv(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(HEADER + "J [-],beta [deg],grid\n0.5,90,G1\n0.6,180,G2\n")
    table = read_csv(path)
    assert table.header["source"] == "s"
    np.testing.assert_allclose(table.si("beta"), [math.pi / 2, math.pi])
    assert table.where(grid="G2").columns["J"].tolist() == [0.6]
    assert table.rows.tolist() == [6, 7]
    with pytest.raises(ConfigError, match=r"no column 'bta'; did you mean 'beta'"):
        table.require("bta")


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("J [-]\n0.5\n", "# title"),
        (HEADER.replace("# source: s\n", "") + "J [-]\n0.5\n", "# source"),
        (HEADER + "J [-]\n", "at least one row"),
        (HEADER + "J [-],b [-]\n0.5\n", ":6: 1 cells, but 2 columns"),
        (HEADER + "J [-]\nhalf\n", ":6: J = 'half'"),
        (HEADER + "J [-]\nnan\n", ":6: J = nan"),
        (HEADER + "J,b\n0.5,1\n", "unit in brackets"),
    ],
)
def test_read_csv_refuses(tmp_path, text, word):
    path = tmp_path / "a.csv"
    path.write_text(text)
    with pytest.raises(ConfigError) as error:
        read_csv(path)
    assert word in str(error.value)


# --- any form in which a spreadsheet or an editor writes the same table ---------------------------

TITLES = ["point [-]", "J [-]", "beta [deg]", "grid", "K_T [-]", "C_Fx [-]"]
DATA = [
    ["1", "0.462", "39.38", "G1", "0.321", "-0.259"],
    ["2", "0.288", "28.12", "grob, für A", "3.84e-1", "-2.24E-01"],
    ["3", "1", "5", "", "0", "+0.5"],
]
REMARKS = ["# title: Müller, Köln", "# source: s; p. 3", "# obtained: o", "# conventions: c"]
ENCODINGS = {
    "utf-8": lambda text: text.encode(),
    "utf-8 mark": lambda text: text.encode("utf-8-sig"),
    "utf-16-le": lambda text: ("\ufeff" + text).encode("utf-16-le"),
    "utf-16-be": lambda text: ("\ufeff" + text).encode("utf-16-be"),
    "cp1252": lambda text: text.encode("cp1252"),
}
# separator and decimal mark; decimal commas between commas need quotes
MARKS = [(",", "."), (";", "."), (";", ","), ("\t", "."), ("\t", ",")]
ENDS = ["\n", "\r\n", "\r"]
SHAPES = ["plain", "last column empty", "blank lines", "empty rows", "remarks filled up", "sep="]


def written(separator, decimal, end, shape, quoting):
    """The table as a text."""
    rows = [[cell.replace(".", decimal) if i != 3 else cell for i, cell in enumerate(row)]
            for row in DATA]  # fmt: skip
    remarks, titles = REMARKS, TITLES
    if shape == "last column empty":
        titles, rows = [*titles, ""], [[*row, ""] for row in rows]
    if shape == "empty rows":
        rows = [rows[0], [""] * 6, *rows[1:], [""] * 6]
    stream = io.StringIO()
    writer = csv.writer(stream, delimiter=separator, lineterminator=end, quoting=quoting)
    if shape == "remarks filled up":  # as Excel does
        writer.writerows([remark, *[""] * 5] for remark in remarks)
    else:
        stream.write(end.join([*remarks, ""]))
    writer.writerows([titles, *rows])
    text = stream.getvalue()
    if shape == "blank lines":
        text = text.replace(end, end + "  " + end)
    return f"sep={separator}{end}{text}" if shape == "sep=" else text


@pytest.fixture
def plain(tmp_path):
    path = tmp_path / "plain.csv"
    text = written(",", ".", "\n", "plain", csv.QUOTE_MINIMAL)
    path.write_text(text, encoding="utf-8")
    return read_csv(path)


def assert_same(table, plain):
    assert list(table.columns) == list(plain.columns) and table.units == plain.units
    for name, values in plain.columns.items():
        assert table.columns[name].dtype == values.dtype
        np.testing.assert_array_equal(table.columns[name], values)
    assert table.header == plain.header


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_every_form_gives_the_values_of_the_plain_file(tmp_path, plain, encoding, shape):
    path = tmp_path / "a.csv"
    forms = itertools.product(MARKS, ENDS, (csv.QUOTE_MINIMAL, csv.QUOTE_ALL))
    quoted = [((",", ","), end, csv.QUOTE_ALL) for end in ENDS]
    for (separator, decimal), end, quoting in (*forms, *quoted):
        text = written(separator, decimal, end, shape, quoting)
        path.write_bytes(ENCODINGS[encoding](text))
        assert_same(read_csv(path), plain)


def test_the_plain_table_has_the_values_of_its_text(plain):
    assert plain.columns["J"].tolist() == [0.462, 0.288, 1.0]
    assert plain.columns["C_Fx"].tolist() == [-0.259, -0.224, 0.5]
    assert plain.columns["grid"].tolist() == ["G1", "grob, für A", ""]
    assert plain.header["title"] == "Müller, Köln" and plain.rows.tolist() == [6, 7, 8]
    assert plain.title_row == 5


def test_an_export_of_a_german_excel(tmp_path, plain):
    """Word for word: semicolons, decimal commas, cp1252, quotes, filled-up remarks, CRLF."""
    path = tmp_path / "excel.csv"
    path.write_bytes(
        b"# title: M\xfcller, K\xf6ln;;;;;\r\n"
        b'"# source: s; p. 3";;;;;\r\n'
        b"# obtained: o;;;;;\r\n"
        b"# conventions: c;;;;;\r\n"
        b"point [-];J [-];beta [deg];grid;K_T [-];C_Fx [-]\r\n"
        b"1;0,462;39,38;G1;0,321;-0,259\r\n"
        b"2;0,288;28,12;grob, f\xfcr A;3,84E-01;-2,24E-01\r\n"
        b"3;1;5;;0;0,5\r\n"
    )
    table = read_csv(path)
    assert_same(table, plain)
    assert table.decimal == ","


def test_names_broken_in_a_cell_empty_columns_and_a_typographic_minus(tmp_path):
    path = tmp_path / "a.csv"
    text = HEADER + '"J\n[-]";;"beta[deg]"\n0,5;;\N{MINUS SIGN}1,5\n"0,6";;2\n'
    path.write_text(text, encoding="utf-8")
    table = read_csv(path)
    assert table.columns["J"].tolist() == [0.5, 0.6]
    assert table.columns["beta"].tolist() == [-1.5, 2.0] and table.units["beta"] == "deg"
    assert table.rows.tolist() == [7, 8]


def test_numbers_of_the_header_are_written_as_those_of_the_columns(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(HEADER + "# delta_deg: 35,5;;\nJ [-];b [-]\n0,5;1\n")
    assert read_csv(path).number("delta_deg") == 35.5
    path.write_text(HEADER + "# delta_deg: 35,5\nJ [-],b [-]\n0.5,1\n")
    with pytest.raises(ConfigError, match="# delta_deg: '35,5' is not a number"):
        read_csv(path).number("delta_deg")


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        # decimal commas between commas
        (
            "J [-],b [-]\n0,5,1,2\n",
            ":6: 4 cells, but 2 columns; if these are decimal commas, p",
        ),
        ("J [-],b [-],\n0,5,1,2,\n", ":6: 4 cells, but 2 columns; if these are decimal commas"),
        ("J [-],g\n0,5,\n0.5,\n", ":6: 3 cells, but 2 columns; if these are decimal commas"),
        ('J [-],b [-]\n"1,234",1\n', ":6: J = '1,234': a thousands separator or .* 1234 or 1.234"),
        ("J [-];b [-]\n0,5;1.2\n", ":6: J = '0,5', but '1.2' in line 6: allowed is one decimal"),
        ("J [-];b [-]\n1.234,5;1\n", ":6: J = '1.234,5', but .* no thousands separator"),
        ("J [-];b [-]\n1,234,5;1\n", ":6: J = '1,234,5' is not a number"),
        ("J [-];b [-]\n1 234,5;1\n", ":6: J = '1 234,5' is not a number"),
        ("J [-];b [-]\n1_0;1\n", ":6: J = '1_0' is not a number"),
        ("J [-];b [-]\n0,5\n", ":6: 1 cells, but 2 columns"),
        ("J [-];;b [-]\n0,5;7;1\n", ":6: '7' is in column 2, which has no name"),
        ("J [-];b [-]\n0,5;1;3\n", ":6: 3 cells, but 2 columns"),
        ("J [-];b [-]\n0,5;;\n", ":6: b = '' is not a number"),
        ('J [-];b [-]\n"0,5;1\n', ":6: quotes that do not enclose a cell"),
        ('J [-];b [-]\n"0,5"5;1\n', ":6: quotes that do not enclose a cell"),
        (";;\n;;\n", "needs a row of column names"),
        ("", "needs a row of column names"),
    ],
)
def test_what_is_not_clear_is_refused_in_one_line(tmp_path, rows, words):
    path = tmp_path / "a.csv"
    path.write_text(HEADER + rows)
    with pytest.raises(ConfigError, match=f"a.csv.*{words}") as error:
        read_csv(path)
    assert "\n" not in str(error.value)


def test_a_workbook_and_an_empty_file(tmp_path):
    path = tmp_path / "a.csv"
    path.write_bytes(b"PK\x03\x04\x14\x00")
    with pytest.raises(ConfigError, match="a workbook, not a text file; save the sheet as"):
        read_csv(path)
    path.write_bytes(b"")
    with pytest.raises(ConfigError, match="no line '# title"):
        read_csv(path)
