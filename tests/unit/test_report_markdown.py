"""Markdown from hostile texts: read by another program, it must give the text back and nothing else."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from markdown_it import MarkdownIt
from markdown_it.token import Token

from truing.formulas.symbols import printable
from truing.report.markdown_printer import escaped

HOSTILE = [
    "<script>alert(1)</script>",
    "{{7*7}} {% raw %}",
    "$x$ and $$y$$",
    "a | b",
    "# heading",
    "`code` ``more``",
    "[text](https://evil.example) ![picture](x.png)",
    "[text][1] [1]: https://evil.example",
    "<https://evil.example> https://evil.example www.evil.example",
    "**bold** __bold__ *i* _i_ ~~struck~~",
    "- item",
    "+ item",
    "1. item",
    "12) item",
    "> quoted",
    "=====",
    "---",
    "***",
    "    indented",
    "one\n\ntwo\n# three",
    "\\* \\| \\",
    "&lt;b&gt; &amp; &#36;",
    "trailing backslash \\",
    "```\nfence\n```",
    "~~~",
    "| a |\n| --- |",
    "a\u202eb\x00c\x1b[31m",
]
ONLY = {"inline", "text", "text_special", "paragraph_open", "paragraph_close"}


def read(markdown: str) -> list[Token]:
    return MarkdownIt("commonmark", {"linkify": False}).enable(["table", "strikethrough"]).parse(markdown)


def words(tokens: list[Token]) -> str:
    return "".join(child.content for token in tokens for child in token.children or [])


@pytest.mark.parametrize("text", HOSTILE)
def test_a_hostile_text_is_read_back_as_itself(text: str) -> None:
    tokens = read(escaped(text))
    kinds = {token.type for token in tokens} | {child.type for token in tokens for child in token.children or []}
    assert kinds <= ONLY
    assert words(tokens) == printable(text)


@given(st.text())
def test_any_text_is_read_back_as_itself(text: str) -> None:
    tokens = read(escaped(text))
    kinds = {token.type for token in tokens} | {child.type for token in tokens for child in token.children or []}
    assert kinds <= ONLY
    assert words(tokens) == printable(text)


@pytest.mark.parametrize("text", HOSTILE)
def test_a_hostile_text_stays_in_its_cell(text: str) -> None:
    tokens = read(f"| head | next |\n| --- | --- |\n| {escaped(text)} | end |")
    cells = [tokens[place + 1] for place, token in enumerate(tokens) if token.type == "td_open"]
    assert [words([cell]) for cell in cells] == [printable(text), "end"]


@pytest.mark.parametrize("mark", ["<", ">", "$", "|", "{", "}", "https://", "mailto:", "www."])
def test_marks_that_other_readers_obey_do_not_stand_in_the_source(mark: str) -> None:
    assert mark not in escaped(f"a {mark} b {mark}c")
