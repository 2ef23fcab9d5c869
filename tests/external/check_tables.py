"""Holds ingested drives against the tables they came from, read by Python's csv module alone.

    maveric ingest DATA/openacc_astazero  --mapping study_data/mappings/openacc.toml     --out OUT/openacc
    maveric ingest DATA/ngsim_i80_pairs   --mapping study_data/mappings/ngsim_pairs.toml --out OUT/ngsim_pairs
    maveric ingest DATA/ngsim_us101_i80   --mapping study_data/mappings/ngsim.toml       --out OUT/ngsim
    pip install pyarrow pandas duckdb polars
    python tests/external/check_tables.py DATA OUT

Every drive is opened by pandas, polars and DuckDB, which must agree; its values are compared row by row.
"""

import csv
import pathlib
import sys

import duckdb
import pandas
import polars
import pyarrow.parquet

DATA, OUT = (pathlib.Path(p) for p in sys.argv[1:3])
FOOT = 0.3048


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def drive(path):
    """The drive as pandas has it, after asking the others whether they see the same."""
    frame = pandas.read_parquet(path)
    other = polars.read_parquet(path)
    sums = duckdb.sql(f"select count(*), sum(ego_speed_mps), sum(lead_dx_m) from '{path}'").fetchall()[0]
    assert other.columns == list(frame.columns) and len(other) == len(frame) == sums[0]
    for column, total in (("ego_speed_mps", sums[1]), ("lead_dx_m", sums[2])):
        assert other[column].to_list() == frame[column].to_list()
        assert abs(total - frame[column].sum()) < 1e-6 * max(1, abs(total))
    pairs = pyarrow.parquet.read_metadata(path).metadata
    metadata = {key.decode(): value.decode() for key, value in pairs.items()}
    for key in ("version", "drive", "source", "source_blake3", "mapping", "mapping_blake3", "resampled_hz", "program"):
        assert metadata.get(f"maveric.{key}"), f"{path} lacks maveric.{key}"
    assert not frame[["time_s", "ego_x_m", "ego_speed_mps", "lead_dx_m"]].isna().any().any()
    return frame


def close(found, expected, what):
    assert abs(found - expected) < 1e-6, f"{what}: {found}, expected {expected}"


def pairs(folder, out, prefix, unit):
    count = rows = 0
    for path in sorted((DATA / folder).glob("*.csv")):
        if path.name == "manifest.csv":
            continue
        plain = rows_of(path)
        frame = drive(OUT / out / prefix(path.stem))
        assert len(frame) == len(plain), path
        for row, found in zip(plain, frame.itertuples()):
            close(found.ego_speed_mps, float(row["v_follower"]) * unit, path)
            close(found.lead_speed_mps, float(row["v_leader"]) * unit, path)
            close(found.lead_dx_m, max(0.0, float(row["spacing"]) * unit), path)
            rows += 1
        count += 1
    print(f"{folder}: {count} drives, {rows} rows agree")


def openacc(stem):
    run, place = stem.removeprefix("oa_pair_").split("_f")
    return f"openacc-{run}-f{place.split('_')[0]}.parquet"


def ngsim_pair(stem):
    return "-".join(stem.split("_")[:3]) + ".parquet"


def ngsim():
    vehicles = {}
    for row in rows_of(DATA / "ngsim_us101_i80/vehicles_with_leader.csv"):
        vehicles.setdefault((row["Location"], row["Vehicle_ID"]), []).append(row)
    rows = 0
    for (place, number), plain in vehicles.items():
        frame = drive(OUT / "ngsim" / f"ngsim-{place}-{number}.parquet")
        at = {round(t * 1000): i for i, t in enumerate(frame["time_s"])}
        start = int(plain[0]["Global_Time"])
        for row in plain:
            i = at.get(int(row["Global_Time"]) - start)
            if i is None:
                continue
            gap = float(row["preceding_Local_Y"]) - float(row["Local_Y"]) - float(row["preceding_vehicle_length"])
            close(frame["ego_speed_mps"][i], float(row["v_Vel"]), number)
            close(frame["lead_dx_m"][i], max(0.0, gap), number)
            close(frame["lead_id"][i], float(row["Preceding"]), number)
            rows += 1
    print(f"ngsim_us101_i80: {len(vehicles)} drives, {rows} rows agree")


pairs("openacc_astazero", "openacc", openacc, 1.0)
pairs("ngsim_i80_pairs", "ngsim_pairs", ngsim_pair, FOOT)
ngsim()
