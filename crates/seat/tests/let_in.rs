//! Who is let in: ids, rows of the square, and who never came.

use crate::support::{
    STUDY, Server, folder, folder_of, lab, lab_post, open, opened, read, replies, script::go_on,
    tells,
};
use maveric_seat::Invitation;
use rusqlite::Connection;
use std::{fs, path::Path};

/// Everybody's id, row of the square and first ride, and how their part ended.
fn people(folder: &Path) -> Vec<(String, Option<i64>, String, Option<String>)> {
    let state = Connection::open(folder.join("seat/seat.db")).unwrap();
    let question = "SELECT participant, row, steps, ended FROM person ORDER BY rowid";
    let mut rows = state.prepare(question).unwrap();
    let read = |row: &rusqlite::Row<'_>| {
        let steps: String = row.get(2)?;
        let steps: serde_json::Value = serde_json::from_str(&steps).unwrap();
        let mut steps = steps.as_array().unwrap().iter();
        let ride = steps.find(|step| step["kind"] == "ride");
        let ride = ride.map_or("", |ride| ride["condition"].as_str().unwrap());
        Ok((row.get(0)?, row.get(1)?, ride.to_owned(), row.get(3)?))
    };
    let people = rows.query_map([], read).unwrap();
    people.map(Result::unwrap).collect()
}

fn rows(folder: &Path) -> Vec<Option<i64>> {
    people(folder).into_iter().map(|(_, row, ..)| row).collect()
}

#[test]
fn a_row_belongs_to_who_takes_part_and_goes_to_the_next_when_they_left_or_never_came() {
    let folder = folder();
    let server = Server::open(folder.path());
    let never = |who: &str| lab_post(&server, &format!("/lab/never/{who}"), "");
    let mut links: Vec<String> = (0..3).map(|_| opened(&server)).collect();
    assert_eq!(rows(folder.path()), [Some(0), Some(1), Some(2)]);
    while go_on(&server, &links[2]) {}
    server.post(&format!("/api/{}/leave", links[0]), r#"{"keep":true}"#);
    links.push(opened(&server));
    let fourth = people(folder.path()).pop().unwrap();
    assert_eq!((fourth.1, fourth.2.as_str()), (Some(0), "calm"));
    // Nothing of it without the password.
    server.post("/lab/never/P002", "");
    assert_eq!(people(folder.path())[1].3, None);
    let page = lab(&server);
    let offered = |who: &str| page.contains(&format!("action=\"/lab/never/{who}\""));
    assert!(offered("P002") && offered("P004") && !offered("P001") && !offered("P003"));
    assert_eq!(never("P002").0, 303);
    server.seat.let_in().unwrap();
    let fifth = people(folder.path()).pop().unwrap();
    assert_eq!((fifth.1, fifth.2.as_str()), (Some(1), "sporty"));
    server.seat.let_in().unwrap();
    assert_eq!(people(folder.path()).pop().unwrap().1, Some(3), "row 2 is of who is through");
    let notes = read(folder.path(), "seat/notes.csv");
    tells(&notes, &["P002 never came: their row of the square is free"]);
    assert_eq!(server.state(&links[1])["ended"], "never came");

    // Who began came, and nobody never comes twice.
    while server.state(&links[3])["at"] == 0 {
        go_on(&server, &links[3]);
    }
    for (who, why) in [
        ("P004", "`P004` came: they are at step 2"),
        ("P002", "has ended already: never came"),
        ("P02", "did you mean `P002`?"),
    ] {
        replies(never(who), 400, why);
    }
    assert_eq!(people(folder.path())[3].3, None);
}

#[test]
fn an_id_is_given_by_hand_once_and_never_one_that_stands_anywhere() {
    let folder = folder();
    fs::write(folder.path().join("participants.csv"), "participant,study\nX1,2\n").unwrap();
    let server = Server::open(folder.path());
    let next = |id: &str| {
        let body = format!("participant={id}");
        lab_post(&server, "/lab/next", &body)
    };
    let ids = || -> Vec<String> { people(folder.path()).into_iter().map(|p| p.0).collect() };
    assert_eq!(next("VP-17").0, 303);
    assert_eq!(next("+").0, 303);
    assert_eq!(ids(), ["VP-17", "P002"]);
    assert_eq!(next("P9").0, 303);
    server.seat.forget("P9").unwrap();
    for (id, why) in [
        ("VP-17", "the id `VP-17` stands already"),
        ("vp-17", "the id `vp-17` stands already"),
        ("X1", "the id `X1` stands already"),
        ("P9", "the id `P9` stands already"),
        ("a%2Fb", "letters, digits"),
    ] {
        replies(next(id), 400, why);
    }
    assert_eq!(ids(), ["VP-17", "P002"]);
    // The next by itself goes past one that was given by hand.
    assert_eq!(next("P003").0, 303);
    assert_eq!(next("P005").0, 303);
    assert_eq!(next("").0, 303);
    assert_eq!(ids()[2..], ["P003", "P005", "P006"]);
}

#[test]
fn an_order_by_hand_is_ridden_holds_the_row_that_it_has_and_names_every_condition_once() {
    let folder = folder();
    let server = Server::open(folder.path());
    let next = |order: &str| {
        let body = format!("participant=&order={order}");
        lab_post(&server, "/lab/next", &body)
    };
    for (order, why) in [
        ("calm+calm", "`calm` stands twice"),
        ("calm", "`sporty` is missing"),
        ("calm+fast", "`fast` is not a condition of this study"),
    ] {
        let (status, reply) = next(order);
        assert!(status == 400 && reply.contains(why), "{reply}");
        assert!(reply.contains("expected each of these once: calm sporty"), "{reply}");
    }
    assert!(people(folder.path()).is_empty());
    for order in ["sporty+calm", "", "sporty%2C+calm", "+"] {
        assert_eq!(next(order).0, 303, "{order}");
    }
    let ridden: Vec<_> =
        people(folder.path()).into_iter().map(|(_, row, first, _)| (row, first)).collect();
    let expected = [(1, "sporty"), (0, "calm"), (3, "sporty"), (2, "calm")];
    assert_eq!(ridden, expected.map(|(row, first)| (Some(row), first.to_owned())));
}

#[test]
fn an_order_that_the_square_does_not_have_takes_no_row_from_anybody() {
    let four = STUDY.replace(
        "[baseline]",
        "[[condition]]\nid = \"mean\"\ncar = { mean = true, recorded = true }\n[[condition]]\nid = \"own_style\"\ncar = { dial = 0, recorded = true }\n[baseline]",
    );
    let folder = folder_of(&four);
    let server = Server::open(folder.path());
    let order = Some("calm sporty mean own_style".to_owned());
    let invitation = Invitation { order, ..Invitation::default() };
    let token = server.seat.invite(&invitation).unwrap();
    server.seat.let_in().unwrap();
    assert_eq!(rows(folder.path()), [None, Some(0)]);
    assert!(go_on(&server, &token));
    server.seat.write_files().unwrap();
    let listed = read(folder.path(), "participants.csv");
    tells(&listed, &["P001,2,calm sporty mean own_style\n"]);
    // Nor when the seat is opened again.
    drop(server);
    open(folder.path()).unwrap();
    assert_eq!(rows(folder.path()), [None, Some(0)]);
}

#[test]
fn whoever_never_came_or_did_not_agree_is_in_no_table() {
    let folder = folder();
    let table = || read(folder.path(), "participants.csv");
    let server = Server::open(folder.path());
    let links: Vec<String> = (0..4).map(|_| opened(&server)).collect();
    // P001 agrees, P002 leaves where they are to agree, P003 never comes, P004 reads still, and nobody opens the link of P005.
    server.seat.let_in().unwrap();
    assert!(go_on(&server, &links[0]));
    let leave = format!("/api/{}/leave", links[1]);
    assert_eq!(server.post(&leave, r#"{"keep":true}"#).0, 200);
    assert_eq!(lab_post(&server, "/lab/never/P003", "").0, 303);
    drop(server);
    drop(open(folder.path()).unwrap());
    assert_eq!(table(), "participant,study,order\nP001,2,calm sporty\n");
    for name in ["seat/events.csv", "seat/consents.csv"] {
        let text = read(folder.path(), name);
        let others = ["P002", "P003", "P004", "P005"];
        assert!(text.contains("P001"), "{text}");
        assert!(others.iter().all(|who| !text.contains(who)), "{text}");
    }
}

#[test]
fn where_nothing_is_agreed_to_whoever_opened_their_link_takes_part() {
    let folder = folder_of(&STUDY.replace("consent = \"consent.md\"\n", ""));
    let server = Server::open(folder.path());
    opened(&server);
    server.seat.let_in().unwrap();
    server.seat.write_files().unwrap();
    let listed = read(folder.path(), "participants.csv");
    assert_eq!(
        listed,
        "participant,study,order
P001,2,calm sporty
"
    );
    // Whoever opened it and never came is taken out again; what others wrote of other people stays.
    let table = folder.path().join("participants.csv");
    let more = "participant,study,order,age
P001,2,calm sporty,
X1,1,,40
";
    fs::write(&table, more).unwrap();
    assert_eq!(lab_post(&server, "/lab/never/P001", "").0, 303);
    let left = "participant,study,order,age
X1,1,,40
";
    assert_eq!(fs::read_to_string(&table).unwrap(), left);
    assert!(lab(&server).contains("taken out of participants.csv: they never came"));
}
