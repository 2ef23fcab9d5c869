//! Sums over subjects that every evaluation of a mixed model needs.

use crate::numerics::matrix::Matrix;

/// One subject's rows: y, fixed and random columns.
#[derive(Debug, Clone)]
pub(crate) struct Block {
    pub(crate) x: Matrix,
    pub(crate) z: Matrix,
    pub(crate) y: Matrix,
    zz: Matrix,
    zx: Matrix,
    zy: Matrix,
}

/// All subjects' rows.
#[derive(Debug, Clone)]
pub(crate) struct Blocks {
    pub(crate) subjects: Vec<Block>,
    pub(crate) rows: usize,
    pub(crate) p: usize,
    pub(crate) q: usize,
    /// Those at Γ = 0.
    sums: Weighted,
}

/// With W = I + Z Γ Zᵀ: XᵀW⁻¹X, XᵀW⁻¹y, yᵀW⁻¹y and ln |W|.
#[derive(Debug, Clone)]
pub(crate) struct Weighted {
    pub(crate) xx: Matrix,
    pub(crate) xy: Matrix,
    pub(crate) yy: f64,
    pub(crate) ln_determinant: f64,
}

impl Block {
    pub(crate) fn new(x: Matrix, z: Matrix, y: Matrix) -> Self {
        Self {
            zz: z.transposed_times(&z),
            zx: z.transposed_times(&x),
            zy: z.transposed_times(&y),
            x,
            z,
            y,
        }
    }
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
        let (p, q) = subjects
            .first()
            .map_or((0, 0), |b| (b.x.columns, b.z.columns));
        let mut sums = Weighted {
            xx: Matrix::zeros(p, p),
            xy: Matrix::zeros(p, 1),
            yy: 0.0,
            ln_determinant: 0.0,
        };
        for block in &subjects {
            sums.xx.add(&block.x.transposed_times(&block.x), 1.0);
            sums.xy.add(&block.x.transposed_times(&block.y), 1.0);
            sums.yy += block.y.transposed_times(&block.y)[(0, 0)];
        }
        Self {
            rows: subjects.iter().map(|b| b.y.rows).sum(),
            subjects,
            p,
            q,
            sums,
        }
    }

    /// Root mean square of a random column.
    pub(super) fn size(&self, j: usize) -> f64 {
        let block_squares = |b: &Block| (0..b.z.rows).map(|i| b.z[(i, j)].powi(2)).sum::<f64>();
        let squares: f64 = self.subjects.iter().map(block_squares).sum();
        (squares / self.rows as f64).sqrt()
    }

    /// The sums for Γ = L Lᵀ, by Woodbury's identity: Γ may be singular.
    pub(crate) fn weighted(&self, l: &Matrix) -> Option<Weighted> {
        let mut sums = self.sums.clone();
        let lt = l.transposed();
        for block in &self.subjects {
            let mut inner = lt.times(&block.zz).times(l);
            inner.add(&Matrix::identity(self.q), 1.0);
            let factor = inner.cholesky()?;
            let x = factor.half_solve(&lt.times(&block.zx));
            let y = factor.half_solve(&lt.times(&block.zy));
            subtract_square(&mut sums.xx, &x);
            sums.xy.add(&x.transposed_times(&y), -1.0);
            sums.yy -= y.transposed_times(&y)[(0, 0)];
            sums.ln_determinant += factor.ln_determinant();
        }
        Some(sums)
    }
}

/// a − bᵀb, the symmetric half at a time.
fn subtract_square(a: &mut Matrix, b: &Matrix) {
    for k in 0..b.rows {
        let row = b.row(k).to_vec();
        for (i, bi) in row.iter().enumerate() {
            for (j, bj) in row.iter().enumerate() {
                a[(i, j)] -= bi * bj;
            }
        }
    }
}
