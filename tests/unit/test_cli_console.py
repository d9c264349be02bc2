"""What is printed: a terminal shows it and obeys none of it."""

import json

import pytest

from truing.cli.console import out, out_json, say

ORDERS = "\x1b[31mred\x1b[0m\x07 \x9b2J \u202egnp.exe\rover"
SHOWN = "?[31mred?[0m? ?2J ?gnp.exe?over"


@pytest.mark.parametrize("write", [out, say])
def test_a_terminal_is_given_no_orders(write, capsys):
    write(f"column '{ORDERS}'\nnext line\tµm")
    printed = "".join(capsys.readouterr())
    assert printed == f"column '{SHOWN}'\nnext line\tµm\n"


def test_a_document_reads_back_as_it_was(capsys):
    out_json({"name": ORDERS, "unit": "µm"})
    printed = capsys.readouterr().out
    assert json.loads(printed) == {"name": ORDERS, "unit": "µm"}
    assert not set(printed) & set("\x1b\x07\x9b\u202e\r")
