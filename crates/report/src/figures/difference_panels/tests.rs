use super::*;

fn panel(rows: Vec<Vec<Option<f64>>>) -> DifferencePanels {
    let id = |text: &str| ConditionId::new(text).unwrap();
    let conditions = ["same", "faster", "slower", "sideways"].map(id);
    let pair =
        |second| PairTest { first: conditions[0], second, p_holm: 0.0004, effect: Some(1.25) };
    DifferencePanels {
        panels: vec![DifferencePanel {
            title: "Mean velocity".into(),
            axis: "Difference (mph)".into(),
            conditions: conditions.to_vec(),
            rows,
            omnibus: "*F*(3, 69) = 25.23".into(),
            pairs: conditions[1..].iter().copied().map(pair).collect(),
            reference: Some(0.0),
            range: None,
            of_group: false,
        }],
        from: Some(id("own")),
        part: None,
    }
}

fn rows(n: usize) -> Vec<Vec<Option<f64>>> {
    (0..n).map(|i| (0..4).map(|j| Some(((i * 7 + j * 3) % 11) as f64 - 5.0)).collect()).collect()
}

#[test]
fn a_missing_cell_leaves_its_participant_out_of_the_means_and_says_so() {
    let mut rows = rows(6);
    rows[2][1] = None;
    let figure = difference_panels(&panel(rows), &Context::synthetic(1)).unwrap();
    assert!(figure.caption.contains("*n* = 6 participants, of whom 5"));
    assert!(figure.caption.ends_with("Synthetic participants."));
    assert!(figure.svg.contains("synthetic participants</text>"));
    assert!(figure.svg.contains(">1.25***</text>"));
}

#[test]
fn means_in_words_have_as_many_decimals_as_people_need_to_differ() {
    let said = |factor: f64| {
        let mut rows = rows(6);
        for value in rows.iter_mut().flatten().flatten() {
            *value *= factor;
        }
        difference_panels(&panel(rows), &Context::real()).unwrap().alt
    };
    // Of decimals the most that any number of the words has.
    let most = |said: &str| {
        let numbers = said.split(|c: char| !c.is_ascii_digit() && c != '.');
        let decimals = numbers
            .filter_map(|number| Some(number.trim_end_matches('.').split_once('.')?.1.len()));
        decimals.max()
    };
    let [wide, narrow] = [said(1.0), said(0.001)];
    assert_eq!(most(&wide), Some(2), "{wide}");
    assert_eq!(most(&narrow), Some(4), "{narrow}");
}

#[test]
fn the_caption_says_what_the_brackets_carry_and_of_which_family_their_p_is() {
    let said = |change: &dyn Fn(&mut DifferencePanels)| {
        let mut input = panel(rows(6));
        change(&mut input);
        difference_panels(&input, &Context::real()).unwrap().caption
    };
    let bare = |input: &mut DifferencePanels, at: usize| {
        for pair in &mut input.panels[at].pairs {
            pair.effect = None;
        }
    };
    let second = |input: &mut DifferencePanels| {
        input.panels.push(input.panels[0].clone());
        input.panels[1].of_group = true;
    };
    let sizes = said(&|_| ());
    assert!(sizes.contains("carry effect sizes") && !sizes.contains("itself"));
    assert!(sizes.contains("after Holm over the contrasts of that panel ("));
    let without = said(&|input| bare(input, 0));
    assert!(without.contains("Brackets carry *p* after Holm over the contrasts of that panel."));
    let both = said(&|input| {
        second(input);
        bare(input, 1);
    });
    assert!(both.contains("; *p* itself where there is no effect size."));
    assert!(
        both.contains("of that panel, in a panel of one group of people over those of all groups"),
        "{both}"
    );
    let groups = said(&|input| {
        second(input);
        input.panels.remove(0);
    });
    assert!(groups.contains("over the contrasts of all groups of people for the outcome ("));
    let none = said(&|input| input.panels[0].pairs.clear());
    assert!(none.contains("Contrasts stand in their table."));
}

#[test]
fn a_value_that_is_not_a_number_is_refused() {
    let mut rows = rows(6);
    rows[2][1] = Some(f64::NAN);
    let refused = difference_panels(&panel(rows), &Context::real());
    assert!(matches!(refused, Err(ReportError::NotFinite { .. })));
}

#[test]
fn equal_values_and_a_single_participant_still_make_a_picture() {
    let same = panel(vec![vec![Some(0.0); 4]; 5]);
    assert!(difference_panels(&same, &Context::real()).is_ok());
    let one = panel(vec![vec![Some(1.0), Some(2.0), Some(3.0), Some(4.0)]]);
    assert!(difference_panels(&one, &Context::real()).is_ok());
}

#[test]
fn a_condition_without_values_says_so_in_picture_and_caption() {
    let mut rows = rows(6);
    for row in &mut rows {
        row[2] = None;
    }
    let figure = difference_panels(&panel(rows), &Context::real()).unwrap();
    assert!(figure.svg.contains(">no values</text>"));
    let said = "Nobody has a value of Mean velocity in Slower.";
    assert!(figure.caption.contains(said), "{}", figure.caption);
}

#[test]
fn a_figure_grows_with_the_lines_of_its_titles() {
    let height = |title: &str| {
        let mut input = panel(rows(6));
        input.panels[0].title = title.to_owned();
        let svg = difference_panels(&input, &Context::real()).unwrap().svg;
        let (_, after) = svg.split_once(" height=\"").unwrap();
        after.split_once("mm").unwrap().0.parse::<f64>().unwrap()
    };
    assert!((height("Mean velocity") - 67.0).abs() < 0.01);
    assert!(height(&["Mean velocity"; 8].join(" ")) > 70.0);
}

#[test]
fn more_panels_than_a_page_holds_are_parts_with_names_of_their_own() {
    let mut many = panel(rows(6));
    many.panels = vec![many.panels[0].clone(); 9];
    assert_eq!(many.clone().parts(), [many.clone()]);
    many.panels.push(many.panels[0].clone());
    let parts = many.parts();
    let panels: Vec<usize> = parts.iter().map(|part| part.panels.len()).collect();
    assert_eq!(panels, [6, 4]);
    let drawn = parts.iter().map(|p| difference_panels(p, &Context::real()));
    let drawn: Vec<Figure> = drawn.map(Result::unwrap).collect();
    assert_eq!(drawn[0].name, "difference-panels");
    assert_eq!(drawn[1].name, "difference-panels-2");
    assert!(drawn[1].title.ends_with(", part 2 of 2"));
}

#[test]
fn ten_thousand_participants_make_no_ten_thousand_points() {
    let figure = difference_panels(&panel(rows(10_000)), &Context::real()).unwrap();
    assert!(figure.svg.len() < 60_000);
}

#[test]
fn one_condition_has_its_mean_with_an_interval_of_its_own_and_no_words_of_several() {
    let figure = |conditions: usize| {
        let mut input = panel(rows(6));
        let only = &mut input.panels[0];
        only.conditions.truncate(conditions);
        only.pairs.clear();
        for row in &mut only.rows {
            row.truncate(conditions);
        }
        assert!(means(only).iter().all(Option::is_some));
        difference_panels(&input, &Context::real()).unwrap().caption
    };
    let (one, two) = (figure(1), figure(2));
    assert!(one.contains("black dots means with 95% intervals, cut"), "{one}");
    for word in ["Cousineau", "each thin line", "omnibus"] {
        assert!(!one.contains(word) && two.contains(word), "{word}: {one}");
    }
}
