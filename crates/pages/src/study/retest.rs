//! Several rides in a condition, and a second session.

use super::StudyPage;
use maveric_analysis::{FEWEST_FOR_ICC, Retest, RidesCounted};
use maveric_report::{ReportError, html::Section};
use minijinja::{Value, context};

impl StudyPage<'_> {
    /// `None` where the design has one session with one ride in each condition.
    ///
    /// # Errors
    /// [`ReportError`] for a text that asks for a value which is not given.
    pub fn repeats(&self) -> Result<Option<Section>, ReportError> {
        let Some(repeats) = &self.analysis.repeats else {
            return Ok(None);
        };
        let protocol = self.design.protocol();
        let values = context! {
            trials => protocol.rides_per_condition,
            sessions => protocol.session_count(),
            days => protocol.sessions.as_ref().map(|sessions| sessions.days_between),
            back => repeats.back,
            gone => repeats.gone,
            fewest => FEWEST_FOR_ICC,
        };
        let texts = self.texts.with(&values);
        let mut tables = Vec::new();
        let rides = |row: &RidesCounted| {
            context! {
                condition => row.condition.as_str(),
                label => self.label(row.condition),
                whole => row.whole,
                fewer => row.fewer,
                rides => row.rides,
            }
        };
        tables.extend(texts.table_if_any("rides", repeats.rides.iter().map(rides))?);
        let rows = repeats.retest.iter().map(|row| self.retest(row));
        tables.extend(texts.table_if_any("retest", rows)?);
        texts.section("repeats", Vec::new(), tables).map(Some)
    }

    fn retest(&self, row: &Retest) -> Value {
        let icc = row.icc.as_ref();
        context! {
            condition => row.condition.as_str(),
            label => self.label(row.condition),
            outcome => row.outcome.as_str(),
            title => row.title.as_str(),
            unit => row.unit.as_str(),
            n => row.n,
            icc => icc.and_then(|icc| icc.icc),
            low => icc.and_then(|icc| icc.ci.low),
            high => icc.and_then(|icc| icc.ci.high),
            sem => icc.map(|icc| icc.sem),
            sdc => icc.map(|icc| icc.sdc),
            few => if row.n < FEWEST_FOR_ICC { "too few for a coefficient" } else { "" },
            mean_back => row.mean_back,
            gone => row.gone,
            mean_gone => row.mean_gone,
        }
    }
}
