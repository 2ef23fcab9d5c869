//! Sums over subjects that every evaluation of a mixed model needs.

use crate::numerics::{matrix::Matrix, moments::dot};
use std::ops::Range;

/// One subject's rows of fixed columns x, random columns z and y, all three turned alike, so that z has numbers in its first rows alone.
///
/// A rotation changes no sum of products, and so nothing of the model; but what u takes and what it leaves then stand in rows of their own,
/// and are not found as small differences of large sums where people differ a million times more than their rows.
#[derive(Debug, Clone)]
pub(crate) struct Block {
    pub(crate) x: Matrix,
    pub(crate) z: Matrix,
    pub(crate) y: Matrix,
}

/// All subjects' rows.
#[derive(Debug, Clone)]
pub(crate) struct Blocks {
    pub(crate) subjects: Vec<Block>,
    pub(crate) rows: usize,
    pub(crate) p: usize,
    pub(crate) q: usize,
    /// Of the rows that know nothing of u.
    below: Weighted,
}

/// With W = I + Z Γ Zᵀ: XᵀW⁻¹X, XᵀW⁻¹y, yᵀW⁻¹y and ln |W|.
#[derive(Debug, Clone)]
pub(crate) struct Weighted {
    pub(crate) xx: Matrix,
    pub(crate) xy: Matrix,
    pub(crate) yy: f64,
    pub(crate) ln_determinant: f64,
    /// x and y of each subject's upper rows, over the lower Cholesky factor of their W.
    upper: Vec<(Matrix, Matrix)>,
}

impl Weighted {
    /// Takes in rows whose W is 1.
    fn add(&mut self, x: &Matrix, y: &Matrix) {
        add_square(&mut self.xx, x);
        self.xy.add(&x.transposed_times(y), 1.0);
        self.yy += y.transposed_times(y)[(0, 0)];
    }
}

impl Block {
    /// By Householder's reflections of the columns of z.
    pub(crate) fn new(mut x: Matrix, mut z: Matrix, mut y: Matrix) -> Self {
        for j in 0..z.columns {
            let Some(mirror) = mirror(&z, j) else {
                continue;
            };
            for matrix in [&mut x, &mut z, &mut y] {
                reflect(matrix, j, &mirror);
            }
            // Without what rounding leaves there.
            for i in j + 1..z.rows {
                z[(i, j)] = 0.0;
            }
        }
        Self { x, z, y }
    }

    /// How many rows may know of u.
    fn upper(&self) -> usize {
        self.z.rows.min(self.z.columns)
    }
}

/// The vector v of the reflection 1 - 2 v vᵀ / vᵀv that leaves a number in the first row alone, of rows `from` on of column `from`; none
/// where nothing stands below it.
fn mirror(z: &Matrix, from: usize) -> Option<Vec<f64>> {
    let mut column: Vec<f64> = (from..z.rows).map(|i| z[(i, from)]).collect();
    let size = dot(&column, &column).sqrt();
    let below = column.iter().skip(1).any(|v| v.abs() > 0.0);
    let first = column.first_mut().filter(|_| below)?;
    *first += size.copysign(*first);
    Some(column)
}

fn reflect(matrix: &mut Matrix, from: usize, mirror: &[f64]) {
    let square = dot(mirror, mirror);
    for j in 0..matrix.columns {
        let along = mirror.iter().zip(from..).map(|(v, i)| v * matrix[(i, j)]);
        let times = 2.0 * along.sum::<f64>() / square;
        for (v, i) in mirror.iter().zip(from..) {
            matrix[(i, j)] -= times * v;
        }
    }
}

/// Some rows of a matrix.
fn rows_of(matrix: &Matrix, rows: Range<usize>) -> Matrix {
    Matrix::from(rows.len(), matrix.columns, |i, j| matrix[(rows.start + i, j)])
}

/// y - x β.
fn rest(x: &Matrix, y: &Matrix, beta: &Matrix) -> Matrix {
    let mut rest = y.clone();
    rest.add(&x.times(beta), -1.0);
    rest
}

impl Blocks {
    /// From the rows of each subject: `p` columns x and `q` columns z by row, and y.
    pub(super) fn of_rows(
        people: &[Vec<usize>],
        (p, q): (usize, usize),
        x: impl Fn(usize, usize) -> f64,
        z: impl Fn(usize, usize) -> f64,
        y: impl Fn(usize) -> f64,
    ) -> Self {
        let block = |rows: &Vec<usize>| {
            Block::new(
                Matrix::from(rows.len(), p, |i, j| x(rows[i], j)),
                Matrix::from(rows.len(), q, |i, j| z(rows[i], j)),
                Matrix::from(rows.len(), 1, |i, _| y(rows[i])),
            )
        };
        Self::new(people.iter().map(block).collect())
    }

    pub(crate) fn new(subjects: Vec<Block>) -> Self {
        let (p, q) = subjects.first().map_or((0, 0), |b| (b.x.columns, b.z.columns));
        let mut below = Weighted {
            xx: Matrix::zeros(p, p),
            xy: Matrix::zeros(p, 1),
            yy: 0.0,
            ln_determinant: 0.0,
            upper: Vec::new(),
        };
        for block in &subjects {
            let rows = block.upper()..block.y.rows;
            below.add(&rows_of(&block.x, rows.clone()), &rows_of(&block.y, rows));
        }
        Self { rows: subjects.iter().map(|b| b.y.rows).sum(), subjects, p, q, below }
    }

    /// Root mean square of a random column.
    pub(super) fn size(&self, j: usize) -> f64 {
        let block_squares = |b: &Block| (0..b.z.rows).map(|i| b.z[(i, j)].powi(2)).sum::<f64>();
        let squares: f64 = self.subjects.iter().map(block_squares).sum();
        (squares / self.rows as f64).sqrt()
    }

    /// The same with y - X β in the place of y.
    pub(super) fn less(&self, beta: &Matrix) -> Self {
        let block = |b: &Block| Block { y: rest(&b.x, &b.y, beta), ..b.clone() };
        Self::new(self.subjects.iter().map(block).collect())
    }

    /// The sums for Γ = L Lᵀ, which may be singular.
    pub(crate) fn weighted(&self, l: &Matrix) -> Option<Weighted> {
        let mut sums = self.below.clone();
        for block in &self.subjects {
            let rows = 0..block.upper();
            let spread = rows_of(&block.z, rows.clone()).times(l);
            let mut w = spread.times(&spread.transposed());
            w.add(&Matrix::identity(rows.len()), 1.0);
            let factor = w.cholesky()?;
            let x = factor.half_solve(&rows_of(&block.x, rows.clone()));
            let y = factor.half_solve(&rows_of(&block.y, rows));
            sums.add(&x, &y);
            sums.ln_determinant += factor.ln_determinant();
            sums.upper.push((x, y));
        }
        Some(sums)
    }

    /// Of each subject XᵀW⁻¹X and XᵀW⁻¹(y - X β).
    pub(super) fn by_subject(&self, sums: &Weighted, beta: &Matrix) -> Vec<(Matrix, Matrix)> {
        let one = |(block, (x, y)): (&Block, &(Matrix, Matrix))| {
            let rows = block.upper()..block.y.rows;
            let below = rows_of(&block.x, rows.clone());
            let left_below = rest(&below, &rows_of(&block.y, rows), beta);
            let mut information = x.transposed_times(x);
            information.add(&below.transposed_times(&below), 1.0);
            let mut pull = x.transposed_times(&rest(x, y, beta));
            pull.add(&below.transposed_times(&left_below), 1.0);
            (information, pull)
        };
        self.subjects.iter().zip(&sums.upper).map(one).collect()
    }

    /// (y - X β)ᵀ W⁻¹ (y - X β), summed over what is left of each row.
    pub(super) fn rest(&self, sums: &Weighted, beta: &Matrix) -> f64 {
        let square = |rest: &Matrix| rest.transposed_times(rest)[(0, 0)];
        let upper = sums.upper.iter().map(|(x, y)| square(&rest(x, y, beta)));
        let below = self.subjects.iter().map(|block| {
            let rows = block.upper()..block.y.rows;
            let rest = rest(&block.x, &block.y, beta);
            square(&rows_of(&rest, rows))
        });
        upper.sum::<f64>() + below.sum::<f64>()
    }
}

/// a + bᵀb.
fn add_square(a: &mut Matrix, b: &Matrix) {
    for k in 0..b.rows {
        let row = b.row(k).to_vec();
        for (i, bi) in row.iter().enumerate() {
            for (j, bj) in row.iter().enumerate() {
                a[(i, j)] += bi * bj;
            }
        }
    }
}
