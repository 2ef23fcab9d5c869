//! Ours beside theirs.

use super::load::{Claim, Quantity, Rule};
use super::self_check::{SelfCheck, self_check};
use crate::error::ReportError;
use maveric_stats::simultaneous_interval;
use std::collections::BTreeMap;

/// A claim with our result.
#[derive(Debug, Clone, PartialEq)]
pub struct LedgerRow {
    /// What the paper says.
    pub claim: Claim,
    /// Our number, in the claim's unit.
    pub ours: Option<f64>,
    /// The p that belongs to our coefficient.
    pub ours_p: Option<f64>,
    /// Which coefficient ours is, whatever the paper's is; the claim's kind where that is not said.
    pub ours_quantity: Quantity,
    /// What the rule says.
    pub verdict: Verdict,
    /// Whether the paper's number follows from its other numbers.
    pub own_figures: Option<SelfCheck>,
    /// What made our number, and where it is shown; whoever computed it fills this in.
    pub made: Option<Made>,
}

/// What made a number, and where it is shown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Made {
    /// Stage of the pipeline.
    pub stage: String,
    /// Anchor of the figure or table on the page, such as `figure-preference`.
    pub shown_in: Option<String>,
}

/// What agreeing leaves open.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeftOpen {
    /// The difference goes the claimed way, with no p below .05.
    DirectionAlone,
    /// The paper found nothing, and so did we.
    NothingFound,
}

/// What comes of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Direction and size are as in the paper.
    Agrees,
    /// The direction is, the size or the strength is not.
    SameDirection,
    /// Not even the direction.
    Differs,
    /// Of fewer than six people: nothing goes with anything.
    TooFew,
    /// Whoever runs the study set it so.
    ByDesign,
    /// Sizes were chosen so that ours comes near.
    Tuned,
    /// Nothing was found under the key.
    NotComputed,
}

impl LedgerRow {
    /// Whether a coefficient is clear (*p* < .05) in the paper and here; `None` without both p.
    pub fn clear(&self) -> Option<&'static str> {
        let printed = self.claim.printed_p.as_ref()?;
        // "< .05" is below it.
        let theirs = printed.value < SIGNIFICANT
            || (printed.bound == Some('<') && printed.value <= SIGNIFICANT);
        Some(match (theirs, self.ours_p? < SIGNIFICANT) {
            (true, true) => "clear in both",
            (true, false) => "clear in the paper only",
            (false, true) => "clear here only",
            (false, false) => "clear in neither",
        })
    }

    /// What an agreement leaves open, where its rule asks for less than a reader may take from it.
    pub fn left_open(&self) -> Option<LeftOpen> {
        let not_clear = self.ours_p.is_some_and(|p| p >= SIGNIFICANT);
        match self.claim.rule {
            _ if self.verdict != Verdict::Agrees => None,
            Rule::PAbove { .. } => Some(LeftOpen::NothingFound),
            Rule::Above | Rule::Below if not_clear => Some(LeftOpen::DirectionAlone),
            _ => None,
        }
    }
}

impl LeftOpen {
    /// As the ledger writes it.
    pub fn text(self) -> &'static str {
        match self {
            Self::DirectionAlone => "same direction; not shown",
            Self::NothingFound => "none found, which does not show that there is none",
        }
    }
}

impl Verdict {
    /// As a count of several is followed by it: "3 agree".
    pub fn of_several(self) -> &'static str {
        match self {
            Self::Agrees => "agree",
            Self::Differs => "differ",
            other => other.text(),
        }
    }

    /// Every verdict, the best first.
    pub const ALL: [Self; 7] = [
        Self::Agrees,
        Self::SameDirection,
        Self::Differs,
        Self::TooFew,
        Self::ByDesign,
        Self::Tuned,
        Self::NotComputed,
    ];

    /// As the ledger writes it.
    pub fn text(self) -> &'static str {
        match self {
            Self::Agrees => "agrees",
            Self::SameDirection => "same direction",
            Self::Differs => "differs",
            Self::TooFew => "too few to say",
            Self::ByDesign => "by design",
            Self::Tuned => "tuned for",
            Self::NotComputed => "not computed here",
        }
    }
}

/// Joins claims and results, in the claims' order.
///
/// `results` maps keys to numbers in the claim's unit (percent as 0..100, speeds in mph). A key
/// that is not there gives [`Verdict::NotComputed`]. The p of a coefficient under `….r`, or of a
/// difference under `….difference`, is looked up under `….p`. A p that is to be below a bound needs its direction beside it: `….p` is read
/// together with `….direction`, above 0 if the difference goes the way that the claim says. Where `….n` says from how many pairs a coefficient
/// comes, the printed one agrees if the 95 % interval of ours holds it; `….ranks` above 0 says that ours is Spearman's, 0 that it is Pearson's. `n`
/// is the number of people: below six nothing agrees or differs.
///
/// # Errors
/// [`ReportError::Claim`] if a result is not finite.
pub fn join(
    claims: &[Claim],
    results: &BTreeMap<String, f64>,
) -> Result<Vec<LedgerRow>, ReportError> {
    claims
        .iter()
        .map(|claim| {
            let find = |key: &str| -> Result<Option<f64>, ReportError> {
                match results.get(key) {
                    Some(value) if !value.is_finite() => Err(ReportError::Claim {
                        id: claim.id.clone(),
                        reason: format!("our result `{key}` is {value}"),
                    }),
                    found => Ok(found.copied()),
                }
            };
            let ours = find(&claim.key)?;
            let stem = claim.key.strip_suffix(".r");
            let beside = |stem: Option<&str>, end: &str| {
                stem.map_or(Ok(None), |stem| find(&format!("{stem}.{end}")))
            };
            let ours_p = beside(stem.or_else(|| claim.key.strip_suffix(".difference")), "p")?;
            let pairs = beside(stem, "n")?;
            let ours_quantity = match beside(stem, "ranks")? {
                Some(ranks) if ranks > 0.0 => Quantity::Rho,
                Some(_) => Quantity::R,
                None => claim.quantity,
            };
            let of_pairs = pairs.map(|n| (n, ours_quantity));
            let few = find("n")?.into_iter().chain(pairs).any(|n| n < FEWEST);
            let verdict = match (ours, claim.rule) {
                (None, _) => Verdict::NotComputed,
                (Some(_), Rule::ByDesign {}) => Verdict::ByDesign,
                _ if claim.tuned => Verdict::Tuned,
                _ if few => Verdict::TooFew,
                // A small p says nothing of which way: without the direction there is no verdict.
                (Some(p), Rule::PBelow { .. }) => match find(&direction_key(&claim.key))? {
                    None => Verdict::NotComputed,
                    Some(direction) if direction > 0.0 => judge(claim, p, None),
                    Some(_) => Verdict::Differs,
                },
                (Some(ours), _) => judge(claim, ours, of_pairs),
            };
            Ok(LedgerRow {
                claim: claim.clone(),
                ours,
                ours_p,
                ours_quantity,
                verdict,
                own_figures: self_check(claim, claims),
                made: None,
            })
        })
        .collect()
}

fn direction_key(key: &str) -> String {
    format!("{}.direction", key.strip_suffix(".p").unwrap_or(key))
}

/// Without a bound of its own, a p below this still points the same way.
const SIGNIFICANT: f64 = 0.05;

/// Fewest people of whom anything is said.
const FEWEST: f64 = 6.0;

fn judge(claim: &Claim, ours: f64, pairs: Option<(f64, Quantity)>) -> Verdict {
    let theirs = claim.printed.value;
    let distance = (ours - theirs).abs();
    let choose = |holds: bool, yes: Verdict, no: Verdict| if holds { yes } else { no };
    // A tolerance of 0 means "the same number", up to the last bits.
    let within = |tolerance: f64| distance <= tolerance + 1e-9;
    match claim.rule {
        Rule::Direction { tolerance } => {
            let same = ours * theirs > 0.0;
            let interval = pairs.and_then(|(n, quantity)| {
                simultaneous_interval(ours, n as usize, 1, quantity == Quantity::Rho)
            });
            let near = match interval {
                Some((low, high)) => low <= theirs && theirs <= high,
                None => within(tolerance),
            };
            match (same, near) {
                (true, true) => Verdict::Agrees,
                (true, false) => Verdict::SameDirection,
                (false, _) => Verdict::Differs,
            }
        }
        Rule::Near { tolerance } => choose(within(tolerance), Verdict::Agrees, Verdict::Differs),
        Rule::PBelow { bound } => {
            let weaker = choose(ours < SIGNIFICANT, Verdict::SameDirection, Verdict::Differs);
            choose(ours < bound, Verdict::Agrees, weaker)
        }
        Rule::PAbove { bound } => choose(ours > bound, Verdict::Agrees, Verdict::Differs),
        Rule::Above => choose(ours > theirs, Verdict::Agrees, Verdict::Differs),
        Rule::Below => choose(ours < theirs, Verdict::Agrees, Verdict::Differs),
        Rule::ByDesign {} => Verdict::ByDesign,
    }
}

#[cfg(test)]
mod tests {
    use super::super::load::load;
    use super::*;

    fn claim(printed: &str, rule: &str) -> Vec<Claim> {
        load(&format!(
            "[[claim]]\nid = \"a\"\ntext = \"t\"\nsection = \"s\"\nquantity = \"r\"\n\
             printed = \"{printed}\"\nkey = \"x.r\"\nrule = {rule}\n"
        ))
        .unwrap()
    }

    fn verdict(printed: &str, rule: &str, ours: f64) -> Verdict {
        let results = BTreeMap::from([("x.r".to_owned(), ours), ("x.r.direction".to_owned(), 1.0)]);
        join(&claim(printed, rule), &results).unwrap()[0].verdict
    }

    #[test]
    fn direction_asks_for_the_sign_first_and_the_size_second() {
        let rule = "{ direction = { tolerance = 0.2 } }";
        assert_eq!(verdict("-.46", rule, -0.3), Verdict::Agrees);
        assert_eq!(verdict("-.46", rule, -0.1), Verdict::SameDirection);
        assert_eq!(verdict("-.46", rule, 0.1), Verdict::Differs);
        assert_eq!(verdict(".05", rule, -0.01), Verdict::Differs);
    }

    #[test]
    fn with_the_number_of_pairs_a_coefficient_agrees_where_its_interval_holds_the_printed_one() {
        let claims = claim("-.46", "{ direction = { tolerance = 0.01 } }");
        let judged = |r: f64, n: f64| {
            let results = [("x.r", r), ("x.n", n), ("n", n)].map(|(k, v)| (k.to_owned(), v));
            join(&claims, &BTreeMap::from(results)).unwrap()[0].verdict
        };
        // Fisher's interval of -.30 from 24 pairs is -.63 to .12.
        assert_eq!(judged(-0.30, 24.0), Verdict::Agrees);
        assert_eq!(judged(-0.95, 24.0), Verdict::SameDirection);
        assert_eq!(judged(0.30, 24.0), Verdict::Differs);
        // Of three people nothing agrees.
        assert_eq!(judged(-0.46, 3.0), Verdict::TooFew);
    }

    #[test]
    fn a_rank_correlation_has_the_wider_interval() {
        // From 24 pairs -.80 reaches to -.59 as Pearson's r and to -.54 as Spearman's rho.
        let results = [("x.r", -0.8), ("x.n", 24.0), ("n", 24.0)].map(|(k, v)| (k.to_owned(), v));
        let results = BTreeMap::from(results);
        let mut claims = claim("-.56", "{ direction = { tolerance = 0.01 } }");
        for (quantity, verdict) in
            [(Quantity::R, Verdict::SameDirection), (Quantity::Rho, Verdict::Agrees)]
        {
            claims[0].quantity = quantity;
            assert_eq!(join(&claims, &results).unwrap()[0].verdict, verdict);
        }
        // Which of them ours is decides, where it is said.
        let mut results = results;
        for (ranks, quantity, verdict) in
            [(0.0, Quantity::R, Verdict::SameDirection), (1.0, Quantity::Rho, Verdict::Agrees)]
        {
            results.insert("x.ranks".to_owned(), ranks);
            let row = &join(&claims, &results).unwrap()[0];
            assert_eq!((row.ours_quantity, row.verdict), (quantity, verdict));
        }
    }

    #[test]
    fn what_was_tuned_for_is_no_finding_however_near_it_comes() {
        let mut claims = claim("-.46", "{ direction = { tolerance = 0.1 } }");
        claims[0].tuned = true;
        let results = BTreeMap::from([("x.r".to_owned(), -0.46)]);
        assert_eq!(join(&claims, &results).unwrap()[0].verdict, Verdict::Tuned);
    }

    #[test]
    fn what_whoever_runs_sets_is_no_finding_whether_or_not_it_is_the_papers_number() {
        for ours in [0.3, 0.12] {
            assert_eq!(verdict(".3", "{ by-design = {} }", ours), Verdict::ByDesign);
        }
        assert_eq!(verdict(".3", "{ near = { tolerance = 0 } }", 0.12), Verdict::Differs);
    }

    #[test]
    fn a_weaker_p_still_points_the_same_way() {
        let rule = "{ p-below = { bound = 0.001 } }";
        assert_eq!(verdict("<.001", rule, 0.0001), Verdict::Agrees);
        assert_eq!(verdict("<.001", rule, 0.02), Verdict::SameDirection);
        assert_eq!(verdict("<.001", rule, 0.2), Verdict::Differs);
    }

    #[test]
    fn a_small_p_the_other_way_does_not_agree() {
        let claims = claim("<.001", "{ p-below = { bound = 0.001 } }");
        let mut results = BTreeMap::from([("x.r".to_owned(), 1e-6)]);
        assert_eq!(join(&claims, &results).unwrap()[0].verdict, Verdict::NotComputed);
        results.insert("x.r.direction".to_owned(), -0.4);
        assert_eq!(join(&claims, &results).unwrap()[0].verdict, Verdict::Differs);
    }

    #[test]
    fn agreement_of_a_direction_alone_and_of_nothing_found_is_said_to_be_no_more() {
        let open = |claims: &[Claim], key: &str, ours: f64, p: f64| {
            let results = [(key, ours), ("x.p", p)].map(|(k, v)| (k.to_owned(), v));
            join(claims, &BTreeMap::from(results)).unwrap()[0].left_open()
        };
        let mut higher = claim(">0", "\"above\"");
        higher[0].quantity = Quantity::Difference;
        higher[0].key = "x.difference".to_owned();
        let difference = |ours, p| open(&higher, "x.difference", ours, p);
        assert_eq!(difference(0.4, 0.6), Some(LeftOpen::DirectionAlone));
        assert_eq!(difference(0.4, 0.01), None);
        assert_eq!(difference(-0.4, 0.6), None);
        let mut none = claim(">.05", "{ p-above = { bound = 0.05 } }");
        none[0].quantity = Quantity::P;
        none[0].key = "x.p".to_owned();
        assert_eq!(open(&none, "x.p", 0.3, 0.3), Some(LeftOpen::NothingFound));
        assert_eq!(open(&none, "x.p", 0.01, 0.01), None);
    }

    #[test]
    fn what_was_not_computed_is_said_to_be_so() {
        let rows = join(&claim(".5", "\"above\""), &BTreeMap::new()).unwrap();
        assert_eq!(rows[0].verdict, Verdict::NotComputed);
        assert_eq!(rows[0].ours, None);
    }

    #[test]
    fn a_result_that_is_no_number_is_refused() {
        let results = BTreeMap::from([("x.r".to_owned(), f64::NAN)]);
        assert!(join(&claim(".5", "\"above\""), &results).is_err());
    }

    #[test]
    fn a_misspelt_key_in_the_file_is_an_error() {
        assert!(matches!(load("[[claim]]\nidd = \"a\""), Err(ReportError::Claims { .. })));
    }
}
