//! The program with what is not everywhere: recordings, a scheduler, LaTeX, a disk of its own.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test stops at the first surprise")]

#[cfg(target_os = "linux")]
mod hyperqueue;
mod paper;
mod recordings;
#[cfg(target_os = "linux")]
mod small_disk;
#[path = "../support/mod.rs"]
mod support;
#[path = "../support/where_there.rs"]
mod where_there;

fn main() {
    let mut tests = recordings::tests();
    tests.extend(paper::tests());
    #[cfg(target_os = "linux")]
    {
        tests.extend(hyperqueue::tests());
        tests.extend(small_disk::tests());
    }
    where_there::run(tests)
}
