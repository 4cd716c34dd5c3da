"""What a notebook shows: verdict, chart and table, with every text escaped."""

import html.parser

from conftest import small

import fishplate

EVIL = "<script>alert(1)</script>\"'&"


class Tags(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.seen = []
        self.attributes = []

    def handle_starttag(self, tag, attrs):
        self.seen.append(tag)
        self.attributes += attrs


def tags(text):
    parser = Tags()
    parser.feed(text)
    assert not any(name.startswith("on") for name, _ in parser.attributes)
    return parser.seen


def test_verdict_chart_and_table(coach):
    shown = fishplate.certify(coach)._repr_html_()
    assert "✗ not validated" in shown and "data:image/svg+xml," in shown and "<td>YQ_qst</td>" in shown
    assert set(tags(shown)) <= {"p", "ul", "li", "img", "table", "thead", "tbody", "tr", "th", "td"}


def test_every_text_is_escaped():
    parts = small(description={"name": EVIL})
    parts["measurement"]["S01"] = {"time [s]": [0.0, 1.0], EVIL: [0.0, 1.0]}
    result = fishplate.certify(fishplate.Campaign(**parts))
    for shown in (result._repr_html_(), result.sections._repr_html_(), result.values._repr_html_()):
        assert "script" not in tags(shown) and "<script" not in shown
    table = fishplate.Campaign  # the class of the library has no view of its own
    assert not hasattr(table, "_repr_html_")


def test_a_long_table_is_shortened(coach):
    shown = fishplate.certify(coach).values._repr_html_()
    assert shown.count("<tr>") == 21 and "left out" in shown
