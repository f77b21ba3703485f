from pages.docstrings import Field, fields, intro, returned


def documented():
    """First line, with
    a second.

    A paragraph with ``code``.

    Parameters
    ----------
    one : float
        Of this, over
        two lines [m].
    low, high : float
        Bounds.
    silent : bool

    Returns
    -------
    dict
        ``a`` [m]; ``b``
        in words. Also ``c``.

    Raises
    ------
    ConfigError
        Never.
    """


def plain():
    """Only a line."""


def test_fields():
    both = Field(("low", "high"), "Bounds.")
    assert fields(documented) == {
        "one": Field(("one",), "Of this, over two lines [m]."),
        "low": both,
        "high": both,
        "silent": Field(("silent",), ""),
    }
    assert fields(plain) == {}


def test_intro_and_returned():
    assert intro(documented) == "First line, with a second.\n\nA paragraph with `code`."
    assert intro(plain) == "Only a line."
    assert returned(documented) == ["`a` [m]", "`b` in words", "Also `c`"]
