"""The examples of docs/python.md, in the order of the page."""

import doctest

from conftest import ROOT


def test_the_page(monkeypatch):
    monkeypatch.chdir(ROOT)
    text = (ROOT / "docs" / "python.md").read_text()
    lines = ["" if line.startswith("```") else line for line in text.splitlines()]
    flags = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE | doctest.DONT_ACCEPT_BLANKLINE
    test = doctest.DocTestParser().get_doctest("\n".join(lines) + "\n", {}, "python.md", "docs/python.md", 0)
    told = []
    result = doctest.DocTestRunner(optionflags=flags).run(test, out=told.append)
    assert result.attempted > 10 and result.failed == 0, "".join(told)
