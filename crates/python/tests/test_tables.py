"""Tables from any library, and back."""

import pandas
import polars
import pyarrow
import pytest

import maveric
from maveric._arrow import columns_of

PLAIN = {"id": ["a", "b", None, "a word that is longer than twelve letters"], "n": [1, 2, 3, None], "x": [1.5, None, -2.0, 0.25]}


@pytest.mark.parametrize(
    "frame",
    [
        polars.DataFrame(PLAIN),
        polars.DataFrame(PLAIN).with_columns(polars.col("id").cast(polars.Categorical), polars.col("n").cast(polars.Int16)),
        pandas.DataFrame(PLAIN).astype({"n": "Int32"}),
        pyarrow.table(PLAIN),
        pyarrow.concat_tables([pyarrow.table(PLAIN)[:1], pyarrow.table(PLAIN)[1:]]),
        pyarrow.table({**PLAIN, "id": pyarrow.array(PLAIN["id"]).dictionary_encode()}),
        pyarrow.table(pyarrow.table({k: [v[0], *v] for k, v in PLAIN.items()}))[1:],
    ],
    ids=["polars", "polars categories", "pandas", "pyarrow", "chunks", "dictionary", "slice"],
)
def test_every_library_gives_the_same_columns(frame):
    assert dict(columns_of(frame)) == PLAIN


def test_flags_are_words_and_other_types_are_refused_by_name():
    assert columns_of(polars.DataFrame({"a": [True, None, False]})) == [("a", ["true", None, "false"])]
    assert columns_of({"a": [True, False]}) == [("a", ["true", "false"])]
    with pytest.raises(maveric.Error, match="column `when`"):
        columns_of(polars.DataFrame({"when": ["2024-01-01"]}).with_columns(polars.col("when").str.to_date()))
    with pytest.raises(maveric.Error, match="column `a` holds int, str"):
        columns_of({"a": [1, "x"]})
    with pytest.raises(maveric.Error, match="int is no table"):
        columns_of(3)


def test_a_drives_signals_go_to_every_library_and_outlive_the_drive():
    signals = maveric.simulate(lambda scene: (27.0, 40.0, "stay"), duration_s=20, name="P1").drive.signals
    frames = [polars.DataFrame(signals), pyarrow.table(signals).to_pandas(), pyarrow.table(signals)]
    for frame in frames:
        assert len(frame) == len(signals) == 400
        assert list(frame["time_s"])[1] == pytest.approx(0.05) if not isinstance(frame, pyarrow.Table) else True
    rows = signals.to_dict()
    assert polars.DataFrame(signals).to_dict(as_series=False) == rows
    assert rows["lane_change"][0] is False
    assert polars.DataFrame(signals).schema["following"] == polars.Boolean
    assert polars.DataFrame(signals).schema["lane"] == polars.Int64


def test_nothing_of_a_table_is_held_when_its_readers_are_gone():
    import gc

    from maveric import _arrow

    gc.collect()
    before = len(_arrow._HELD)
    table = maveric.Table([("x", "g", 2, [b"", b"\0" * 16])])
    for _ in range(50):
        polars.DataFrame(table), pyarrow.table(table), table.to_dict()
        table.__arrow_c_stream__()  # that nobody reads
    gc.collect()
    assert len(_arrow._HELD) == before
