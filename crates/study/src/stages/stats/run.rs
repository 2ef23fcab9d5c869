//! From a table to the result of one test.

use super::{
    columns, designs, pictures, printed,
    ran::{ALPHA, Ran, plain},
    rows::DesignRows,
    test::{FactorialMethod, Resampled, Test},
};
use crate::{error::StudyError, tables::Table};
use maveric_stats::{self as tests, Bootstrap, BootstrapData, BootstrapSettings, apa::Statements};
use serde_json::{Map, json};

pub(super) fn run(table: &Table, test: &Test) -> Result<Ran, StudyError> {
    Ok(match test {
        Test::Within(c) => {
            let data = columns::within(table, c)?;
            let found = tests::within(&data);
            let p = found.paired.values().map(|pair| pair.p_holm);
            let picture =
                pictures::conditions(&data, &c.value, pictures::first(&found), &found.desc, p);
            Ran::of(&found, printed::whole(&found)).drawn(picture)
        }
        Test::RmAnova(c) => {
            let data = columns::within(table, c)?;
            let found = tests::rm_anova(&data);
            let none = std::iter::empty();
            let picture =
                pictures::conditions(&data, &c.value, pictures::first(&found), &found.desc, none);
            Ran::of(&found, printed::rm_anova(&found)).drawn(picture)
        }
        Test::Friedman(c) => {
            let data = columns::within(table, c)?;
            let found = tests::friedman(&data);
            let none = std::iter::empty();
            let picture =
                pictures::conditions(&data, &c.value, pictures::first(&found), &found.desc, none);
            Ran::of(&found, printed::friedman(&found)).drawn(picture)
        }
        Test::Posthoc {
            columns: c,
            test,
            adjust,
        } => {
            let data = columns::within(table, c)?;
            let found = tests::posthoc(&data, *test, *adjust, ALPHA)?;
            let desc = tests::rm_anova(&data).desc;
            let picture = pictures::pairs(&data, &c.value, &desc, &found);
            Ran::of(&found, printed::posthoc(&found)).drawn(picture)
        }
        Test::Correlate {
            x,
            y,
            method,
            subject,
        } => {
            let subjects = subject
                .as_ref()
                .map(|s| columns::labels(table, s))
                .transpose()?;
            let (of_x, of_y) = (table.numbers(x)?, table.numbers(y)?);
            let found = tests::correlate(&of_x, &of_y, *method, subjects.as_deref())?;
            let picture = pictures::correlation((x, &of_x), (y, &of_y), pictures::first(&found));
            Ran::of(&found, printed::correlation(&found, x, y)).drawn(picture)
        }
        Test::Rmcorr { subject, x, y } => {
            let subjects = columns::labels(table, subject)?;
            let (of_x, of_y) = (table.numbers(x)?, table.numbers(y)?);
            let found = tests::rm_correlation(&subjects, &of_x, &of_y)?;
            let (slope, said) = (found.rm_corr.slope, pictures::first(&found));
            let picture = pictures::within_people(&subjects, (x, &of_x), (y, &of_y), slope, said);
            Ran::of(&found, printed::rm_correlation(&found, x, y)).drawn(picture)
        }
        Test::Normality { value, group: None } => {
            Ran::plainly(&tests::normality(&table.numbers(value)?)?)
        }
        Test::Normality {
            value,
            group: Some(group),
        } => {
            let (mut groups, mut said) = (Map::new(), Vec::new());
            for (name, values) in columns::grouped(table, group, value)? {
                let found = tests::normality(&values)?;
                said.extend(
                    found
                        .statements()
                        .into_iter()
                        .map(|(_, s)| (name.clone(), s)),
                );
                groups.insert(name, plain(&found));
            }
            Ran {
                said,
                ..Ran::numbers(json!({ "group": groups }))
            }
        }
        Test::Levene { group, value } => Ran::plainly(&tests::levene(
            &columns::labels(table, group)?,
            &table.numbers(value)?,
        )?),
        Test::Alpha { items, subject } => {
            let found: Result<Vec<_>, StudyError> = items
                .iter()
                .map(|item| Ok((item.as_str(), table.numbers(item)?)))
                .collect();
            let found = found?;
            let items: Vec<(&str, &[Option<f64>])> =
                found.iter().map(|(n, c)| (*n, c.as_slice())).collect();
            let people = subject
                .as_ref()
                .map(|s| columns::labels(table, s))
                .transpose()?;
            Ran::plainly(&tests::alpha(&items, people.as_deref())?)
        }
        Test::Adjust { p } => Ran::numbers(plain(&tests::adjust(&table.all_numbers(p)?)?)),
        Test::Bootstrap {
            resampled,
            resamples,
            seed,
        } => Ran::plainly(&bootstrap(table, resampled, *resamples, *seed)?),
        Test::Power => Ran::numbers(plain(&tests::power(&columns::power_questions(table)?)?)),
        Test::Recheck => Ran::numbers(plain(&tests::recheck(&columns::reported(table)?)?)),
        Test::Compare {
            columns,
            ordinal,
            missing,
        } => designs::compare(table, columns, *ordinal, *missing)?,
        Test::Factorial { columns, method } => {
            let rows = DesignRows::read(table, columns)?;
            let design = rows.design()?;
            match method {
                FactorialMethod::Anova => {
                    let found = tests::factorial(&design);
                    let picture = pictures::factorial(&rows, &columns.value, &found);
                    Ran::of(&found, printed::factorial(&found)).drawn(picture)
                }
                FactorialMethod::Art => {
                    let found = tests::aligned_ranks(&design);
                    let picture = pictures::aligned(&rows, &columns.value, &found);
                    let mut ran = Ran::of(&found, printed::aligned(&found)).drawn(picture);
                    // Kept in the JSON, and told on stderr.
                    ran.value["reasons"] = serde_json::json!([ALIGNED]);
                    ran.value["warnings"] = serde_json::json!([ALIGNED]);
                    ran
                }
            }
        }
        Test::Mixed {
            subject,
            fixed,
            value,
        } => designs::mixed(table, subject, fixed, value)?,
        Test::Ordinal(c) => {
            let people = columns::labels(table, &c.subject)?;
            let conditions = columns::labels(table, &c.within)?;
            let found = tests::ordinal(&people, &conditions, &table.numbers(&c.value)?)?;
            let rows = DesignRows::one_factor(table, Some(&c.subject), &c.within, &c.value)?;
            let picture = pictures::ordinal(&rows, &c.value, &found, None);
            Ran::of(&found, printed::ordinal(&found)).drawn(picture)
        }
        Test::Groups { group, value } => {
            let found = tests::groups(&columns::labels(table, group)?, &table.numbers(value)?)?;
            let rows = DesignRows::one_factor(table, None, group, value)?;
            let picture = pictures::groups(&rows, value, &found, None);
            Ran::of(&found, printed::groups(&found)).drawn(picture)
        }
        Test::Equivalence { columns: c, bounds } => {
            let found = tests::equivalence(&columns::within(table, c)?, *bounds)?;
            let picture = pictures::equivalence(&c.value, &found);
            Ran::of(&found, printed::equivalence(&found)).drawn(picture)
        }
        Test::EquivalenceOne { value, mu, bounds } => {
            let found = tests::equivalence_one(&table.numbers(value)?, *mu, *bounds)?;
            let picture = pictures::equivalence(value, &found);
            Ran::of(&found, printed::equivalence(&found)).drawn(picture)
        }
        Test::BayesPaired(c) => {
            let found = tests::bayes_paired(&columns::within(table, c)?);
            designs::bayes(table, &found, Some(&c.subject), &c.within, &c.value)?
        }
        Test::BayesOne { value, mu } => {
            Ran::plainly(&tests::bayes_one(&table.numbers(value)?, *mu)?)
        }
        Test::BayesGroups { group, value } => {
            let found =
                tests::bayes_groups(&columns::labels(table, group)?, &table.numbers(value)?)?;
            designs::bayes(table, &found, None, group, value)?
        }
        Test::BayesCorrelation { x, y } => {
            let (of_x, of_y) = (table.numbers(x)?, table.numbers(y)?);
            let found = tests::bayes_correlation(&of_x, &of_y)?;
            let said = pictures::first(&found);
            Ran::plainly(&found).drawn(pictures::correlation((x, &of_x), (y, &of_y), said))
        }
    })
}

/// What aligned ranks are not for: the rates of the table in the README of the statistics.
const ALIGNED: &str = "aligned ranks are for comparing with other programs: of effects that are nil they find .09 to .14 where values are skewed and up to .36 \
                       where people differ in an effect besides, and .05 are promised; `maveric stats compare` chooses tests that keep it";

fn bootstrap(
    table: &Table,
    resampled: &Resampled,
    resamples: usize,
    seed: u64,
) -> Result<Bootstrap, StudyError> {
    let settings = BootstrapSettings {
        resamples,
        seed,
        confidence: 1.0 - ALPHA,
    };
    Ok(match resampled {
        Resampled::Column { statistic, value } => {
            let values = table.numbers(value)?;
            tests::bootstrap(*statistic, BootstrapData::Values(&values), &settings)
        }
        Resampled::Pair { statistic, x, y } => {
            let (x, y) = (table.numbers(x)?, table.numbers(y)?);
            tests::bootstrap(*statistic, BootstrapData::Pairs(&x, &y), &settings)
        }
        Resampled::Design { statistic, columns } => {
            let data = columns::within(table, columns)?;
            tests::bootstrap(*statistic, BootstrapData::Within(&data), &settings)
        }
    }?)
}
