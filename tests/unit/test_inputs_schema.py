"""The JSON Schema by which editors complete an inputs file."""

from __future__ import annotations

import json

from jsonschema import Draft202012Validator
from sample_models import PIN_OFFER, STAGE_OFFER

from truing.inputs_file import json_schema


def test_the_schema_is_valid_and_says_what_editors_need() -> None:
    schema = json_schema(STAGE_OFFER)
    Draft202012Validator.check_schema(schema)
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    inputs = schema["$defs"]["Inputs"]
    assert inputs["required"] == ["surface"]
    assert inputs["properties"]["bore_sun"]["default"] == "30 mm"
    assert inputs["properties"]["bore_sun"]["description"] == "d_1: bore; above 0 mm"
    assert inputs["properties"]["reading"]["enum"] == ["printed", "complete"]
    assert inputs["properties"]["teeth_sun"]["minimum"] == 5
    assert inputs["properties"]["face_factor"]["description"] == "K_H: face load factor; at least 1; optional"
    validator = Draft202012Validator(schema)
    right = {"inputs": {"surface": {"file": "a"}, "teeth_sun": 7, "reading": "printed", "bore_sun": "3 mm"}}
    assert list(validator.iter_errors(right)) == []
    wrong = {"inputs": {"surface": 3, "teeth_sun": 4, "reading": "x", "bore_sun": 3, "planest": 3}, "nonsense": {}}
    assert len(list(validator.iter_errors(wrong))) == 6


def test_the_schema_of_studies_and_effects() -> None:
    schema = json_schema(PIN_OFFER)
    Draft202012Validator.check_schema(schema)
    json.dumps(schema, allow_nan=False)
    census = schema["$defs"]["Studies"]["properties"]["census"]["properties"]
    assert census["draws"] == {"type": "integer", "default": 1000}
    assert census["method"]["enum"] == ["plain", "quasi"]
    assert schema["$defs"]["Effect_running_in"]["required"] == ["extra", "length"]
    assert schema["$defs"]["Tolerances"]["properties"]["hardness"]["default"] == "lognormal sd 6 %"
