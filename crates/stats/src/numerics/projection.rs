//! What the projection on columns leaves of rows.

use super::moments::dot;

/// Rows less their projection on the columns; else the first column that those before it determine.
pub(crate) fn residuals(
    columns: &[impl AsRef<[f64]>],
    rows: &[Vec<f64>],
) -> Result<Vec<Vec<f64>>, usize> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let less = |mut row: Vec<f64>, basis: &[Vec<f64>]| {
        // Twice, so that rounding leaves nothing.
        for _ in 0..2 {
            for other in basis {
                let along = dot(&row, other);
                for (value, o) in row.iter_mut().zip(other) {
                    *value -= along * o;
                }
            }
        }
        row
    };
    for (at, column) in columns.iter().enumerate() {
        let column: &[f64] = column.as_ref();
        let size = dot(column, column).sqrt();
        let rest = less(column.to_vec(), &basis);
        let left = dot(&rest, &rest).sqrt();
        if left <= 1e-9 * size {
            return Err(at);
        }
        basis.push(rest.into_iter().map(|v| v / left).collect());
    }
    Ok(rows.iter().map(|row| less(row.clone(), &basis)).collect())
}
