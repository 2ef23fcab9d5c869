//! Several factors: the factorial analysis of variance, or aligned ranks.

use super::{
    ByDesign, Chosen, ChosenTest, DesignChoice, DesignColumns, FactorialFinding, OutcomeScale,
    check, judged, said_of_ordinal,
};
use crate::{FactorialDesign, StatsError, aligned_ranks, factorial, normality::shapiro_wilk};

pub(super) fn several(
    data: &DesignColumns<'_>,
    choice: &DesignChoice,
    mut reasons: Vec<String>,
) -> Result<ByDesign, StatsError> {
    let design =
        FactorialDesign::from_columns(data.subjects, &data.within, &data.between, data.values)?;
    let [inside, people] = design.standardised_residuals();
    let checks: Vec<_> = [
        ("the standardised residuals", inside),
        ("the subjects' standardised means", people),
    ]
    .into_iter()
    .filter(|(_, residuals)| !residuals.is_empty())
    .map(|(name, residuals)| check(name, &shapiro_wilk(&residuals).0))
    .collect();
    let (normal, mut words) = judged(&checks);
    let normal = normal && choice.scale != OutcomeScale::Ordinal;
    if let Some(asked) = said_of_ordinal(choice, "their ranks are aligned") {
        words = asked;
    }
    let (chosen, name) = if normal {
        (
            ChosenTest::Factorial,
            "analysis of variance with type III sums of squares, Greenhouse-Geisser by effect",
        )
    } else {
        (ChosenTest::AlignedRanks, "aligned ranks")
    };
    let factors = |count: usize| format!("{count} factor{}", if count == 1 { "" } else { "s" });
    let kinds = match (data.within.len(), data.between.len()) {
        (0, k) => format!("{} between subjects", factors(k)),
        (k, 0) => format!("{} within subjects", factors(k)),
        (w, b) => format!("{} within and {b} between subjects", factors(w)),
    };
    reasons.push(format!("{kinds}; {words}: {name}"));
    let found = FactorialFinding {
        anova: factorial(&design),
        ranks: (!normal).then(|| aligned_ranks(&design)),
    };
    Ok(ByDesign::Factorial(Box::new(Chosen {
        chosen,
        reasons,
        checks,
        found,
    })))
}
