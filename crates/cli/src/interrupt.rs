//! Ctrl-C: stop soon, lose nothing.

use std::{
    sync::{
        Arc, OnceLock,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

/// Exit status of interrupted work.
pub(crate) const INTERRUPTED: u8 = 130;
/// Work that has not stopped by itself after this long is ended: results only ever appear whole.
const PATIENCE: Duration = Duration::from_millis(800);

/// Whether this program waits for its stages to end by themselves.
static PATIENT: AtomicBool = AtomicBool::new(false);

/// Leaves the end to [`maveric_pipeline::run`], which ends its stages first.
pub(crate) fn be_patient() {
    PATIENT.store(true, Ordering::SeqCst);
}

/// The flag that Ctrl-C sets.
pub(crate) fn flag() -> &'static Arc<AtomicBool> {
    static FLAG: OnceLock<Arc<AtomicBool>> = OnceLock::new();
    FLAG.get_or_init(Arc::default)
}

/// Starts to listen for Ctrl-C and for the request to terminate.
pub(crate) fn listen() {
    let handler = || {
        if flag().swap(true, Ordering::SeqCst) {
            std::process::exit(i32::from(INTERRUPTED));
        }
        std::thread::spawn(|| {
            std::thread::sleep(PATIENCE);
            if PATIENT.load(Ordering::SeqCst) {
                return;
            }
            std::process::exit(i32::from(INTERRUPTED));
        });
    };
    // Without a handler Ctrl-C still ends the program, only less politely.
    drop(ctrlc::set_handler(handler));
}
