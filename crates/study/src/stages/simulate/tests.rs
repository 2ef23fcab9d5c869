use super::*;
use clap::Parser as _;
use maveric_domain::Embedding;

#[derive(clap::Parser)]
struct Asked {
    #[command(flatten)]
    simulate: Simulate,
}

fn asked(more: &[&str]) -> Simulate {
    let fixed = "simulate --model m --conditions c --out o".split(' ');
    Asked::parse_from(fixed.chain(more.iter().copied())).simulate
}

fn row(participant: &str, condition: &str) -> ConditionRow {
    ConditionRow::new(
        ParticipantId::new(participant).unwrap(),
        condition.parse().unwrap(),
        Embedding::new(vec![0.0]).unwrap(),
    )
}

#[test]
fn without_a_wish_the_one_in_the_middle_has_logs_and_otherwise_those_who_are_asked_for() {
    let mut rows = Vec::new();
    for (who, score) in
        [("P01", Some(50.0)), ("P02", None), ("P03", Some(20.0)), ("P04", Some(30.0))]
    {
        for (condition, moved) in [("mimic", 0.0), ("wild", 15.0)] {
            rows.push(ConditionRow {
                adb_hat: score.map(|s| s + moved),
                moved_points: Some(moved),
                ..row(who, condition)
            });
        }
    }
    let logged_of = |rows: &[ConditionRow], more: &[&str]| -> Vec<String> {
        let asked = asked(more);
        let logged = Logged::new(&asked, rows);
        let people = rows.iter().step_by(2).map(|row| &row.participant);
        people.filter(|who| logged.cover(who)).map(ToString::to_string).collect()
    };
    let logged = |more: &[&str]| logged_of(&rows, more);
    assert_eq!(logged(&[]), ["P04"]);
    assert_eq!(logged(&["--logs", "P02"]), ["P02"]);
    assert_eq!(logged(&["--logs"]).len(), 4);
    let logs = LogChoice::Of("P99".to_owned());
    let refused = logs.check(rows.iter().map(|row| &row.participant));
    assert!(refused.unwrap_err().to_string().contains("P99"));
    assert_eq!(logged_of(&rows[2..4], &[]), ["P02"]);
    assert_eq!(logs::in_the_middle(&[]), None);
}
