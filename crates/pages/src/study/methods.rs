//! How the study was done, in words, with the numbers that it was done with.

use super::StudyPage;
use crate::{orders::orders, preregistration::condition, texts::value};
use maveric_analysis::{ContrastTest, Panel};
use maveric_domain::design::Compare;
use maveric_report::ReportError;
use maveric_stats::{ByDesign, CarryOver, ChosenTest, MixedFinding, PERIOD};
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
        let factors = design.factors().iter().map(|f| design.factor_label(&f.name));
        let covariates = design.covariates().iter();
        let covariates = covariates.map(|c| design.factor_label(&c.column));
        let compared = || a.panels.iter().filter_map(|p| p.comparison.as_ref());
        // How contrasts were tested, of those that were.
        let tested = |test: ContrastTest| {
            let mut panels = a.panels.iter().filter(|p| p.test == Some(test));
            panels.any(|p| p.contrasts.iter().any(|c| c.p.is_some()))
        };
        let is_mixed = |is: fn(&MixedFinding) -> bool| {
            let mut mixed = compared();
            mixed.any(|f| matches!(f, ByDesign::Mixed(chosen) if is(&chosen.found)))
        };
        let (t, wilcoxon) = (tested(ContrastTest::T), tested(ContrastTest::Wilcoxon));
        let factorial = compared().any(|f| matches!(f, ByDesign::Factorial(_)));
        let groups = compared().any(|f| matches!(f, ByDesign::Groups(_)));
        // Pairs of more than two groups, by the test that was chosen of them.
        let pairs_of_groups = |chosen: ChosenTest| {
            compared().any(|f| matches!(f, ByDesign::Groups(groups) if groups.chosen == chosen))
        };
        let one_factor = compared().any(|f| f.one_factor().is_some_and(|c| c.k > 2));
        let correlations = !a.homophily.is_empty() || a.line.is_some();
        let bounded = a.hypotheses.iter().any(|h| h.bounds.is_some());
        let with_period = |f: &ByDesign| f.effects().iter().any(|(name, _)| *name == PERIOD);
        let of_everybody =
            |p: &Panel| p.group.is_none() && matches!(p.comparison, Some(ByDesign::Ordinal(_)));
        let (compare, against) = match design.compare() {
            Compare::All => ("all", None),
            Compare::Against(one) => ("against", Some(one.to_string())),
            Compare::Pairs(_) => ("pairs", None),
        };
        let (compare, against) = match design.baseline_id() {
            _ if !self.compares() => ("none", None),
            Some(baseline) if design.conditions().len() == 1 => {
                ("against", Some(baseline.to_string()))
            }
            _ => (compare, against),
        };
        context! {
            score => design.style().map(|style| style.label.as_str()),
            conditions => design.conditions().iter().map(condition).collect::<Vec<_>>(),
            factors => factors.collect::<Vec<_>>(),
            covariates => covariates.collect::<Vec<_>>(),
            of_levels => design.level_contrasts().len(),
            primary => self.primary_rows(),
            used => context! {
                factorial,
                simple => a.panels.iter().any(|p| p.by_factor.as_ref().is_some_and(|b| !b.simple.is_empty())),
                groups,
                games_howell => pairs_of_groups(ChosenTest::WelchAnova),
                dunn => pairs_of_groups(ChosenTest::KruskalWallis),
                mixed => compared().any(|f| matches!(f, ByDesign::Mixed(_))),
                by_level => compared().any(|f| matches!(f, ByDesign::Mixed(m) if !m.found.model.variance_by.is_empty())),
                ordinal => compared().any(|f| matches!(f, ByDesign::Ordinal(_))),
                unbounded => a.panels.iter().flat_map(|p| &p.contrasts).any(|c| c.unbounded),
                ordinal_of_groups => !a.panels.iter().any(of_everybody),
                ranks_beside => compared().any(|f| matches!(f, ByDesign::Ordinal(o) if o.found.beside.is_some())),
                one_factor,
                t,
                wilcoxon,
                normality => factorial || groups || one_factor || t || wilcoxon || correlations,
                epsilon => one_factor || is_mixed(|found| !found.corrected.is_empty()),
                own_error => is_mixed(|found| !found.own_error.is_empty()),
                equivalence => bounded || a.reproduction.iter().any(|r| r.bias.is_some()),
                accuracy => a.reproduction.iter().any(|r| r.mean.is_some()),
                nearer => a.nearer.iter().any(|n| n.p_holm.is_some()),
                angle => a.kept.iter().any(|k| k.circular_r.is_some()),
                shift => a.mixed.iter().any(|m| m.model.is_some()),
                period => compared().any(with_period),
                carry_over => a.panels.iter().any(|p| matches!(p.carry_over, Some(CarryOver::Fitted(_)))),
                worlds_by_ride => self.worlds_by_ride(),
            },
            compare,
            against,
            pairs => value(&design.contrasts()),
            correlations,
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
        let texts =
            self.methods.with(&context! { by_car => by_car.clone(), recorded => recorded.clone() });
        let asked = a.panels.iter().any(|p| !p.measured);
        let (mut did, mut of_some) = (Vec::new(), Vec::new());
        for (wanted, key, without) in [
            (self.design.baseline().is_some(), "did_baseline", a.without_baseline.len()),
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
        of_tests_beside(used, primary, &[])
    }

    fn of_tests_beside(used: &Value, primary: &[Value], covariates: &[&str]) -> String {
        let none = context! {
            factorial => false, simple => false, groups => false, games_howell => false, dunn => false, mixed => false, by_level => false, ordinal => false, ordinal_of_groups => false,
            ranks_beside => false, unbounded => false, one_factor => false, t => false,
            wilcoxon => false, period => false, carry_over => false, worlds_by_ride => false, normality => false, epsilon => false,
            own_error => false, equivalence => false, accuracy => false, nearer => false, angle => false, shift => false,
        };
        let used = context! { ..used.clone(), ..none };
        said(
            "tests",
            &context! { used, primary, covariates => crate::texts::value(&covariates), factors => crate::texts::value(&["Road"]), of_levels => 0, compare => "all", correlations => false,
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
        assert!(!all.contains("nothing counts"), "{all}");
        let some = did(1);
        assert!(some.starts_with("The 24 participants"), "{some}");
        assert!(some.ends_with("; of 1 of them nothing counts in some condition."), "{some}");
    }

    #[test]
    fn where_a_mixed_model_tests_its_terms_is_told_beside_covariates_alone() {
        let mixed = context! { mixed => true };
        let means = "tested at the mean of each covariate";
        assert!(of_tests_beside(&mixed, &[], &["Age"]).contains(means));
        assert!(!of_tests(&mixed, &[]).contains(means));
        let factorial = context! { factorial => true };
        assert!(!of_tests_beside(&factorial, &[], &["Age"]).contains(means));
    }

    #[test]
    fn pairs_of_groups_are_told_with_the_tests_that_they_had() {
        let said = |games_howell: bool, dunn: bool| {
            let used = context! { groups => true, games_howell, dunn };
            of_tests(&used, &[])
        };
        let two = said(false, false);
        assert!(two.contains("they are not normal. ") && !two.contains("pairs"), "{two}");
        let howell = said(true, false);
        assert!(howell.contains("normal; pairs of groups after Games and Howell. "), "{howell}");
        let both = said(true, true);
        assert!(
            both.contains("after Games and Howell, or by Dunn’s test, *p* adjusted after Holm"),
            "{both}"
        );
        assert!(said(false, true).contains("; pairs of groups by Dunn’s test"));
    }

    #[test]
    fn odds_without_bound_are_told_where_there_are_any_and_nowhere_else() {
        let ordinal = of_tests(&context! { ordinal => true }, &[]);
        assert!(!ordinal.contains("without bound"), "{ordinal}");
        let floor = of_tests(&context! { ordinal => true, unbounded => true }, &[]);
        assert!(floor.contains("without bound, by the likelihood ratio"), "{floor}");
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
    fn a_model_of_ordered_answers_says_of_whom_it_is_and_names_ranks_that_stand_beside_it() {
        let said = |ordinal_of_groups: bool, ranks_beside: bool| {
            let used = context! { ordinal => true, ordinal_of_groups, ranks_beside };
            of_tests(&used, &[])
        };
        let alone = said(false, false);
        assert!(
            alone.starts_with("Ratings of one item, whose answers have an order alone, by a cumulative logit model with a random intercept of the person. "),
            "{alone}"
        );
        let groups = said(true, true);
        assert!(
            groups.contains("an order alone, within groups of people, by a cumulative logit")
                && groups.contains("; the rank tests stand beside it. "),
            "{groups}"
        );
    }

    #[test]
    fn the_variances_of_a_mixed_model_are_those_that_it_has() {
        let each = "of the person at each level of each factor";
        let said = |by_level: bool| {
            let used = context! { mixed => true, period => true, by_level };
            of_tests(&used, &[])
        };
        assert!(said(true).contains(each) && !said(false).contains(each));
    }

    #[test]
    fn only_tests_that_were_run_are_named() {
        assert!(tests(true, false).starts_with("Contrasts by paired t tests. Compared are every"));
        assert!(
            !tests(false, true).contains("t tests") && tests(false, true).contains("signed ranks")
        );
        let both = tests(true, true);
        assert!(both.contains("paired t tests") && both.contains("signed ranks"), "{both}");
        assert!(tests(false, false).starts_with("Compared are"));
    }

    #[test]
    fn what_results_rest_on_is_named_where_it_was_done_and_nowhere_else() {
        let plain = of_tests(&context! {}, &[]);
        for (used, said) in [
            (context! { equivalence => true }, "two one-sided *t* tests (Schuirmann)"),
            (context! { accuracy => true }, "1 − |car − person| / person"),
            (context! { nearer => true }, "signed ranks of the two distances"),
            (context! { angle => true }, "cosine and sine"),
            (context! { shift => true }, "random intercept and slope"),
            (context! { normality => true }, "Shapiro and Wilk’s test"),
            (context! { own_error => true }, "Bell and McCaffrey’s degrees of freedom"),
        ] {
            assert!(!plain.contains(said), "{plain}");
            let told = of_tests(&used, &[]);
            assert!(told.contains(said), "{said} in {told}");
        }
        let period = of_tests(&context! { period => true }, &[]);
        assert!(!period.contains("McCaffrey"), "{period}");
    }

    #[test]
    fn people_are_told_with_what_is_known_of_them() {
        let group = |mean_age: Option<f64>, female: Option<f64>| {
            let values = context! { group => "Tested", n => 24, mean_age, sd_age => mean_age.map(|_| 8.04), female };
            said("group", &values)
        };
        assert_eq!(
            group(Some(34.5), Some(0.5)),
            "Tested: *n* = 24, age *M* = 34.5, *SD* = 8.0 years, 50.0% female."
        );
        assert_eq!(group(None, None), "Tested: *n* = 24.");
    }

    #[test]
    fn where_patience_is_0_people_kept_back_decided_nothing_and_the_page_says_so() {
        let learned = |patience: usize| {
            let settings =
                context! { window_s => 4.0, window_rate_hz => 2.5, batch_size => 8, patience };
            let networks = context! { epochs => vec![1, 2], rows => 10, selection => context! { people => 120 } };
            said("learning", &context! { training => context! { settings, networks, seed => 1 } })
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
        assert_eq!(some, "As far as there are data, 10 of these people drove by hand.");
    }

    #[test]
    fn who_lacks_a_value_an_order_or_a_column_are_told_apart() {
        let out = |counts: &[(&str, usize)]| {
            let part =
                |(key, people): &(&str, usize)| said(key, &context! { people, column => "Age" });
            let parts: Vec<String> = counts.iter().map(part).collect();
            let dropped: usize = counts.iter().map(|(_, people)| people).sum();
            let values = context! { title => "Speed", parts, dropped, n => 7 };
            said("incomplete", &values)
        };
        assert_eq!(
            out(&[("lacking", 1)]),
            "Speed: 1 person without a value in every condition is not in the tests; *n* = 7 in them."
        );
        assert_eq!(
            out(&[("unordered", 4)]),
            "Speed: 4 people whose order of the conditions is not known are not in the tests; *n* = 7 in them."
        );
        assert!(out(&[("lacking", 1), ("unordered", 4), ("without_column", 2)]).contains(
            "1 person without a value in every condition, 4 people whose order of the conditions is not known and 2 people without a value of Age are not"
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
