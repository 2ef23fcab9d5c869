//! What people pressed during the rides, and what the ride was like before.

use super::StudyPage;
use crate::words::{label_of_id, with_unit};
use maveric_analysis::{BeforePress, FEWEST_PEOPLE, FEWEST_PRESSES, PressCourse, Presses};
use maveric_report::{
    ReportError,
    figures::press_course::{CoursePanel, PressCourses, press_course},
    html::Section,
    tables::Table,
};
use maveric_stats::EventRates;
use minijinja::{Value, context};

impl StudyPage<'_> {
    /// `None` where nothing could be pressed.
    ///
    /// # Errors
    /// [`ReportError`] for a figure that cannot be drawn, or a text that asks for a value which is not given.
    pub fn presses(&self) -> Result<Option<Section>, ReportError> {
        let Some(presses) = &self.analysis.presses else {
            return Ok(None);
        };
        let values = context! {
            presses => presses.presses,
            people => presses.people,
            tested => !presses.before.is_empty(),
            fewest_people => FEWEST_PEOPLE,
            fewest_presses => FEWEST_PRESSES,
            rates => presses.rates.as_ref().map(|rates| context! {
                n => rates.n,
                never => rates.never,
                chi2 => rates.chi2,
                df => rates.df,
                p => rates.p,
                friedman => rates.friedman.as_ref().and_then(|f| f.p_exact.or(f.p)),
            }),
            incomplete => presses.incomplete.len(),
        };
        let texts = self.texts.with(&values);
        let mut figures = Vec::new();
        // What never happened has no course.
        let varies = |c: &&PressCourse| c.points.iter().any(|p| Some(p.mean) != c.others);
        let drawn = presses.course.iter().filter(varies);
        let panels: Vec<CoursePanel> = drawn.map(|c| course(presses, c)).collect();
        if !panels.is_empty() {
            let input = PressCourses { panels, presses: presses.presses };
            figures.push(press_course(&input, self.context)?);
        }
        let mut tables = Vec::new();
        if let Some(rates) = &presses.rates {
            tables.push(self.press_rates(rates)?);
        }
        let rows = presses.before.iter().map(before);
        tables.extend(texts.table_if_any("before-press", rows)?);
        texts.section("presses", figures, tables).map(Some)
    }

    fn press_rates(&self, rates: &EventRates) -> Result<Table, ReportError> {
        let rows = rates.rate.iter().map(|(id, rate)| {
            context! {
                condition => id,
                label => label_of_id(self.design, id),
                presses => rates.events.get(id),
                minutes => rates.time.get(id),
                rate,
            }
        });
        self.texts.table("press-rates", rows)
    }
}

fn before(row: &BeforePress) -> Value {
    let test = &row.test;
    context! {
        precursor => row.precursor.as_str(),
        title => row.title.as_str(),
        unit => row.unit.as_str(),
        people => test.people,
        presses => test.events,
        sd => test.sd,
        odds_ratio => test.odds_ratio,
        low => test.odds_ratio_ci.low,
        high => test.odds_ratio_ci.high,
        t => test.t,
        df => test.df,
        p => test.p,
        p_holm => row.p_holm,
        missing => row.missing,
    }
}

fn course(presses: &Presses, course: &PressCourse) -> CoursePanel {
    let mut tested = presses.before.iter();
    let tested = tested.find(|row| row.precursor == course.precursor);
    let p = tested.and_then(|row| row.p_holm);
    let near_last = course.points.iter().rev();
    CoursePanel {
        title: course.title.clone(),
        test: p.map_or_else(String::new, |p| maveric_stats::apa::p_holm(p).markup().to_owned()),
        axis: match course.unit.as_str() {
            "" => "Share of the time".to_owned(),
            unit => with_unit("Value", unit),
        },
        n: course.n,
        points: near_last
            .map(|point| {
                let (low, high) = point.interval.unwrap_or((point.mean, point.mean));
                [f64::from(point.before_s), point.mean, low, high]
            })
            .collect(),
        others: course.others,
    }
}
