use super::*;

#[test]
fn own_measures_of_a_ride_that_is_left_out_have_the_rule_whether_their_table_is_there_or_not() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text);
    let design = "[study]\ntitle = \"t\"\n[[condition]]\nid = \"calm\"\n[[measure]]\nid = \"tor_s\"\ntitle = \"Take-over time\"\nunit = \"s\"\n\
                  [exclude]\ndrives = { P1-calm = \"sick\" }\n";
    write("study.toml", design).unwrap();
    write("participants.csv", "participant\nP1\nP2\n").unwrap();
    let calm = Moment::After("calm".parse().unwrap());
    let missing = || {
        let study = DesignFile::read(&folder.path().join("study.toml")).unwrap();
        let results = folder.path().join("results");
        let sources = Sources::read(&study, &results, None).unwrap();
        let people = sources.people().iter();
        let own = people.map(|person| {
            let [.., own] = sources.cells(person, calm);
            own.reason()
        });
        own.collect::<Vec<_>>()
    };
    let rule = "left out by exclude.drives: sick".to_owned();
    let none = "measures.csv is not there".to_owned();
    assert_eq!(missing(), [Some(rule.clone()), Some(none)]);
    write("measures.csv", "participant,condition,tor_s\nP2,calm,1.5\n").unwrap();
    assert_eq!(missing(), [Some(rule), None]);
}
