use super::*;

const TWO_OF_FOUR: &str = r"
id = 'trust'
title = 'Trust'
reference = 'chosen'
items = 4
min = 1
max = 7
scoring = 'sum'
reversed = [4]
min_answered = 1.0
wording = ['a', 'b', 'c', 'd']
column = 'q{item}'
[[subscales]]
id = 'own'
title = 'Own'
items = [1, 2]
reversed = [1]
same = 14.0
norms = { mean = 8.0, sd = 2.5, alpha = 0.8, source = 'chosen' }
[[subscales]]
id = 'other'
title = 'Other'
items = [3, 4]
[[correlations]]
of = ['own', 'other']
r = 0.4
source = 'chosen'
";

/// The scale with one line changed, and what is said of it.
fn said(from: &str, to: &str) -> Result<Scale, String> {
    assert!(TWO_OF_FOUR.contains(from), "{from}");
    Scale::from_toml(&TWO_OF_FOUR.replacen(from, to, 1)).map_err(|e| e.to_string())
}

#[test]
fn a_scale_that_agrees_with_itself_is_taken_up_to_its_ends() {
    let scale = said("alpha = 0.8", "alpha = 0.99").unwrap();
    assert_eq!(scale.score_range(&scale.subscales[0]), (2.0, 14.0));
    let reversed = |sub: usize| {
        let items = 1..=4;
        let is = |item: &u32| scale.is_reversed(&scale.subscales[sub], *item);
        items.filter(is).collect::<Vec<u32>>()
    };
    assert_eq!((reversed(0), reversed(1)), (vec![1, 4], vec![4]));
    assert_eq!(scale.column_of(3), "q3");
    let mean = said("scoring = 'sum'\nreversed", "scoring = 'mean'\nreversed");
    assert!(mean.unwrap_err().contains("same is 14, expected 1 to 7"));
    let plain = said("column = 'q{item}'\n", "").unwrap();
    assert_eq!(plain.column_of(3), "trust_3");
    for (from, to) in [
        ("same = 14.0", "same = 2.0"),
        ("wording = ['a', 'b', 'c', 'd']\n", ""),
        ("min_answered = 1.0", "min_answered = 0.01"),
        ("mean = 8.0, sd = 2.5", "mean = 2.1, sd = 5.9"),
        ("r = 0.4", "r = -0.99"),
    ] {
        assert!(said(from, to).is_ok(), "{to}");
    }
}

#[test]
fn each_contradiction_of_a_scale_is_named() {
    let twice = "of = ['other', 'own']\nr = 0.1\nsource = 'x'\n[[correlations]]\nof = ['own'";
    for (from, to, word) in [
        ("items = 4", "items = 0", "at least one item"),
        ("max = 7", "max = 1", "min 1 is not below max 1"),
        ("min_answered = 1.0", "min_answered = 0.0", "not in (0, 1]"),
        ("min_answered = 1.0", "min_answered = 1.1", "not in (0, 1]"),
        ("'c', 'd']", "'c']", "3 texts for 4 items"),
        ("reversed = [4]", "reversed = [5]", "reversed item 5"),
        ("reversed = [4]", "reversed = [0]", "reversed item 0"),
        ("items = [1, 2]", "items = []", "`own` has no items"),
        ("items = [1, 2]", "items = [1, 5]", "names item 5 of 4"),
        ("reversed = [1]", "reversed = [9]", "names item 9 of 4"),
        ("reversed = [1]", "reversed = [3]", "reverses item 3, which it does not have"),
        ("id = 'other'", "id = 'own'", "`own` is defined twice"),
        ("id = 'other'", "id = 'Oth er'", "lower-case letters"),
        (
            "items = 4\nmin = 1\nmax = 7\nscoring = 'sum'\nreversed = [4]\nmin_answered = 1.0\nwording = ['a', 'b', 'c', 'd']",
            "items = 1001\nmin = 1\nmax = 7\nscoring = 'sum'",
            "1001 items, expected",
        ),
        ("scoring = 'sum'\n", "", "expected scoring = "),
        ("scoring = 'sum'", "scorring = 'sum'", "scorring"),
        ("title = 'Own'", "title = 'Own'\nweight = 0", "weight is 0"),
        ("title = 'Own'", "title = 'Own'\nsum_of = ['other']", "no `items` of its own"),
        ("items = [1, 2]", "items = [2, 1, 2]", "item 2 twice"),
        ("same = 14.0", "same = 14.5", "expected 2 to 14"),
        ("same = 14.0", "same = 1.5", "expected 2 to 14"),
        ("mean = 8.0", "mean = 14.0", "norms.mean is 14"),
        ("mean = 8.0", "mean = 2.0", "norms.mean is 2"),
        ("sd = 2.5", "sd = 6.0", "above 0 and below 6"),
        ("sd = 2.5", "sd = 0.0", "norms.sd is 0"),
        ("alpha = 0.8", "alpha = 1.0", "norms.alpha is 1"),
        ("alpha = 0.8", "alpha = 0.0", "norms.alpha is 0"),
        ("source = 'chosen' }", "source = ' ' }", "norms.source"),
        ("column = 'q{item}'", "column = 'q'", "no `{item}`"),
        ("'own', 'other']", "'own', 'own']", "of one subscale"),
        ("'own', 'other']", "'own', 'so']", "no subscale `so`"),
        ("of = ['own'", twice, "given twice"),
        ("r = 0.4", "r = 1.0", "is 1, expected between -1 and 1"),
        ("r = 0.4", "r = -1.0", "is -1, expected between"),
        ("0.4\nsource = 'chosen'", "0.4\nsource = ''", "source is empty"),
    ] {
        let error = said(from, to).unwrap_err();
        assert!(error.contains(word), "{to}: {error}");
    }
}

/// The file of a scale with these lines at the top and these tables behind it.
fn parsed(top: &str, tables: &str) -> Result<Scale, String> {
    let head = "id = 'x'\ntitle = 'X'\nreference = 'made up'\n";
    Scale::from_toml(&format!("{head}{top}\n{tables}")).map_err(|e| e.to_string())
}

const PAIRS: &str = "kind = 'bipolar'\nmin = -2\nmax = 2\nreversed = [1]\npairs = [['useful', 'useless'], ['bad', 'good']]\ninstruction = 'It is'\n";

#[test]
fn short_forms_and_tables_of_items_are_one_list() {
    let short = parsed(
        "min = 1\nmax = 3\nreversed = [2]\nwording = ['a', 'b']\nanchors = ['no', 'yes']",
        "",
    );
    let long = parsed(
        "min = 1\nmax = 3",
        "[[item]]\ntext = 'a'\nanchors = ['no', 'yes']\n[[item]]\ntext = 'b'\nreversed = true\nanchors = ['no', 'yes']\n",
    );
    assert_eq!(short.unwrap(), long.unwrap());
    let pairs = parsed(PAIRS, "").unwrap();
    assert_eq!(pairs.wording.items[1].pair, Some(["bad".to_owned(), "good".to_owned()]));
    assert!(pairs.items[0].reversed && !pairs.items[1].reversed && pairs.wording.worded() == 2);
}

#[test]
fn each_kind_has_its_answers() {
    let tables = "[[item]]\ntext = 'a'\nkind = 'slider'\nmin = 0\nmax = 100\nstep = 5\nanchors = ['low', 'high']\n\
                  [[item]]\ntext = 'b'\nkind = 'ladder'\nmin = 0\nlevels = ['none', 'some', 'much']\n\
                  [[item]]\ntext = 'c'\nkind = 'choice'\nlevels = ['yes', 'No']\noptional = true\n\
                  [[item]]\ntext = 'd'\nkind = 'number'\nmin = 18\nmax = 99\n\
                  [[item]]\ntext = 'e'\nkind = 'text'\n\
                  [[item]]\ntext = 'f'\nmin = 1\nmax = 7\nexpected = 2\n";
    let scale = parsed("", tables).unwrap();
    let ranges: Vec<String> = scale.items.iter().map(Item::range).collect();
    assert_eq!(ranges, ["0 to 100 by 5", "0 to 2", "1 to 2", "18 to 99", "words", "1 to 7"]);
    let takes = |item: u32, answer| scale.item(item).unwrap().takes(answer);
    assert!(takes(1, 95) && !takes(1, 96) && !takes(1, 105) && takes(2, 0) && !takes(2, 3));
    assert!(!takes(5, 0), "words are no number");
    assert_eq!(scale.items[0].points(), 21);
    assert!(scale.item(6).unwrap().is_missed(3) && !scale.item(6).unwrap().is_missed(2));
    assert!(scale.items[2].optional && !scale.items[0].optional);
    assert_eq!(scale.answer_in_words(3, "no"), Some(2));
    assert_eq!((scale.answer_in_words(1, "low"), scale.answer_in_words(3, "maybe")), (None, None));
    assert!(scale.item(0).is_none() && scale.item(7).is_none());
    let unworded = parsed("kind = 'ladder'\nitems = 1\nmin = 0\nmax = 10", "").unwrap();
    assert_eq!((unworded.wording.worded(), unworded.items[0].points()), (0, 11));
}

#[test]
fn a_scale_speaks_the_languages_that_it_has_whole() {
    let german = "[translation.de]\ninstruction = 'Es ist'\npairs = [['nützlich', 'nutzlos'], ['schlecht', 'gut']]\n";
    let scale = parsed(PAIRS, german).unwrap();
    let instruction = |language| scale.wording_in(language)?.instruction.clone();
    assert_eq!(instruction("en").unwrap(), "It is");
    assert_eq!(instruction("de").unwrap(), "Es ist");
    assert_eq!(instruction("de-at").unwrap(), "Es ist");
    assert_eq!((instruction("nl"), instruction("d")), (None, None));
    for (from, to, word) in [
        (", ['schlecht', 'gut']", "", "[translation.de]: pairs has 1 texts for 2 items"),
        (
            "pairs = [['nützlich', 'nutzlos'], ['schlecht', 'gut']]\n",
            "",
            "lacks the words of item 1",
        ),
        ("instruction = 'Es ist'\n", "", "lacks instruction"),
        ("[translation.de]", "[translation.en]", "language of the file itself"),
        ("'nutzlos'", "''", "item 1: pair"),
        ("instruction", "Instruction", "unknown field"),
    ] {
        assert!(german.contains(from), "{from}");
        let error = parsed(PAIRS, &german.replacen(from, to, 1)).unwrap_err();
        assert!(error.contains(word), "{to}: {error}");
    }
    let anchors = "min = 1\nmax = 3\nwording = ['a']\nanchors = ['no', 'yes']";
    let error = parsed(anchors, "[translation.de]\nitems = ['a']").unwrap_err();
    assert!(error.contains("item 1 has words for 0 answers, expected 2"), "{error}");
}

#[test]
fn a_sum_of_scores_counts_what_they_share_twice_and_has_a_weight() {
    let top = "items = 3\nmin = 0\nmax = 3\nscoring = 'sum'";
    let parts = "[[subscales]]\nid = 'a'\ntitle = 'A'\nitems = [1, 2]\nweight = 2.5\n\
                 [[subscales]]\nid = 'b'\ntitle = 'B'\nitems = [2, 3]\n\
                 [[subscales]]\nid = 'total'\ntitle = 'T'\nsum_of = ['a', 'b']\nweight = 2\n";
    let scale = parsed(top, parts).unwrap();
    let ranges: Vec<(f64, f64)> = scale.subscales.iter().map(|s| scale.score_range(s)).collect();
    assert_eq!(ranges, [(0.0, 15.0), (0.0, 6.0), (0.0, 24.0)]);
    assert_eq!(scale.items_of(&scale.subscales[2]), [1, 2, 3]);
    for (from, to, word) in [
        ("['a', 'b']", "['a', 'c']", "names `c`, which is no subscale"),
        ("['a', 'b']", "['a', 'total']", "a sum itself"),
        ("weight = 2.5", "weight = -1", "weight is -1"),
    ] {
        let error = parsed(top, &parts.replacen(from, to, 1)).unwrap_err();
        assert!(error.contains(word), "{to}: {error}");
    }
    let mean = parsed(&top.replace("sum", "mean"), parts).unwrap_err();
    assert!(mean.contains("scoring = \"sum\""), "{mean}");
}

/// The table of an item with this line.
fn item(line: &str) -> String {
    format!("[[item]]\ntext = 'a'\n{line}\n")
}

#[test]
fn what_a_file_says_twice_or_halfway_is_named_by_item_and_key() {
    for (top, tables, word) in [
        ("", String::new(), "has no items"),
        ("min = 1", item(""), "item 1: a `likert` needs min and max"),
        ("min = 3\nmax = 3", item(""), "item 1: min 3 is not below max 3"),
        ("min = 1\nmax = 7", item("kind = 'choice'"), "a `choice` with 0 `levels`"),
        (
            "reversed = [1]",
            item("kind = 'number'\nmin = 1\nmax = 7"),
            "a `number` cannot be reversed",
        ),
        (
            "kind = 'bipolar'\nmin = 1\nmax = 5\npairs = [['useful']]",
            String::new(),
            "pair [\"useful\"], expected two words",
        ),
        ("min = 1\nmax = 5\npairs = [['a', 'b']]", String::new(), "a `likert` has no pair"),
        ("min = 1\nmax = 5\nwording = ['b']", item(""), "has two texts"),
        ("min = 1\nmax = 5\nitems = 2", item(""), "has 1 tables [[item]] for 2 items"),
        ("min = 1\nmax = 5", item("") + "[[item]]\n", "item 2 has no text, and 1 of 2 have one"),
        ("min = 1\nmax = 5", item("colour = 3"), "colour"),
        ("kind = 'likely'", item(""), "likely"),
    ] {
        let error = parsed(top, &tables).unwrap_err();
        assert!(error.contains(word), "{top} {tables}: {error}");
    }
}

#[test]
fn an_item_has_the_keys_of_its_kind() {
    for (line, word) in [
        ("min = 0\nmax = 2000000000", "expected within"),
        ("kind = 'choice'", "a `choice` with 0 `levels`"),
        ("kind = 'ladder'\nlevels = ['a', 'b']\nmax = 5", "2 levels from 1 end at 2, and max is 5"),
        ("kind = 'slider'\nmin = 0\nmax = 10\nstep = 3", "step 3, expected one of a slider"),
        ("min = 0\nmax = 10\nstep = 2", "step 2, expected one of a slider"),
        ("kind = 'text'\nmax = 3", "neither min, max nor step"),
        ("min = 1\nmax = 7\nanchors = ['a', 'b', 'c']", "3 anchors, expected 2 (of the ends) or 7"),
        ("min = 1\nmax = 7\nlevels = ['a', 'b']", "has no `levels`, expected `anchors`"),
        (
            "kind = 'choice'\nlevels = ['a', 'b']\nanchors = ['a', 'b']",
            "has no `anchors`, expected `levels`",
        ),
        ("min = 1\nmax = 7\nexpected = 8", "expected is 8, which is no answer (1 to 7)"),
        ("kind = 'text'\nexpected = 0", "which is no answer (words)"),
        ("kind = 'number'\nmin = 1\nmax = 7\nreversed = true", "a `number` cannot be reversed"),
    ] {
        let error = parsed("", &item(line)).unwrap_err();
        assert!(error.contains(word), "{line}: {error}");
    }
}

#[test]
fn a_score_has_items_of_one_range_that_are_not_there_for_attention() {
    let top = "min = 1\nmax = 5\nscoring = 'mean'";
    let scored = "[[subscales]]\nid = 's'\ntitle = 'S'\nitems = [1, 2]\n";
    for (second, word) in [
        ("max = 7", "item 1 (1 to 5) and item 2 (1 to 7)"),
        ("expected = 2", "scores item 2, which is there for attention"),
        ("kind = 'text'", "scores item 2, a `text`"),
    ] {
        let error = parsed(top, &(item("") + &item(second) + scored)).unwrap_err();
        assert!(error.contains(word), "{second}: {error}");
    }
}
