//! Whether a printed p follows from the printed coefficient and its degrees of freedom.

use super::load::{Claim, Quantity};
use maveric_stats::{ReportedCorrelation, recheck as recompute};

/// What a recomputation says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recheck {
    /// Lowest p among the coefficients that round to the printed one.
    pub p_low: f64,
    /// Highest.
    pub p_high: f64,
    /// Whether the printed p can be one of them.
    pub follows: bool,
    /// If not: the degrees of freedom nearest to the claimed ones with which it would.
    pub fitting_df: Option<u32>,
}

/// Most degrees of freedom that are tried.
const MOST_DF: u32 = 200;

/// Recomputes p by [`maveric_stats::recheck`], which allows for rounding on both sides; `None`
/// for a claim without coefficient, p or degrees of freedom.
pub fn recheck(claim: &Claim) -> Option<Recheck> {
    if !matches!(claim.quantity, Quantity::R | Quantity::Rho) {
        return None;
    }
    let (printed_p, df) = (claim.printed_p.as_ref()?, claim.df?);
    let once = |df: u32| {
        let reported = ReportedCorrelation {
            coefficient: claim.printed.as_written().to_owned(),
            df: df as usize,
            p: printed_p.as_written().to_owned(),
        };
        recompute(&[reported]).ok()?.row.into_iter().next()
    };
    let result = once(df)?;
    let fits = |df: &u32| once(*df).is_some_and(|result| result.consistent);
    let fitting_df = if result.consistent {
        None
    } else {
        (1..=MOST_DF).filter(fits).min_by_key(|candidate| candidate.abs_diff(df))
    };
    let [p_low, p_high] = result.p_range;
    Some(Recheck { p_low, p_high, follows: result.consistent, fitting_df })
}

#[cfg(test)]
mod tests {
    use super::super::load::load;
    use super::*;

    const CLAIMS: &str = maveric_data::CLAIMS;

    #[test]
    fn four_rows_of_the_papers_table_do_not_follow_from_their_own_figures() {
        let failing: Vec<String> = load(CLAIMS)
            .unwrap()
            .iter()
            .filter(|claim| claim.section == "Table of correlations")
            .filter(|claim| recheck(claim).is_some_and(|result| !result.follows))
            .map(|claim| claim.id.clone())
            .collect();
        assert_eq!(
            failing,
            [
                "conscientiousness-ma-trust",
                "similarity-trust",
                "similarity-competence",
                "high-velocity-ma-intelligence"
            ]
        );
    }

    #[test]
    fn the_correlations_along_the_line_fit_20_degrees_of_freedom_and_not_22() {
        let claims = load(CLAIMS).unwrap();
        let line = claims.iter().filter(|claim| claim.id.starts_with("line-"));
        let mut checked = 0;
        for claim in line.filter(|claim| claim.printed_p.is_some() && claim.id != "line-adb") {
            assert!(!recheck(claim).unwrap().follows, "{}", claim.id);
            let with_20 = Claim { df: Some(20), ..claim.clone() };
            assert!(recheck(&with_20).unwrap().follows, "{}", claim.id);
            checked += 1;
        }
        assert_eq!(checked, 5);
    }
}
