//! Studies that are not the paper's, walked from logs and answers to the page: it says what was done, and nothing that was not.

mod made_up;
mod recorded;

use crate::support::{
    TempStudy, argv,
    own_logs::{analysis, change, measured, panel, recorded, recorded_of, table},
    page::Page,
    tells,
};

fn page(study: &TempStudy, folder: &str) -> Page {
    Page::read(&study.path(&format!("{folder}/report/index.html")))
}
