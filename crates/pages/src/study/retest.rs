//! Several rides in a condition, and a second session.

use super::StudyPage;
use crate::words::in_unit_of;
use maveric_analysis::{FEWEST_FOR_ICC, Retest, RidesCounted};
use maveric_domain::{
    Design,
    design::{Car, Condition, ProtocolStep},
};
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
            styled => takes_own_style(self.design),
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

    /// The rows of the second session that have a coefficient; none where there was one session alone.
    pub(super) fn retested(&self) -> impl Iterator<Item = Value> {
        let rows = self.analysis.repeats.iter().flat_map(|r| &r.retest);
        let rows = rows.filter(|row| row.icc.as_ref().is_some_and(|icc| icc.icc.is_some()));
        rows.map(move |row| self.retest(row))
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
            ..in_unit_of(self.analysis, &row.outcome)
        }
    }
}

/// Whether a car takes the person's own style, which is that of a drive by hand.
fn takes_own_style(design: &Design) -> bool {
    let takes = |c: &Condition| matches!(c.car, Some(Car::Dial(_) | Car::Across | Car::Free));
    let drives = design.protocol().steps.contains(&ProtocolStep::Drive);
    drives && design.conditions().iter().any(takes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_style_of_a_drive_by_hand_is_told_where_a_car_takes_it() {
        let of = |[one, other]: [&str; 2]| {
            let text = format!(
                "[study]\ntitle = \"t\"\n[people]\nlearn = {{ part = \"learn\" }}\n[style]\nscore = \"adb.total\"\npoints = 15\n\
                 [baseline]\nid = \"own\"\n[[condition]]\nid = \"a\"\ncar = {one}\n[[condition]]\nid = \"b\"\ncar = {other}\n"
            );
            takes_own_style(&Design::from_toml(&text).unwrap())
        };
        let given = "{ embedding = \"styles.csv\" }";
        assert!(of(["{ dial = 0 }", "{ mean = true }"]));
        assert!(!of(["{ mean = true }", given]));
    }
}
