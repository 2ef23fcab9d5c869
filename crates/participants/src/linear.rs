//! The one piece of linear algebra that made-up people need.

/// The lower triangle L with L · Lᵀ = `matrix`, shape `(n, n)`. A row without any variance left over is a row of what the others
/// explain.
///
/// # Errors
/// The first negative pivot of a matrix that is not positive semi-definite.
pub(crate) fn cholesky(matrix: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, f64> {
    const NOTHING: f64 = 1e-9;
    let n = matrix.len();
    let mut lower = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            let rest = matrix[i][j] - known;
            if i == j {
                if rest < -NOTHING {
                    return Err(rest);
                }
                lower[i][i] = rest.max(0.0).sqrt();
            } else if lower[j][j] > NOTHING {
                lower[i][j] = rest / lower[j][j];
            } else if rest.abs() > NOTHING {
                return Err(-rest.abs());
            }
        }
    }
    Ok(lower)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_triangle_gives_the_matrix_back() {
        let matrix = vec![vec![4.0, 2.0, 0.0], vec![2.0, 5.0, 0.0], vec![0.0, 0.0, 0.0]];
        let lower = cholesky(&matrix).unwrap();
        for i in 0..3 {
            for j in 0..3 {
                let sum: f64 = (0..3).map(|k| lower[i][k] * lower[j][k]).sum();
                assert!((sum - matrix[i][j]).abs() < 1e-12);
            }
        }
        assert!(cholesky(&[vec![1.0, 2.0], vec![2.0, 1.0]]).is_err());
        assert!(cholesky(&[vec![0.0, 0.1], vec![0.1, 1.0]]).is_err());
    }
}
