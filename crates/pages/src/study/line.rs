//! The aggression line, and how far the dial was turned along it.

use super::StudyPage;
use crate::{
    texts::value,
    words::{correlation, counted, short, with_unit},
};
use maveric_analysis::{AggressionLine as Line, LineRow};
use maveric_domain::{ConditionId, ConditionRow, design::Condition};
use maveric_report::{
    ReportError,
    figures::aggression_line::{AggressionLine, LinePanel},
    tables::Table,
};
use minijinja::context;

/// How far the dial moved people, condition by condition: how far each of them was moved, and how many were cut short by an end of the scale.
pub fn steps(
    design: &maveric_domain::Design,
    rows: &[ConditionRow],
) -> Vec<(ConditionId, Vec<f64>, usize)> {
    let turned = |c: &&Condition| c.side().is_some();
    let mut steps = Vec::new();
    for condition in design.conditions().iter().filter(turned) {
        let rows = || rows.iter().filter(|r| r.condition == condition.id);
        let moved: Vec<f64> = rows().filter_map(|r| r.moved_points).collect();
        if !moved.is_empty() {
            steps.push((condition.id, moved, rows().filter(|r| r.clamped).count()));
        }
    }
    steps
}

impl StudyPage<'_> {
    /// The position on the line against each measure, and how far the dial was turned.
    ///
    /// # Errors
    /// [`ReportError::Template`] for a text that asks for a value which is not given.
    pub fn line_tables(
        &self,
        line: &Line,
        rows: &[ConditionRow],
    ) -> Result<Vec<Table>, ReportError> {
        let row = |row: &LineRow| {
            let others = self.analysis.line_without_adb.as_ref();
            let other = others.and_then(|l| l.rows.iter().find(|r| r.measure == row.measure));
            let paper = self.printed(&format!("line.{}.r", short(&row.measure)));
            context! { without => value(&other.map(|r| &r.correlation)), paper, ..value(row) }
        };
        let people = counted(line.rows.iter().map(|row| row.correlation.n));
        let texts = self.texts.with(&context! { people });
        let mut tables = vec![texts.table("embedding-line", line.rows.iter().map(row))?];
        let row = |(condition, moved, clamped): (ConditionId, Vec<f64>, usize)| {
            let values: Vec<Option<f64>> = moved.iter().copied().map(Some).collect();
            let shape = maveric_stats::normality(&values).ok();
            context! {
                condition => condition.to_string(),
                meant => self.design.condition(condition).and_then(Condition::dial),
                n => moved.len(),
                clamped,
                shape => value(&shape.map(|shape| shape.desc)),
            }
        };
        let steps = steps(self.design, rows).into_iter().map(row);
        tables.extend(self.texts.table_if_any("dial-steps", steps)?);
        Ok(tables)
    }
}

/// The measures along the line, those that somebody has.
pub fn line_panels(line: &Line) -> AggressionLine {
    let panel = |row: &LineRow| LinePanel {
        title: row.title.clone(),
        axis: with_unit(&row.title, &row.unit),
        points: row.points.clone(),
        statistic: correlation(&row.correlation),
    };
    let drawn = line.rows.iter().filter(|r| !r.points.is_empty());
    AggressionLine { panels: drawn.map(panel).collect() }
}

#[cfg(test)]
mod tests {
    use crate::page_texts::{PageTexts, STUDY};
    use maveric_report::tables::Cell;
    use minijinja::{Value, context};

    fn texts(digits: usize, points: f64, within: f64) -> PageTexts {
        let label = Value::from_function(|id: &str| id.to_owned());
        let step = context! { points, within, clamped => 1, settings => 9 };
        let values =
            context! { style => "score", digits, label, step, space => true, along => true };
        PageTexts::new(STUDY, &values).unwrap()
    }

    #[test]
    fn a_step_is_said_in_whole_points_of_the_adb_and_in_decimals_of_a_narrow_scale() {
        let said = |texts: PageTexts| {
            let section = texts.section("embedding", Vec::new(), Vec::new());
            section.unwrap().intro.concat()
        };
        let adb = said(texts(0, 15.000_000_000_000_002, 6.1));
        assert!(
            adb.contains("A step of 15 points of the score is known to within 6 points"),
            "{adb}"
        );
        let narrow = said(texts(1, 1.7, 1.46));
        assert!(
            narrow.contains("A step of 1.7 points of the score is known to within 1.5 points"),
            "{narrow}"
        );
    }

    #[test]
    fn what_was_meant_is_written_as_finely_as_what_came_of_it_unless_it_is_whole() {
        let cells = |digits: usize, points: f64| {
            let shape = context! { mean => -points, sd => 0.5, min => -points, max => -points };
            let row =
                context! { condition => "calm", meant => -points, n => 3, clamped => 0, shape };
            let table = texts(digits, points, 1.0).table("dial-steps", [row]);
            let table = table.unwrap();
            let cells = &table.rows[0];
            (cells[1].clone(), cells[4].clone())
        };
        let points = |points: f64, decimals: usize| Cell::number(Some(points), decimals);
        assert_eq!(cells(0, 15.0), (points(-15.0, 0), points(-15.0, 1)));
        assert_eq!(cells(1, 1.7), (points(-1.7, 2), points(-1.7, 2)));
    }
}
