//! Which rows are complete.

use crate::StatsError;

/// Beyond this the fourth power of a deviation, or a sum of squares, may overflow.
const LARGEST: f64 = 1e75;

/// Refuses a value that is not a number one can calculate with.
pub(crate) fn usable(value: f64, name: &str, row: usize) -> Result<(), StatsError> {
    let name = name.to_owned();
    if !value.is_finite() {
        return Err(StatsError::NotFinite { name, row, value });
    }
    if value.abs() > LARGEST {
        return Err(StatsError::TooLarge { name, row, value });
    }
    Ok(())
}

fn all_usable(values: &[Option<f64>], name: &str) -> Result<(), StatsError> {
    for (row, value) in values.iter().enumerate() {
        if let Some(value) = *value {
            usable(value, name, row)?;
        }
    }
    Ok(())
}

/// The value of each of so many cells from a row a cell; none where it has no row, or a row without a value.
///
/// `place` is the cell of a row; `double` refuses a row whose cell had one already.
pub(crate) fn cells(
    values: &[Option<f64>],
    count: usize,
    place: impl Fn(usize) -> usize,
    double: impl Fn(usize) -> StatsError,
) -> Result<Vec<Option<f64>>, StatsError> {
    // The outer option says whether the cell had a row at all.
    let mut cells: Vec<Option<Option<f64>>> = vec![None; count];
    for (row, &value) in values.iter().enumerate() {
        if let Some(value) = value {
            usable(value, "value", row)?;
        }
        if cells[place(row)].replace(value).is_some() {
            return Err(double(row));
        }
    }
    Ok(cells.into_iter().map(Option::flatten).collect())
}

/// The values that are there; at least `least`.
pub(crate) fn values(
    values: &[Option<f64>],
    name: &str,
    least: usize,
) -> Result<Vec<f64>, StatsError> {
    all_usable(values, name)?;
    let kept: Vec<f64> = values.iter().copied().flatten().collect();
    enough("value", kept.len(), values.len() - kept.len(), least)?;
    Ok(kept)
}

/// The rows where every column has a value, by column; at least `least`.
pub(crate) fn rows(
    columns: &[(&str, &[Option<f64>])],
    unit: &str,
    least: usize,
) -> Result<Complete, StatsError> {
    let total = columns.first().map_or(0, |(_, c)| c.len());
    for (name, column) in columns {
        StatsError::same_length(name, column.len(), total)?;
        all_usable(column, name)?;
    }
    let mut complete =
        Complete { columns: vec![Vec::new(); columns.len()], kept: Vec::new(), missing: 0 };
    for row in 0..total {
        let cells: Option<Vec<f64>> = columns.iter().map(|(_, c)| c[row]).collect();
        match cells {
            Some(cells) => {
                complete.kept.push(row);
                for (column, cell) in complete.columns.iter_mut().zip(cells) {
                    column.push(cell);
                }
            }
            None => complete.missing += 1,
        }
    }
    enough(unit, complete.kept.len(), complete.missing, least)?;
    Ok(complete)
}

/// Columns without their incomplete rows.
pub(crate) struct Complete {
    pub(crate) columns: Vec<Vec<f64>>,
    pub(crate) kept: Vec<usize>,
    pub(crate) missing: usize,
}

pub(crate) fn enough(
    unit: &str,
    found: usize,
    dropped: usize,
    expected: usize,
) -> Result<(), StatsError> {
    if found >= expected {
        return Ok(());
    }
    Err(StatsError::TooFew { unit: unit.to_owned(), found, dropped, expected })
}
