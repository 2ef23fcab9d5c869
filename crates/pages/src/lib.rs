#![doc = include_str!("../README.md")]
#![allow(clippy::missing_errors_doc)] // a part of the program: its errors are read, not matched on

mod card;
pub mod cards;
mod codebook;
mod glossary;
mod manuscript;
mod orders;
mod page_texts;
mod preregistration;
pub mod study;
mod table_text;
mod texts;
pub mod words;

pub use codebook::{codebook, named_answers};
pub use glossary::glossary;
pub use orders::orders;
pub use page_texts::{
    ABLATION, DECLARED, FOLLOWING, METHODS, PageTexts, REHEARSAL, RESULTS, STUDY, TextFile,
    VALIDATION,
};
pub use preregistration::preregistration;
