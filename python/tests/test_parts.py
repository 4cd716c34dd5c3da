"""Parts in any order and number: the same bytes as on one machine."""

import random

import pytest
from conftest import COACH

import fishplate


@pytest.mark.parametrize("shards", [1, 2, 5, 13, 40])
def test_parts_in_any_order(whole, shards, tmp_path):
    parts = [fishplate.reduce(COACH, shard=(number, shards)) for number in range(shards)]
    random.Random(shards).shuffle(parts)
    path = tmp_path / "values.parquet"
    path.write_bytes(parts[0])
    found = fishplate.judge([path, *parts[1:]])
    assert found.json() == whole.json() and found.figures == whole.figures


def test_parts_that_are_wrong():
    part = fishplate.reduce(COACH, shard=(0, 2))
    for wrong in ([], [b""], [part[:-1]], [part[:200] + bytes([part[200] ^ 1]) + part[201:]], [b"PAR1" * 100]):
        with pytest.raises(fishplate.Error) as caught:
            fishplate.judge(wrong)
        assert caught.value.code != "internal", caught.value
    other = fishplate.reduce(COACH, shard=(1, 2), sections_per_zone=4)
    with pytest.raises(fishplate.Error):
        fishplate.judge([part, other])
    with pytest.raises(fishplate.Error, match="shard"):
        fishplate.reduce(COACH, shard=(2, 2))
    missing = fishplate.judge([part])
    assert missing.verdict == "not assessable" and any("missing" in reason for reason in missing.reasons), missing.reasons
