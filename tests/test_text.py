"""Tables for people, plain and in Markdown."""

import pytest

from ship_gym.text import signed_interval, table


def test_plain_columns_are_aligned():
    assert table(["a", "b"], [["x", "10"], ["long", "9"]]) == "a      b\nx     10\nlong   9"
    assert table(["a", "b"], [["x", "10"], ["long", "9"]], None) == "a     b\nx     10\nlong  9"
    assert table(["a", "b"], []) == "a  b"


def test_markdown_escapes_bars():
    found = table(("A", "B"), [["a|b", "c"]], markdown=True)
    assert found == "| A | B |\n| --- | --- |\n| a\\|b | c |"
    for rows in ([], [["only one"]]):
        with pytest.raises(ValueError, match="2 cells"):
            table(("A", "B"), rows, markdown=True)


def test_ragged_rows_are_refused():
    with pytest.raises(ValueError, match="2 cells"):
        table(("A", "B"), [["only one"]])


def test_a_difference_tells_its_sign():
    assert signed_interval(0.01234, -0.5, 2000.0) == "+0.0123 [-0.5, +2e+03]"
