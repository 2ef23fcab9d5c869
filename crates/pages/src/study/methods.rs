//! How the study was done, in words, with the numbers that it was done with.

use super::StudyPage;
use crate::{orders::orders, preregistration::condition, texts::value};
use maveric_analysis::ContrastTest;
use maveric_domain::design::Compare;
use maveric_report::ReportError;
use maveric_stats::{ByDesign, CarryOver, PERIOD};
use minijinja::{Value, context};

/// A paragraph with what it is about; of a note that is nothing.
pub type Paragraph = (&'static str, String);

impl StudyPage<'_> {
    /// The paragraphs as the page has them.
    pub fn methods_on_page(&self) -> Result<Vec<String>, ReportError> {
        let one = |(about, text): Paragraph| match about {
            "" => text,
            about => format!("*{about}.* {text}"),
        };
        Ok(self.methods()?.into_iter().map(one).collect())
    }

    /// How the study was done, a paragraph each.
    ///
    /// # Errors
    /// [`ReportError::Template`] for a text that asks for a value which is not given.
    pub fn methods(&self) -> Result<Vec<Paragraph>, ReportError> {
        let given = |key: &str| self.methods.is_given(key);
        let texts = self.methods.with(&self.method_values());
        let mut paragraphs = Vec::new();
        for (wanted, about, key) in [
            (given("road"), "Driving", "driving"),
            (given("training"), "Learning", "learning"),
            (given("embedding_size"), "Personalising", "personalising"),
            (true, "Conditions", "conditions"),
            (true, "Tests", "tests"),
        ] {
            if wanted {
                paragraphs.push((about, texts.text(key)?));
            }
        }
        if let Some(balance) = &self.analysis.orders {
            let sentences = orders(self.design, balance)?;
            paragraphs.push(("Orders", sentences.join(" ")));
        }
        paragraphs.extend(self.analysis.notes.iter().map(|note| ("", note.clone())));
        if self.analysis.synthetic {
            paragraphs.push(("Participants", texts.text("participants")?));
        }
        Ok(paragraphs)
    }

    pub(super) fn method_values(&self) -> Value {
        let (design, a) = (self.design, self.analysis);
        let factors = design
            .factors()
            .iter()
            .map(|f| design.factor_label(&f.name));
        let covariates = design.covariates().iter();
        let covariates = covariates.map(|c| design.factor_label(&c.column));
        let compared = || a.panels.iter().filter_map(|p| p.comparison.as_ref());
        // How contrasts were tested, of those that were.
        let tested = |test: ContrastTest| {
            let mut panels = a.panels.iter().filter(|p| p.test == Some(test));
            panels.any(|p| p.contrasts.iter().any(|c| c.p.is_some()))
        };
        let with_period = |f: &ByDesign| f.effects().iter().any(|(name, _)| *name == PERIOD);
        let (compare, against) = match design.compare() {
            Compare::All => ("all", None),
            Compare::Against(one) => ("against", Some(one.to_string())),
            Compare::Pairs(_) => ("pairs", None),
        };
        context! {
            score => design.style().map(|style| style.label.as_str()),
            conditions => design.conditions().iter().map(condition).collect::<Vec<_>>(),
            factors => factors.collect::<Vec<_>>(),
            covariates => covariates.collect::<Vec<_>>(),
            of_levels => design.level_contrasts().len(),
            primary => self.primary_rows(),
            used => context! {
                factorial => compared().any(|f| matches!(f, ByDesign::Factorial(_))),
                simple => a.panels.iter().any(|p| p.by_factor.is_some()),
                groups => compared().any(|f| matches!(f, ByDesign::Groups(_))),
                mixed => compared().any(|f| matches!(f, ByDesign::Mixed(_))),
                ordinal => compared().any(|f| matches!(f, ByDesign::Ordinal(_))),
                one_factor => compared().any(|f| f.one_factor().is_some_and(|c| c.k > 2)),
                t => tested(ContrastTest::T),
                wilcoxon => tested(ContrastTest::Wilcoxon),
                period => compared().any(with_period),
                carry_over => a.panels.iter().any(|p| matches!(p.carry_over, Some(CarryOver::Fitted(_)))),
                worlds_by_ride => self.worlds_by_ride(),
            },
            compare,
            against,
            pairs => value(&design.contrasts()),
            correlations => !a.homophily.is_empty() || a.line.is_some(),
        }
    }

    /// What was done with whom.
    pub(super) fn done(&self) -> Result<String, ReportError> {
        let (a, conditions) = (self.analysis, self.design.conditions());
        let labels = |by_car: bool| -> Vec<String> {
            let matching = conditions.iter().filter(|c| c.car.is_some() == by_car);
            matching.map(|c| self.label(c.id)).collect()
        };
        let (by_car, recorded) = (labels(true), labels(false));
        let texts = self
            .methods
            .with(&context! { by_car => by_car.clone(), recorded => recorded.clone() });
        let asked = a.panels.iter().any(|p| !p.measured);
        let (mut did, mut of_some) = (Vec::new(), Vec::new());
        for (wanted, key, without) in [
            (
                self.design.baseline().is_some(),
                "did_baseline",
                a.without_baseline.len(),
            ),
            (!by_car.is_empty(), "did_ride", 0),
            (!recorded.is_empty(), "did_recorded", 0),
            (asked, "did_answer", a.without_answer.len()),
        ] {
            let n = a.participants.saturating_sub(without);
            if !wanted || n == 0 {
                continue;
            }
            let what = texts.text(key)?;
            if without == 0 {
                did.push(what);
            } else {
                let values = context! { n, what };
                of_some.push(texts.with(&values).text("did_some")?);
            }
        }
        let mut sentences = Vec::new();
        if self.methods.is_given("training") {
            sentences.push(texts.text("learned")?);
        } else if self.methods.is_given("embedding_size") {
            sentences.push(texts.text("learned_elsewhere")?);
        }
        let partly = a.partly.len();
        sentences.push(texts.with(&context! { did, partly }).text("did")?);
        let out: usize = a.flow.left_out.iter().map(|l| l.who.len()).sum();
        sentences.extend(of_some);
        if out > 0 {
            let reasons = a.flow.left_out.iter().map(|l| texts.with(l).text("reason"));
            let reasons = reasons.collect::<Result<Vec<_>, _>>()?;
            let values = context! { recruited => a.flow.recruited, out, reasons };
            sentences.push(texts.with(&values).text("left_out")?);
        }
        Ok(sentences.join(" "))
    }
}

#[cfg(test)]
mod tests {
    use crate::{METHODS, PageTexts};
    use maveric_domain::SpeedUnit;
    use minijinja::{Value, context};

    fn said(key: &str, values: &Value) -> String {
        PageTexts::new(METHODS, values).unwrap().text(key).unwrap()
    }

    /// The paragraph on tests, where nothing but contrasts was tested but for what is given.
    fn of_tests(used: &Value, primary: &[Value]) -> String {
        let none = context! {
            factorial => false, simple => false, groups => false, mixed => false, ordinal => false, one_factor => false, t => false,
            wilcoxon => false, period => false, carry_over => false, worlds_by_ride => false,
        };
        let used = context! { ..used.clone(), ..none };
        said(
            "tests",
            &context! { used, primary, covariates => Vec::<String>::new(), of_levels => 0, compare => "all", correlations => false,
            label => Value::from_function(|id: &str| id.to_owned()) },
        )
    }

    fn tests(t: bool, wilcoxon: bool) -> String {
        of_tests(&context! { t, wilcoxon }, &[])
    }

    #[test]
    fn that_each_did_all_is_said_where_each_did() {
        let did = |partly: usize| {
            let did: Vec<String> = ["drove", "sat through A and B"].map(str::to_owned).to_vec();
            said("did", &context! { participants => 24, did, partly })
        };
        let all = did(0);
        assert!(all.starts_with("Each of the 24 participants"), "{all}");
        assert!(!all.contains("not in every"), "{all}");
        let some = did(1);
        assert!(some.starts_with("The 24 participants"), "{some}");
        assert!(
            some.ends_with(", 1 of them not in every condition."),
            "{some}"
        );
    }

    #[test]
    fn the_period_and_primary_outcomes_are_told_where_they_are_and_nowhere_else() {
        let plain = tests(true, false);
        for word in ["Primary", "period", "carry-over"] {
            assert!(!plain.contains(word), "{plain}");
        }
        let used = context! { mixed => true, period => true, carry_over => true };
        assert!(!of_tests(&used, &[]).contains("world"));
        let by_ride = of_tests(&context! { worlds_by_ride => true, ..used.clone() }, &[]);
        assert!(
            by_ride.contains("whatever its *p*") && by_ride.contains("cannot be told apart"),
            "{by_ride}"
        );
        // Where no period is tested nothing is said of what it is one with.
        assert!(!of_tests(&context! { worlds_by_ride => true }, &[]).contains("world"));
        let primary = |title: &str| context! { title, first => "sporty", second => "calm", declared => "a mixed model" };
        let one = of_tests(&used, &[primary("Trust")]);
        assert!(
            one.starts_with("Primary, as declared: Trust (sporty − calm) by a mixed model. "),
            "{one}"
        );
        assert!(
            one.contains("whatever its *p*") && one.contains("carry-over was looked at"),
            "{one}"
        );
        // Nobody's covariate was taken out.
        assert!(!one.contains("take out the influence"), "{one}");
        let two = of_tests(&used, &[primary("Trust"), primary("Comfort")]);
        assert!(two.contains("tested in this order, each at .05"), "{two}");
    }

    #[test]
    fn only_tests_that_were_run_are_named() {
        assert!(tests(true, false).starts_with("Contrasts by paired t tests. Compared are every"));
        assert!(
            !tests(false, true).contains("t tests") && tests(false, true).contains("signed ranks")
        );
        let both = tests(true, true);
        assert!(
            both.contains("paired t tests") && both.contains("signed ranks"),
            "{both}"
        );
        assert!(tests(false, false).starts_with("Compared are"));
    }

    #[test]
    fn where_patience_is_0_people_kept_back_decided_nothing_and_the_page_says_so() {
        let learned = |patience: usize| {
            let settings =
                context! { window_s => 4.0, window_rate_hz => 2.5, batch_size => 8, patience };
            let networks = context! { epochs => vec![1, 2], rows => 10, selection => context! { people => 120 } };
            said(
                "learning",
                &context! { training => context! { settings, networks, seed => 1 } },
            )
        };
        assert!(learned(0).contains("decided nothing"));
        assert!(learned(5).contains("was chosen on 120 people kept back"));
        assert!(
            learned(5).starts_with(
                "The paper’s networks: windows of 4 s at 2.5 Hz; 2 passes over 10 rows"
            )
        );
    }

    #[test]
    fn what_some_did_alone_is_said_of_them_alone() {
        let some = said("did_some", &context! { n => 10, what => "drove by hand" });
        assert_eq!(
            some,
            "As far as there are data, 10 of these people drove by hand."
        );
    }

    #[test]
    fn who_lacks_a_value_and_whose_order_is_not_known_are_told_apart() {
        let out = |lacking: usize, unordered: usize| {
            said(
                "incomplete",
                &context! { title => "Speed", lacking, unordered, n => 7 },
            )
        };
        assert_eq!(
            out(1, 0),
            "Speed: 1 person without a value in every condition is not in the tests; *n* = 7 in them."
        );
        assert_eq!(
            out(0, 4),
            "Speed: 4 people whose order of the conditions is not known are not in the tests; *n* = 7 in them."
        );
        assert!(out(1, 4).contains(
            "1 person without a value in every condition and 4 people whose order of the conditions is not known are not"
        ));
    }

    #[test]
    fn one_minute_is_no_plural_and_a_road_says_its_lanes() {
        let driven = |minutes: Option<f64>| {
            let road = context! { lanes => 2, lane_width_m => 3.66 };
            said(
                "driving",
                &context! {
                    road, posted_mps => 24.5872, minutes, by_hand => true,
                    speed => context! { unit => "mph", per_mps => SpeedUnit::Mph.per_mps() },
                },
            )
        };
        assert_eq!(
            driven(Some(0.999)),
            "2 lanes of 3.66 m in one direction, posted 55 mph, 1 minute a drive by hand."
        );
        assert!(driven(Some(5.999)).contains("6 minutes a drive by hand"));
        assert!(driven(Some(89.9 / 60.0)).contains(" 1.5 minutes a drive by hand"));
        assert!(driven(None).ends_with("55 mph."));
    }
}
