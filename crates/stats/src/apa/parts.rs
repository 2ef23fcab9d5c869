//! The sentences of simple effects and of contrasts of levels.

use super::{Statement, degrees};
use crate::{Adjustment, EffectMethod, LevelContrast, SimpleTest};

impl SimpleTest {
    /// Its test with this p, which may be adjusted; none where there is no statistic.
    pub fn statement(&self, p: f64) -> Option<Statement> {
        let test = self.test.as_ref()?;
        let value = test.statistic?;
        let statement = match (test.df1, test.df2) {
            (Some(df1), Some(df2)) => Statement::with_df("*F*", &[df1, df2], value),
            (Some(df), None) => Statement::with_df("*χ*^{2}", &[df], value),
            _ => ranks(test.method, value),
        };
        Some(statement.p(p, Adjustment::None))
    }
}

impl LevelContrast {
    /// Its test with this p, which may be adjusted; none where there is no statistic.
    pub fn statement(&self, p: f64) -> Option<Statement> {
        let value = self.statistic?;
        let statement = match self.df {
            Some(df) => Statement::with_df("*t*", &[df], value),
            None => ranks(self.method, value),
        };
        Some(statement.p(p, Adjustment::None))
    }
}

pub(super) fn ranks(method: EffectMethod, value: f64) -> Statement {
    let symbol = match method {
        EffectMethod::GroupRanks => "*U*",
        _ => "*V*",
    };
    Statement(format!("{symbol} = {}", degrees(value)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Interval;

    #[test]
    fn a_contrast_is_said_as_the_test_that_it_had() {
        let t = LevelContrast {
            n: 12,
            method: EffectMethod::Strata,
            estimate: 1.0,
            se: Some(0.5),
            statistic: Some(2.0),
            df: Some(11.0),
            p: Some(0.07),
            ci: Interval::default(),
        };
        assert_eq!(t.statement(0.14).unwrap().markup(), "*t*(11) = 2.00, *p* = .140");
        for (method, said) in [
            (EffectMethod::SignedRanks, "*V* = 31, *p* = .140"),
            (EffectMethod::GroupRanks, "*U* = 31, *p* = .140"),
        ] {
            let ranks = LevelContrast { method, statistic: Some(31.0), df: None, ..t.clone() };
            assert_eq!(ranks.statement(0.14).unwrap().markup(), said);
        }
        let none = LevelContrast { statistic: None, ..t };
        assert!(none.statement(0.14).is_none());
    }
}
