//! `design orders`: in which order people meet the conditions, as the table of people has it.

use crate::{
    design::DesignFile,
    error::StudyError,
    gate::Gate,
    outcome::Outcome,
    tables::{Table, TableBuilder, participants::Enrolled},
};
use maveric_analysis::OrderBalance;
use maveric_domain::{
    ConditionId,
    design::{Condition, OrderPlan, Square},
};
use path_slash::PathExt as _;
use serde::Serialize;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

/// Most people whose orders are written.
const MOST_PEOPLE: usize = 10_000;

/// Which orders are asked for.
#[derive(Debug, Clone, clap::Args)]
pub struct Orders {
    /// Write a new table of people, P01, P02 and so on; the design's own people get orders when not given
    #[arg(long, value_name = "N")]
    pub people: Option<usize>,
    /// Take the rows of a Latin square, which are fewer where the number of conditions is odd; in it each condition follows the same other
    /// in every order. Those of a Williams square when not given
    #[arg(long)]
    pub latin: bool,
    /// Factor of the conditions (`levels` of the design) whose levels are met in blocks, one after the other
    #[arg(long, value_name = "FACTOR")]
    pub blocks: Option<String>,
    /// Table to write; the design's table of people, where there is none or it has no row, when not given
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

#[derive(Debug, Clone, Serialize)]
pub struct OrdersWritten {
    /// The table of people that was written.
    pub table: PathBuf,
    /// The square that they are rows of.
    pub square: Square,
    /// How evenly the conditions stand in them.
    pub balance: Option<OrderBalance>,
}

/// Writes the table of people with an `order` for each who is tested: rows of a square in turn, from its first again in each group of
/// people that the design compares.
///
/// # Errors
/// [`StudyError`] for a table that is there already, a factor that the conditions do not cross, or a design without conditions to order.
pub fn orders(
    design: Option<&Path>,
    options: &Orders,
) -> Result<Outcome<OrdersWritten>, StudyError> {
    let study = DesignFile::find(design)?;
    let square = if options.latin { Square::Latin } else { Square::Williams };
    let is_crossed = |c: &Condition| !c.levels.is_empty();
    if options.blocks.is_some() && !study.design.conditions().iter().any(is_crossed) {
        let problem =
            "`--blocks` is given a factor of the conditions, and no condition has `levels`";
        let help = "write the `levels` of each condition into the design, such as levels = { traffic = \"jam\" }, or leave `--blocks` out";
        return Err(StudyError::not_possible(problem).with_help(help));
    }
    let plan = OrderPlan::new(&study.design, square, options.blocks.as_deref())
        .map_err(|error| study.wrong(error.to_string(), error.suggestion()))?;
    if study.design.conditions().len() < 2 {
        return Err(study.wrong("has fewer than two conditions: there is no order of them", None));
    }
    let people_file = study.people_file(None);
    let out = options.out.clone().unwrap_or_else(|| people_file.clone());
    // What `init` makes is a table without a row.
    let empty = (out == people_file && out.is_file())
        .then(|| Table::read(&out))
        .transpose()?
        .filter(|table| table.rows() == 0);
    if let Some(table) = empty.as_ref().filter(|table| !table.has("participant")) {
        return Err(StudyError::no_column(&out, "participant", table.columns()));
    }
    if out.exists() && (empty.is_none() || options.people.is_none()) {
        let problem = "is there already";
        let help = "name another table by --out; without --people it has the people of the design's own, each with an order";
        return Err(StudyError::file(out, problem).with_help(help));
    }
    let (table, orders) = match options.people {
        Some(n) => new_people(&study, &plan, n, &empty.map_or_else(Vec::new, |t| t.columns()))?,
        None => same_people(&study, &plan, &people_file)?,
    };
    table.write(&out)?;
    let people = orders.len();
    let balance = OrderBalance::of(&study.design, orders.iter().map(Vec::as_slice));
    let mut summary = vec![format!("orders of {people} people: {}", out.to_slash_lossy())];
    if let Some(balance) = &balance {
        summary.extend(maveric_pages::orders(&study.design, balance)?);
    }
    let mut warnings = Vec::new();
    let whole = plan.people();
    if !people.is_multiple_of(whole) {
        warnings.push(format!(
            "{people} people are no multiple of {whole}, after which every order has been met equally often"
        ));
    }
    let value = OrdersWritten { table: out, square, balance };
    Ok(Outcome::new(value, summary, warnings))
}

type Written = (TableBuilder, Vec<Vec<ConditionId>>);

/// A table of people who come yet, with these columns to be filled in.
fn new_people(
    study: &DesignFile,
    plan: &OrderPlan,
    n: usize,
    more: &[String],
) -> Result<Written, StudyError> {
    if !(1..=MOST_PEOPLE).contains(&n) {
        return Err(StudyError::not_possible(format!("--people {n}: expected 1 to {MOST_PEOPLE}")));
    }
    let digits = n.to_string().len().max(2);
    let orders: Vec<Vec<ConditionId>> = (0..n).map(|person| plan.order(person)).collect();
    let ids = (1..=n).map(|number| format!("P{number:0digits$}"));
    let mut table = TableBuilder::default().cells("participant", ids.map(Some));
    let people = study.design.people();
    for column in people.columns() {
        let word = people.test.as_ref().and_then(|test| test.get(column));
        let word = word.cloned().unwrap_or_default();
        table = table.cells(column, std::iter::repeat_n(Some(word), n));
    }
    let columns = people.columns();
    let is_written =
        |name: &str| ["participant", "order"].contains(&name) || columns.contains(&name);
    for column in more.iter().filter(|name| !is_written(name)) {
        table = table.cells(column, std::iter::repeat_n(None::<String>, n));
    }
    Ok((table.cells("order", orders.iter().map(|order| Some(words(order)))), orders))
}

/// The design's own table of people, with an order for each who is tested and has none.
fn same_people(study: &DesignFile, plan: &OrderPlan, path: &Path) -> Result<Written, StudyError> {
    if !path.is_file() {
        let problem = "is not there: nobody can be given an order";
        let help = "say how many people there will be: --people 24";
        return Err(StudyError::file(path, problem).with_help(help));
    }
    let gate = Gate::new(study, Some(path))?;
    let factors = study.design.factors();
    let mut met: BTreeMap<Vec<Option<&String>>, usize> = BTreeMap::new();
    let mut orders = Vec::new();
    let mut cells = Vec::new();
    for person in &gate.people().enrolled {
        let mut order = person.order.clone();
        if takes_part(person) {
            let group = factors.iter().map(|f| person.cells.get(&f.name)).collect();
            let index = met.entry(group).or_default();
            if order.is_empty() {
                order = plan.order(*index);
            }
            *index += 1;
            orders.push(order.clone());
        }
        cells.push(words(&order));
    }
    let table = Table::read(path)?;
    let mut written = TableBuilder::default();
    for name in table.columns().iter().filter(|name| *name != "order") {
        written = written.cells(name, table.text(name)?);
    }
    Ok((written.cells("order", cells.into_iter().map(Some)), orders))
}

/// How evenly the conditions stand in the orders of those who are tested and not left out; none where nobody's is known.
pub(crate) fn balance_of(study: &DesignFile, people: &[Enrolled]) -> Option<OrderBalance> {
    let tested = people.iter().filter(|person| takes_part(person));
    OrderBalance::of(&study.design, tested.map(|person| person.order.as_slice()))
}

fn takes_part(person: &Enrolled) -> bool {
    person.tested && person.excluded.is_none()
}

fn words(order: &[ConditionId]) -> String {
    let words: Vec<&str> = order.iter().map(ConditionId::as_str).collect();
    words.join(" ")
}

/// When each condition of somebody was recorded, where a clock says it: ns since 1970.
pub(crate) type Recorded = BTreeMap<ConditionId, Option<u64>>;

/// Refuses an order that somebody's logs contradict: a condition that is not in it, or one that was recorded before another that stands
/// ahead of it.
///
/// # Errors
/// [`StudyError::BadCell`] naming the table of people, the row and what the logs say.
pub(crate) fn agrees(
    table: &Path,
    row: usize,
    person: &Enrolled,
    recorded: &Recorded,
) -> Result<(), StudyError> {
    let order = &person.order;
    let contradicted = |expected: String| StudyError::BadCell {
        path: table.to_owned(),
        row: row + 1,
        column: "order".to_owned(),
        found: words(order),
        expected,
    };
    if order.is_empty() {
        return Ok(());
    }
    if let Some(other) = recorded.keys().find(|id| !order.contains(id)) {
        return Err(contradicted(format!(
            "an order with `{other}`, of which {} has a log",
            person.id
        )));
    }
    let mut timed: Vec<(u64, ConditionId)> =
        recorded.iter().filter_map(|(id, ns)| Some(((*ns)?, *id))).collect();
    timed.sort_unstable();
    let place = |id: &ConditionId| order.iter().position(|other| other == id);
    let turned = timed
        .windows(2)
        .find(|pair| pair[0].0 < pair[1].0 && place(&pair[0].1) > place(&pair[1].1));
    turned.map_or(Ok(()), |pair| {
        let (first, second) = (pair[0].1, pair[1].1);
        Err(contradicted(format!(
            "`{first}` before `{second}`: by the clocks of the logs it was recorded first"
        )))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use maveric_analysis::Balance;

    const DESIGN: &str = "[study]\ntitle = \"t\"\n[people]\ntest = { part = \"ride\" }\n[[condition]]\nid = \"a\"\nlevels = { pace = \"slow\", road = \"wet\" }\n\
        [[condition]]\nid = \"b\"\nlevels = { pace = \"fast\", road = \"wet\" }\n[[condition]]\nid = \"c\"\nlevels = { pace = \"slow\", road = \"dry\" }\n\
        [[condition]]\nid = \"d\"\nlevels = { pace = \"fast\", road = \"dry\" }\n[[factor]]\ncolumn = \"city\"\n";

    struct Folder(tempfile::TempDir);

    impl Folder {
        fn new() -> Self {
            let folder = Self(tempfile::tempdir().unwrap());
            folder.write("study.toml", DESIGN);
            folder
        }

        fn write(&self, name: &str, text: &str) {
            std::fs::write(self.0.path().join(name), text).unwrap();
        }

        fn study(&self) -> DesignFile {
            DesignFile::read(&self.0.path().join("study.toml")).unwrap()
        }

        fn orders(
            &self,
            people: Option<usize>,
            out: Option<&str>,
        ) -> Result<Outcome<OrdersWritten>, String> {
            let asked = Orders {
                people,
                latin: false,
                blocks: None,
                out: out.map(|name| self.0.path().join(name)),
            };
            orders(Some(&self.0.path().join("study.toml")), &asked).map_err(|e| e.to_string())
        }
    }

    #[test]
    fn new_people_have_balanced_orders_that_the_design_reads() {
        let folder = Folder::new();
        folder.write("study.toml", &DESIGN.replace("[[factor]]\ncolumn = \"city\"\n", ""));
        let written = folder.orders(Some(8), None).unwrap();
        assert!(written.warnings.is_empty(), "{:?}", written.warnings);
        let people = folder.study().people(None).unwrap().enrolled;
        assert_eq!((people.len(), people[7].id.as_str()), (8, "P08"));
        assert!(people.iter().all(|p| p.tested && p.order.len() == 4));
        let balance = balance_of(&folder.study(), &people).unwrap();
        assert_eq!(balance.balance, Balance::PlacesAndSuccession);
        assert_eq!(written.value.balance, Some(balance));
        // What is there is never written over.
        assert!(folder.orders(Some(8), None).unwrap_err().contains("is there already"));
        let uneven = folder.orders(Some(6), Some("six.csv")).unwrap();
        assert!(
            uneven.warnings[0].contains("6 people are no multiple of 4"),
            "{:?}",
            uneven.warnings
        );
        assert!(
            folder.orders(Some(0), Some("none.csv")).unwrap_err().contains("expected 1 to 10000")
        );
    }

    #[test]
    fn blocks_of_conditions_that_have_no_levels_are_refused_by_the_option_that_asks_for_them() {
        let folder = Folder::new();
        let in_blocks = |design: &str, factor: &str| {
            folder.write("study.toml", design);
            let asked = Orders {
                people: Some(8),
                latin: false,
                blocks: Some(factor.to_owned()),
                out: Some(folder.0.path().join(format!("{factor}.csv"))),
            };
            let design = folder.0.path().join("study.toml");
            orders(Some(&design), &asked).map_err(|e| e.to_string())
        };
        let plain =
            "[study]\ntitle = \"t\"\n[[condition]]\nid = \"a\"\n[[condition]]\nid = \"b\"\n";
        let error = in_blocks(plain, "road").unwrap_err();
        assert!(
            error.starts_with("`--blocks`") && error.ends_with("no condition has `levels`"),
            "{error}"
        );
        let crossed = DESIGN.replace("[[factor]]\ncolumn = \"city\"\n", "");
        assert!(in_blocks(&crossed, "road").is_ok());
        let error = in_blocks(&crossed, "rode").unwrap_err();
        assert!(error.contains("found `rode`"), "{error}");
    }

    #[test]
    fn each_group_begins_again_and_an_order_that_is_there_stays() {
        let folder = Folder::new();
        let table = "participant,part,city,order,note\nA1,ride,x,,n\nB1,ride,y,d c b a,\nA2,ride,x,,\nL1,learn,x,,\nB2,ride,y,,\n";
        folder.write("participants.csv", table);
        let written = folder.orders(None, Some("new.csv")).unwrap();
        assert_eq!(written.value.balance.unwrap().people, 4);
        let people =
            folder.study().people(Some(&folder.0.path().join("new.csv"))).unwrap().enrolled;
        let order = |id: &str| words(&people.iter().find(|p| p.id.as_str() == id).unwrap().order);
        assert_eq!([order("A1"), order("B1"), order("L1")], ["a b d c", "d c b a", ""]);
        assert_eq!(order("A2"), order("B2"));
        assert_eq!(people[0].cells["note"], "n");
        assert!(folder.orders(None, None).unwrap_err().contains("is there already"));
    }

    #[test]
    fn without_people_or_conditions_to_order_there_are_no_orders() {
        let folder = Folder::new();
        assert!(folder.orders(None, None).unwrap_err().contains("is not there"));
        folder.write("study.toml", "[study]\ntitle = \"t\"\n[[condition]]\nid = \"a\"\n");
        assert!(folder.orders(Some(3), None).unwrap_err().contains("fewer than two conditions"));
    }

    #[test]
    fn an_order_that_the_logs_contradict_is_refused_with_file_and_row() {
        let folder = Folder::new();
        folder.write(
            "participants.csv",
            "participant,part,city,order\nA1,ride,x,\nA2,ride,x,a b c\n",
        );
        let people = folder.study().people(None).unwrap().enrolled;
        let told = |person: usize, recorded: &[(&str, Option<u64>)]| {
            let recorded = recorded.iter().map(|(id, ns)| (id.parse().unwrap(), *ns)).collect();
            agrees(Path::new("participants.csv"), person, &people[person], &recorded)
                .map_err(|e| e.to_string())
        };
        // Clocks that agree, clocks that do not tell, a condition that was not recorded, nobody's order.
        assert!(told(1, &[("a", Some(1)), ("b", Some(2)), ("c", Some(3))]).is_ok());
        assert!(told(1, &[("c", None), ("a", Some(9))]).is_ok());
        assert!(told(1, &[("b", Some(5)), ("a", Some(5))]).is_ok());
        assert!(told(0, &[("d", Some(1)), ("a", Some(2))]).is_ok());
        let error = told(1, &[("b", Some(1)), ("a", Some(2))]).unwrap_err();
        assert!(
            error.starts_with(
                "participants.csv: row 2, column `order`: found `a b c`, expected `b` before `a`"
            ),
            "{error}"
        );
        let error = told(1, &[("a", Some(1)), ("d", None)]).unwrap_err();
        assert!(error.contains("expected an order with `d`, of which A2 has a log"), "{error}");
    }
}
