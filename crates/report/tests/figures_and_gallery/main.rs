//! The gallery's figures as tests see them: one program, since each would link the renderer anew.
#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a helper of a test stops at the first surprise"
)]

#[path = "../../examples/gallery/gallery_page.rs"]
mod gallery_page;
#[path = "../../examples/gallery/made_up/mod.rs"]
// Not `expect`: that alone makes what is unused count as used, and then finds nothing to expect.
#[allow(
    dead_code,
    unused_imports,
    reason = "the page is drawn by another test"
)]
mod made_up;

mod bad_input;
mod drawn;
mod golden;
mod many;
mod page;
