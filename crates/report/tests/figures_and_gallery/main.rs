//! The gallery's figures as tests see them: one program, since each would link the renderer anew.
#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a helper of a test stops at the first surprise"
)]

#[path = "../../examples/gallery/gallery_page.rs"]
mod gallery_page;
#[path = "../../examples/gallery/kinds/mod.rs"]
mod kinds;

mod bad_input;
mod drawn;
mod golden;
mod many;
mod page;
mod read_back;
