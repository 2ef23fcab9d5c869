//! Drives as tables: a data frame, and Parquet with its provenance.

use crate::{
    error::IngestError,
    parquet::{is_parquet, parquet_bytes, read_parquet},
    provenance::Provenance,
    raw::mcap::metadata::{KEYS, MetaValues, meta_entries},
};
use maveric_domain::{Drive, drive::Rows};
use polars::prelude::{Column, DataFrame, DataType, PolarsError};
use std::{collections::BTreeMap, io::Write, path::Path};

/// Version of what is written and read.
const VERSION: &str = "3";
/// What the names of our metadata begin with.
const PREFIX: &str = "maveric.";

/// A drive as a data frame: the signals of the method, one row a sample, units in the names of the columns.
///
/// `following_distance_m` is null where ego does not follow, `lead_id` where there is no reference vehicle, and the
/// gaps behind where nobody is within 200 m or there is no such lane. Nothing else is ever null, and nothing is NaN.
///
/// # Panics
/// Never: the columns of a drive have one length.
///
/// # Source
/// Method section 2, names to the letter.
pub fn drive_frame(drive: &Drive) -> DataFrame {
    let r = drive.rows();
    let numbers = |name: &str, values: &[f64]| Column::new(name.into(), values);
    let whole = |name: &str, values: Vec<i64>| Column::new(name.into(), values);
    let flags = |name: &str, values: &[bool]| Column::new(name.into(), values);
    let followed = r.following.iter().zip(&r.lead_dx_m);
    let distance: Vec<Option<f64>> = followed.map(|(&f, &d)| f.then_some(d)).collect();
    let lead_id: Vec<Option<i64>> = r.lead_id.iter().map(|id| id.map(i64::from)).collect();
    let columns = vec![
        numbers("time_s", &r.time_s),
        whole("segment", r.segment.iter().map(|&s| i64::from(s)).collect()),
        numbers("ego_x_m", &r.ego_x_m),
        numbers("ego_y_m", &r.ego_y_m),
        numbers("ego_speed_mps", &r.ego_speed_mps),
        whole("lane", r.lane.iter().map(|&l| i64::from(l)).collect()),
        flags("lead_present", &r.lead_present),
        Column::new("lead_id".into(), lead_id),
        numbers("lead_dx_m", &r.lead_dx_m),
        numbers("lead_dy_m", &r.lead_dy_m),
        numbers("lead_speed_mps", &r.lead_speed_mps),
        flags("lane_change", &r.lane_change),
        whole("changing", r.changing.iter().map(|&c| i64::from(c)).collect()),
        flags("change_completes", &r.change_completes),
        flags("following", &r.following),
        Column::new("following_distance_m".into(), distance),
        Column::new("gap_behind_left_m".into(), &r.gap_behind_left_m),
        Column::new("gap_behind_right_m".into(), &r.gap_behind_right_m),
    ];
    DataFrame::new(drive.len(), columns)
        .expect("columns of a drive have one length and different names")
}

/// Writes a drive as Parquet: [`drive_frame`], with whose it is, its road and its provenance in the file's metadata.
///
/// # Errors
/// [`IngestError::WriteDrive`].
pub fn write_drive_to(
    mut out: impl Write,
    drive: &Drive,
    provenance: &Provenance,
) -> Result<(), IngestError> {
    let (meta, road) = (drive.meta(), drive.road());
    let (rate_hz, lateral) = (drive.rate_hz(), drive.has_lateral());
    let of_drive = meta_entries(meta, road, rate_hz, lateral, drive.sees());
    let version = [("version", VERSION.to_owned())].into_iter();
    let entries = version.chain(of_drive).map(|(k, v)| (k.to_owned(), v));
    let entries = entries.chain(provenance.entries.iter().cloned());
    let entries = entries.map(|(k, v)| (format!("{PREFIX}{k}"), v)).collect();
    let failed = |reason: String| IngestError::WriteDrive { drive: meta.drive.to_string(), reason };
    let bytes = parquet_bytes(&mut drive_frame(drive), entries).map_err(failed)?;
    out.write_all(&bytes).map_err(|e| failed(e.to_string()))
}

/// Reads a drive back, exactly as it was written, with its provenance.
///
/// # Errors
/// [`IngestError::NotFound`] and the like; [`IngestError::NotADrive`] for another table; [`IngestError::BadDrive`] for what is no
/// drive of this format.
pub fn read_drive_from(path: &Path) -> Result<(Drive, Provenance), IngestError> {
    let bytes = std::fs::read(path).map_err(|e| IngestError::io(path, e))?;
    if !is_parquet(&bytes) {
        return Err(bad(path, "is not Parquet: it does not start with PAR1"));
    }
    let file = read_parquet(bytes, None);
    let file = file.map_err(|why| bad(path, format!("cannot be read: {why}")))?;
    let without_prefix =
        |(key, value): (String, String)| Some((key.strip_prefix(PREFIX)?.to_owned(), value));
    let values: Vec<(String, String)> =
        file.metadata.into_iter().filter_map(without_prefix).collect();
    let read = DriveFile {
        path,
        entries: values.iter().cloned().collect(),
        frame: file.frame,
        checked: file.checked,
    };
    let drive = read.drive()?;
    let of_drive = |key: &str| key == "version" || KEYS.contains(&key);
    let entries = values.into_iter().filter(|(key, _)| !of_drive(key)).collect();
    Ok((drive, Provenance { entries }))
}

fn bad(path: &Path, problem: impl Into<String>) -> IngestError {
    IngestError::BadDrive { path: path.to_owned(), problem: problem.into() }
}

struct DriveFile<'a> {
    path: &'a Path,
    entries: BTreeMap<String, String>,
    frame: DataFrame,
    checked: bool,
}

impl DriveFile<'_> {
    fn drive(&self) -> Result<Drive, IngestError> {
        let version = self.entries.get("version").map(String::as_str);
        let version =
            version.ok_or_else(|| IngestError::NotADrive { path: self.path.to_owned() })?;
        if version != VERSION {
            let problem = format!("is a drive of format {version}, expected {VERSION}");
            return Err(self.bad(problem));
        }
        if !self.checked {
            return Err(bad(self.path, "is damaged: its checksum is not there"));
        }
        let rows = Rows {
            time_s: self.all("time_s")?,
            segment: self.whole("segment")?,
            ego_x_m: self.all("ego_x_m")?,
            ego_y_m: self.all("ego_y_m")?,
            ego_speed_mps: self.all("ego_speed_mps")?,
            lane: self.whole("lane")?,
            lead_present: self.flags("lead_present")?,
            lead_id: self
                .integers("lead_id")?
                .into_iter()
                .map(|id| id.map(|id| self.fits("lead_id", id)).transpose())
                .collect::<Result<_, _>>()?,
            lead_dx_m: self.all("lead_dx_m")?,
            lead_dy_m: self.all("lead_dy_m")?,
            lead_speed_mps: self.all("lead_speed_mps")?,
            lane_change: self.flags("lane_change")?,
            changing: self.whole("changing")?,
            change_completes: self.flags("change_completes")?,
            following: self.flags("following")?,
            gap_behind_left_m: self.numbers("gap_behind_left_m")?,
            gap_behind_right_m: self.numbers("gap_behind_right_m")?,
        };
        let entries = MetaValues { path: self.path, values: &self.entries };
        let rate_hz = entries.positive("rate_hz")?;
        let drive = Drive::from_rows(entries.meta()?, entries.road()?, rate_hz, rows)
            .map_err(|e| self.bad(format!("is no drive: {e}")))?
            .seen_by(entries.sees()?);
        Ok(if entries.without_lateral() { drive.without_lateral() } else { drive })
    }

    fn bad(&self, problem: String) -> IngestError {
        bad(self.path, problem)
    }

    fn column(&self, name: &str) -> Result<&Column, IngestError> {
        let missing = |_| self.bad(format!("has no column `{name}`"));
        self.frame.column(name).map_err(missing)
    }

    fn numbers(&self, name: &str) -> Result<Vec<Option<f64>>, IngestError> {
        let numbers = self.column(name)?.cast(&DataType::Float64);
        let numbers = numbers.and_then(|c| Ok(c.f64()?.iter().collect()));
        numbers.map_err(|e| self.odd(name, &e))
    }

    fn integers(&self, name: &str) -> Result<Vec<Option<i64>>, IngestError> {
        let numbers = self.column(name)?.cast(&DataType::Int64);
        let numbers = numbers.and_then(|c| Ok(c.i64()?.iter().collect()));
        numbers.map_err(|e| self.odd(name, &e))
    }

    fn all(&self, name: &str) -> Result<Vec<f64>, IngestError> {
        self.filled(name, self.numbers(name)?)
    }

    fn whole<T: TryFrom<i64>>(&self, name: &str) -> Result<Vec<T>, IngestError> {
        let cells = self.filled(name, self.integers(name)?)?;
        cells.into_iter().map(|v| self.fits(name, v)).collect()
    }

    fn flags(&self, name: &str) -> Result<Vec<bool>, IngestError> {
        let flags = self.column(name)?.bool().map_err(|e| self.odd(name, &e))?;
        self.filled(name, flags.iter().collect())
    }

    fn filled<T>(&self, name: &str, cells: Vec<Option<T>>) -> Result<Vec<T>, IngestError> {
        let nothing = |row: usize| self.bad(format!("has nothing in row {row} of `{name}`"));
        let cells = (1..).zip(cells);
        cells.map(|(row, cell)| cell.ok_or_else(|| nothing(row))).collect()
    }

    fn fits<T: TryFrom<i64>>(&self, name: &str, value: i64) -> Result<T, IngestError> {
        let unfit = |_| self.bad(format!("has {value} in `{name}`, which does not fit"));
        T::try_from(value).map_err(unfit)
    }

    fn odd(&self, name: &str, error: &PolarsError) -> IngestError {
        self.bad(format!("has another kind of column `{name}`: {error}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_of_another_format_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("old.parquet");
        let mut frame = DataFrame::new(1, vec![Column::new("time_s".into(), [0.0])]).unwrap();
        let version = (format!("{PREFIX}version"), "2".to_owned());
        let bytes = parquet_bytes(&mut frame, vec![version]).unwrap();
        std::fs::write(&path, bytes).unwrap();
        let error = read_drive_from(&path).unwrap_err();
        let expected = "is a drive of format 2, expected 3";
        assert!(error.to_string().ends_with(expected), "{error}");
        assert!(error.suggestion().unwrap().contains("maveric ingest"));
    }
}
