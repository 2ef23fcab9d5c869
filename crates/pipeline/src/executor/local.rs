//! Stages as child processes on this machine.

use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, SyncSender};
use std::time::{Duration, Instant};

use super::{Ended, Job};

/// How often a running child and the flag are looked at.
const TICK: Duration = Duration::from_millis(25);
/// How long an interrupted child has to clear up before it is killed.
const GRACE: Duration = Duration::from_millis(75);
/// How long a dead child's pipes, held open by children of its own, are still read.
const PIPES_AFTER_DEATH: Duration = Duration::from_millis(200);
const LONGEST_LINE: u64 = 64 * 1024;
const KEPT_STDOUT: usize = 256 * 1024;
const KEPT_LINES: usize = 20;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Stream {
    Stdout,
    Stderr,
}

/// A line with its end, or the end of a stream.
type Message = Option<(Stream, Vec<u8>)>;

/// Runs the job to its end, or until `stop` is set; `on_stderr` gets each line of standard
/// error as it comes.
///
/// # Errors
/// If the log cannot be written or the child cannot be waited for; it is killed then.
pub(crate) fn run(
    mut job: Job<'_>,
    stop: &AtomicBool,
    on_stderr: &mut dyn FnMut(String),
) -> std::io::Result<Ended> {
    let mut command = Command::new(job.program);
    command
        .args(job.arguments)
        .current_dir(job.root)
        .stdin(Stdio::from(job.stdin))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    // A group of its own: Ctrl-C reaches us alone, and we end the stage with all its children.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let mut child = match command.spawn() {
        Ok(child) => child,
        Err(error) => return Ok(Ended::NotStarted(error)),
    };
    drop(command); // and with it our copy of the child's standard input
    let (sender, lines) = mpsc::sync_channel(256);
    if let Some(stdout) = child.stdout.take() {
        read_lines(stdout, Stream::Stdout, sender.clone());
    }
    if let Some(stderr) = child.stderr.take() {
        read_lines(stderr, Stream::Stderr, sender);
    }
    let mut kept = Kept::default();
    let followed = follow(&mut child, &lines, stop, &mut |stream, line| {
        job.log.write_all(&line)?;
        let text = String::from_utf8_lossy(&line).into_owned();
        kept.add(stream, &text);
        if stream == Stream::Stderr {
            on_stderr(text.trim_end().to_owned());
        }
        Ok(())
    });
    match followed {
        Ok(Some(status)) => Ok(Ended::Exited {
            status,
            stdout: kept.stdout,
            last_lines: kept.last_lines.into(),
        }),
        Ok(None) => end(&mut child).map(|()| Ended::Interrupted),
        Err(error) => {
            end(&mut child)?;
            Err(error)
        }
    }
}

/// Passes lines on until the child is dead and its pipes are read; `None` if stopped.
fn follow(
    child: &mut Child,
    lines: &Receiver<Message>,
    stop: &AtomicBool,
    on_line: &mut dyn FnMut(Stream, Vec<u8>) -> std::io::Result<()>,
) -> std::io::Result<Option<ExitStatus>> {
    let mut open = 2;
    let mut looked = Instant::now();
    let mut dead: Option<(ExitStatus, Instant)> = None;
    let mut pause = Duration::from_micros(200);
    loop {
        if stop.load(Ordering::Relaxed) {
            return Ok(None);
        }
        if open == 0 {
            // Most programs are gone right after their pipes; a few close them and go on.
            if let Some(status) = child.try_wait()? {
                return Ok(Some(status));
            }
            std::thread::sleep(pause);
            pause = pause.mul_f64(1.2).min(TICK);
            continue;
        }
        match lines.recv_timeout(TICK) {
            Ok(Some((stream, line))) => on_line(stream, line)?,
            Ok(None) => open -= 1,
            Err(RecvTimeoutError::Disconnected) => open = 0,
            Err(RecvTimeoutError::Timeout) => {}
        }
        if let Some((status, since)) = dead {
            if since.elapsed() > PIPES_AFTER_DEATH {
                return Ok(Some(status));
            }
        } else if open > 0 && looked.elapsed() > TICK {
            dead = child.try_wait()?.map(|status| (status, Instant::now()));
            looked = Instant::now();
        }
    }
}

fn read_lines(stream: impl Read + Send + 'static, name: Stream, sender: SyncSender<Message>) {
    std::thread::spawn(move || {
        let mut reader = BufReader::new(stream);
        loop {
            let mut line = Vec::new();
            match reader
                .by_ref()
                .take(LONGEST_LINE)
                .read_until(b'\n', &mut line)
            {
                Ok(n) if n > 0 => {
                    if line.last() != Some(&b'\n') {
                        line.push(b'\n');
                    }
                    if sender.send(Some((name, line))).is_err() {
                        return; // nobody follows any more
                    }
                }
                // An error of a pipe is its end for us; the exit status says the rest.
                _ => break,
            }
        }
        let _ = sender.send(None);
    });
}

/// Asks the child and all its children to end, kills what has not, and waits.
fn end(child: &mut Child) -> std::io::Result<()> {
    signal_group(child, "TERM");
    let asked = Instant::now();
    while asked.elapsed() < GRACE && child.try_wait()?.is_none() {
        std::thread::sleep(Duration::from_millis(2));
    }
    signal_group(child, "KILL");
    if child.try_wait()?.is_none() {
        child.kill()?;
        child.wait()?;
    }
    Ok(())
}

/// The standard library signals one process only; a group takes the shell's `kill`.
fn signal_group(child: &Child, signal: &str) {
    if cfg!(unix) {
        let _ = Command::new("sh")
            .args(["-c", r#"kill -s "$0" -- "-$1""#, signal])
            .arg(child.id().to_string())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status();
    }
}

#[derive(Default)]
struct Kept {
    stdout: String,
    last_lines: VecDeque<String>,
}

impl Kept {
    fn add(&mut self, stream: Stream, line: &str) {
        if stream == Stream::Stdout {
            self.stdout.push_str(line);
            if self.stdout.len() > 2 * KEPT_STDOUT {
                let surplus = self.stdout.len() - KEPT_STDOUT;
                let bytes = self.stdout.as_bytes();
                let newline = bytes[surplus..].iter().position(|&b| b == b'\n');
                self.stdout
                    .drain(..newline.map_or(surplus, |n| surplus + n + 1));
            }
        }
        if self.last_lines.len() == KEPT_LINES {
            self.last_lines.pop_front();
        }
        self.last_lines.push_back(line.trim_end().to_owned());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;
    use std::path::Path;

    fn shell(script: &str, stop: &AtomicBool) -> (Ended, String, Vec<String>) {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("log");
        let arguments = ["-c".to_owned(), script.to_owned()];
        let job = Job {
            program: Path::new("sh"),
            arguments: &arguments,
            root: folder.path(),
            stdin: File::open("/dev/null").unwrap(),
            log: File::create(&log).unwrap(),
        };
        let mut stderr = Vec::new();
        let ended = run(job, stop, &mut |line| stderr.push(line)).unwrap();
        (ended, std::fs::read_to_string(log).unwrap(), stderr)
    }

    #[test]
    fn both_streams_are_logged_and_standard_error_is_passed_on() {
        let script = "echo out; echo err >&2; printf unended; exit 3";
        let (ended, log, stderr) = shell(script, &AtomicBool::new(false));
        let Ended::Exited {
            status,
            stdout,
            last_lines,
        } = ended
        else {
            panic!("it ends by itself");
        };
        assert_eq!(status.code(), Some(3));
        assert_eq!(stdout, "out\nunended\n");
        assert_eq!(stderr, ["err"]);
        assert_eq!((log.lines().count(), last_lines.len()), (3, 3));
    }

    #[test]
    fn a_child_left_in_the_background_is_not_waited_for() {
        let (ended, ..) = shell("sleep 5 & exit 0", &AtomicBool::new(false));
        assert!(matches!(ended, Ended::Exited { status, .. } if status.success()));
    }

    #[test]
    fn a_stopped_stage_takes_its_children_with_it() {
        let folder = tempfile::tempdir().unwrap();
        let late = folder.path().join("late");
        let script = format!(
            "trap '' TERM; (sleep 0.6; echo x > {}) & wait",
            late.display()
        );
        let stop = AtomicBool::new(false);
        let (ended, ..) = std::thread::scope(|scope| {
            let run = scope.spawn(|| shell(&script, &stop));
            std::thread::sleep(Duration::from_millis(150));
            stop.store(true, Ordering::Relaxed);
            run.join().unwrap()
        });
        assert!(matches!(ended, Ended::Interrupted));
        std::thread::sleep(Duration::from_millis(700));
        assert!(!late.exists());
    }
}
